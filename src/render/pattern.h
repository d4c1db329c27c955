// Patterns: colours by formula, filtered to what a ray sees of them.
#pragma once
#include "vitral/scene.h"

namespace vitral {

// A place of the pattern's own space, metres: a point of the surface, its unit normal out of the solid, and
// the parallelogram around the point that the ray sees of the surface, by its sides. Sides that are not
// finite, of a surface seen from its edge, stand for all of it.
//
// The space is the world's; of a placed model it is the model's own; of a shape, whose own space has no
// measure, the world's as the shape was placed before it moved.
struct PatternPlace {
  Vec3 position;
  Vec3 outward;
  Vec3 first, second;
};

// The mean colour there. Boxes along the axes, with the variances of the parallelogram, stand for it: over
// those the square waves that checkers and bricks are made of have integrals in closed form.
//
//   checker  cubes of side `size`, `first` and `second` in turn; the cube that contains the origin's corner
//            towards +x, +y, +z is `first`. Taken 1/1024 of a side beneath the surface, so that a floor that
//            lies just between two layers shows one of them
//   brick    courses of `height`, bricks of `size`, every other course moved by half of one. They stand on
//            walls: of the three axes the one nearest to the normal is left out, and of the two others the
//            courses follow y, or on floors z
//   marble   veins cos^8 (pi w) of `second`, for w = x / size + turbulence * T and T the sum over the
//            octaves i of 2^-i |noise(2^i p / size)|, p turned (Perlin, "An Image Synthesizer",
//            SIGGRAPH 1985). Octaves finer than what is seen are their mean, and veins fade by how much w
//            varies within it
Vec3 pattern_color(const Pattern& pattern, const PatternPlace& place);

}  // namespace vitral
