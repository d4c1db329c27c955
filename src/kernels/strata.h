// The ambient rays of one stratum, for kernels that trace them by themselves.
#pragma once
#include "kernels/points.h"

namespace vitral {
namespace VITRAL_ISA {

// Stratum `sample` of all live points: sets everything of the rays.
void stratum_rays(const PointPacket& points, const AmbientSettings& settings, int sample, RayPacket& rays);

}  // namespace VITRAL_ISA
}  // namespace vitral
