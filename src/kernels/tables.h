// Declares the entry points inside the namespace of the instruction set being compiled.
#pragma once
#include "kernels/kernels.h"

namespace vitral {
namespace VITRAL_ISA {

void primary_rays(const Pinhole& camera, int x, int y, RayPacket& rays);
void trace_closest(const KdView& tree, const RayPacket& rays, HitPacket& hits);
uint64_t trace_any(const KdView& tree, const RayPacket& rays, GlassRule glass);

}  // namespace VITRAL_ISA
}  // namespace vitral
