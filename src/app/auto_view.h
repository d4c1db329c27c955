// A camera and light for a mesh that comes with none.
#pragma once
#include "vitral/scene.h"

#include <functional>
#include <optional>
#include <vector>

namespace vitral {

// What the user fixes of an automatic camera; the rest follows the mesh.
struct ViewWishes {
  std::optional<Vec3> eye, view, up;
  std::optional<float> fov, near, far;
};

// The share of the picture's half width or half height that the mesh fills, in the tighter of the two
// dimensions, when the camera may choose where it stands.
inline constexpr float kFrameFill = 0.92f;

// Looks at the mesh, which has triangles, from the front, the right and above, or as wished. Puts
// every corner of its bounds between near and far and, unless the eye is fixed, every corner of its
// triangles inside the picture of width / height = aspect. Flat meshes and single points will do.
// Throws UsageError when the wishes contradict one another.
Camera auto_camera(const Mesh& mesh, float aspect, const ViewWishes& wishes);

// Where the detail is: the bounds of the middle nine tenths of the triangles along each axis. A mesh
// may have a sea or a sky around what it is about.
Box core(const Mesh& mesh);

enum class Place { outside, inside };

struct View {
  Camera camera;
  Place place = Place::outside;
};

// Views that may show a mesh well, the most usual one first: from around it, and from inside its core
// as one looks about in a room or a street. Only `fov`, `up`, near and far of the wishes are used.
std::vector<View> candidate_views(const Mesh& mesh, float aspect, const ViewWishes& wishes);

// What can be told apart in a small picture: triangles, and the pixels they cover.
struct Richness {
  size_t triangles = 0, pixels = 0;
};

// The view that shows the most triangles, in the manner of viewpoint entropy (Vazquez et al. 2001). The
// first one is left only for one from outside that shows twice as many, or for one from inside that shows
// half as many again and has them half as dense again: the plain walls around a room lose to what is in
// it, a finely modelled thing does not lose to its own hollow.
const View& best_view(const std::vector<View>& views, const std::function<Richness(const Camera&)>& look);

// Sun, ambient light and a light grey background for what a camera sees.
void light_automatically(const View& view, Scene& scene);

// How far ambient rays reach in a mesh that has this core.
float auto_ao_distance(const Box& core);

}  // namespace vitral
