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

// Improves hits that hold the closest so far, in the numbering of this tree: t, and a number that a hit at
// the same t must be lower than. Returns the lanes it did that for. The other lanes are left as they are.
uint64_t improve_closest(const KdView& tree, const RayPacket& rays, HitPacket& hits, NoCounts counts);
uint64_t improve_closest(const KdView& tree, const RayPacket& rays, HitPacket& hits, Counting counts);

}  // namespace VITRAL_ISA
}  // namespace vitral
