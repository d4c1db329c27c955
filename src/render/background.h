// What rays see that meet nothing.
#pragma once
#include "vitral/scene.h"

namespace vitral {

// What is found out once about the background. At a pole all columns of a panorama come together in one
// point, whose colour is the mean of the row nearest to it.
struct Sky {
  Vec3 zenith{0, 0, 0}, nadir{0, 0, 0};  // of a panorama, linear
};
Sky make_sky(const Scene& scene);

// The light from a direction of any length. A panorama's column is u = 1/2 + angle / (2 pi), the angle from
// -z towards +x, and its row by the elevation, -pi/2 at the lower edge; it is bilinear between the centres of
// texels, the last column is the first one's neighbour, and between the outermost rows and the poles it goes
// over into the poles' colours. Nothing is filtered: a mirror that shows much of it at once shows points.
Vec3 background_light(const Scene& scene, const Sky& sky, const Vec3& direction);

}  // namespace vitral
