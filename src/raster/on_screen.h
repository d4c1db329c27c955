// Where boxes lie on the screen, and how near they come: what cannot be seen there is not drawn.
#pragma once
#include "math/pinhole.h"
#include "raster/raster.h"
#include "vitral/box.h"

namespace vitral {

struct PlacedObject;  // kdtree/objects.h

// From an object's space to the screen. The eye is where the tracer's camera rays start in that space,
// rounded as theirs: rasterized and traced, an object is seen from the same point.
Projection project_object(const Projection& world, const Vec3& eye, const PlacedObject& object);

// Pixels of the window, and an inverse depth that nothing in the box exceeds. An empty box of pixels: nothing
// of it can be seen.
struct ScreenBound {
  PixelBox pixels;
  float nearest;
};

// Of the points of `box` that lie between near and far. The pixels have `margin` more to every side than
// those whose centres the box comes to; at least 1 covers the snapping of triangles in it.
ScreenBound bound_on_screen(const Projection& projection, const Box& box, double margin);

// How many pixels a camera ray may be beside its place when it is taken to an object's space and rounded
// there: what an exact shape covers on the screen grows by as much.
double ray_margin(const Pinhole& camera, const PlacedObject& object);

}  // namespace vitral
