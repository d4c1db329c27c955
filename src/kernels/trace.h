// The walk of one packet, for the kernels that fall back on it.
#pragma once
#include "kernels/counts.h"

namespace vitral {
namespace VITRAL_ISA {

// The live rays that meet anything in (tmin, tmax) below a node.
uint64_t trace_any_from(const KdView& tree, uint32_t node, const RayPacket& rays, GlassRule glass,
                        NoCounts counts);
uint64_t trace_any_from(const KdView& tree, uint32_t node, const RayPacket& rays, GlassRule glass,
                        Counting counts);

}  // namespace VITRAL_ISA
}  // namespace vitral
