// What is rendered: triangles, shapes and instances, materials, textures, lights, cameras. Right-handed
// world, metres, y up. Colours are linear; only texels are stored as sRGB bytes.
#pragma once
#include "vitral/affine.h"
#include "vitral/box.h"
#include "vitral/ray.h"
#include "vitral/vec.h"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace vitral {

inline constexpr uint32_t kNoIndex = 0xffffffffu;

using Corners = std::array<uint32_t, 3>;  // one index per corner of a triangle

// Positions, normals and texture coordinates are indexed separately, as OBJ has them. Counter-
// clockwise corners make the front. The loaders drop triangles that are degenerate or not finite.
struct Mesh {
  std::vector<Vec3> positions;
  std::vector<Vec3> normals;                // unit length
  std::vector<Vec2> texcoords;              // v points up: (0, 0) is the image's lower left corner
  std::vector<Corners> triangles;           // into positions; the index here is the triangle's number
  std::vector<Corners> triangle_normals;    // into normals; empty: no normals at all; kNoIndex: flat corner
  std::vector<Corners> triangle_texcoords;  // into texcoords; empty: none at all; kNoIndex: (0, 0)
  std::vector<uint32_t> triangle_material;  // into Scene::materials, one per triangle
};

// RGBA, 8 bits each, row by row from the top. Colour is sRGB-encoded, alpha is linear.
struct Texture {
  std::string name;
  int width = 0, height = 0;
  std::vector<uint8_t> texels;  // 4 * width * height
};

inline constexpr int kNoTexture = -1;

// How light leaves the surface besides the diffuse and the highlight term.
enum class Optics {
  opaque,    // nothing more
  mirror,    // a reflection weighted by Ks (MTL illum 3)
  polished,  // a reflection weighted by Ks times Fresnel (illum 5 and 8)
  solid,     // glass that is entered and left: reflection and refraction, by Fresnel (illum 4, 6, 7, 9)
  thin,      // glass sheet: as solid, but every hit enters
  dissolve,  // no refraction: the fraction 1-d of what lies straight behind shows through
};

// A colour that a formula gives for every point of the material's own space, metres: of the world, or of the
// object that is made of it. A solid of two colours, cut open by the surface. src/render/pattern.h has the
// formulas.
struct Pattern {
  enum class Kind : uint8_t { none, checker, brick, marble };
  Kind kind = Kind::none;
  Vec3 first{0.8f, 0.8f, 0.8f}, second{0.1f, 0.1f, 0.1f};  // brick and mortar; ground and veins
  float size = 1;           // side of the checker's cubes; length of a brick with its joint; between veins
  float height = 0.3f;      // of a brick with its joint
  float mortar = 0.05f;     // width of the joint
  float turbulence = 0.5f;  // of the marble: how far its veins are bent, in distances between them
};

struct Material {
  std::string name;
  Vec3 diffuse{0.8f, 0.8f, 0.8f};  // Kd
  Vec3 specular{0, 0, 0};          // Ks
  Vec3 transmission{1, 1, 1};      // Tf: tint of one sheet, for refraction and for shadows
  Vec3 reflectivity{0, 0, 0};      // 0..1: mirrored at every angle. What the optics do shares the rest; the
                                   // diffuse and highlight terms, which are no ray's, stay as they are
  Vec3 emission{0, 0, 0};    // Ke: what the surface sends to every viewer by itself; it lights nothing else
  Vec3 absorption{0, 0, 0};  // 1/m, inside solid glass: exp(-absorption * length) is left (Beer-Lambert)
  float shininess = 0;       // Ns; 0: no highlight
  float index = 1.5f;        // Ni, index of refraction
  float opacity = 1;         // d
  Optics optics = Optics::opaque;
  Pattern pattern;               // unless none: instead of Kd
  int diffuse_map = kNoTexture;  // map_Kd, into Scene::textures
  int opacity_map = kNoTexture;  // map_d: cut-out, visible where alpha (or, without one, grey) >= 1/2
};

// Glass does not block shadow and ambient rays.
static inline bool is_glass(const Material& m) {
  return m.optics == Optics::solid || m.optics == Optics::thin || m.optics == Optics::dissolve;
}

// Lights with a size are sampled at `samples` points, stratified over their area, and cast soft shadows.
// Their colour is what a point light at their middle would have: seen from afar, straight on, both are alike.
struct Light {
  enum class Kind {
    directional,  // parallel light
    point,
    spot,       // a point light that fades from inner to outer, angles from its direction
    rectangle,  // position is the middle; shines to the side of `direction`, by Lambert's law
    sphere,
    sun,  // parallel light from a disk of the sky
  };
  Kind kind = Kind::directional;
  Vec3 direction{0, -1, 0};  // unit: the way the light travels (directional, spot, rectangle, sun)
  Vec3 position{0, 0, 0};    // (all but directional and sun)
  Vec3 color{1, 1, 1};       // irradiance at normal incidence; of lights with a position, at distance 1
  Vec3 side_u{1, 0, 0};      // the rectangle's sides, perpendicular to its direction
  Vec3 side_v{0, 0, 1};
  float radius = 0;                              // of the sphere
  float diameter_degrees = 0.53f;                // of the sun's disk, seen from the ground
  float inner_degrees = 30, outer_degrees = 40;  // of the spot: full light inside, none outside
  int samples = 1;                               // of lights with a size, per shaded point, 1..1024
};

static inline bool has_size(const Light& light) {
  return light.kind == Light::Kind::rectangle || light.kind == Light::Kind::sphere ||
         light.kind == Light::Kind::sun;
}

// Where a moving camera is and looks at a moment.
struct CameraKey {
  float time = 0;
  Vec3 position, view, up;
};

struct Camera {
  std::string name;
  Vec3 position{0, 0, 0};
  Vec3 view{0, 0, -1};                        // the way it looks, any length
  Vec3 up{0, 1, 0};                           // any length, not along view
  float fov = 60;                             // vertical, degrees, in (0, 180)
  float near = 0.1f, far = 1000;              // distances along view
  float aperture = 0;                         // diameter of the lens; 0: a pinhole
  float focus = 1;                            // depth, along view, of the plane that is sharp
  float shutter_open = 0, shutter_close = 0;  // the picture gathers light between these times
  std::vector<CameraKey> motion;              // in order of time; empty: it rests at position, view and up
};

// What a ray that meets nothing sees.
struct Background {
  enum class Kind {
    constant,
    gradient,  // from `color` at the horizon and below to `zenith`, by the sine of the elevation
    panorama,  // a latitude-longitude picture, its middle towards -z, its upper edge up
  };
  Kind kind = Kind::constant;
  Vec3 color{0.6f, 0.75f, 0.95f};
  Vec3 zenith{0.6f, 0.75f, 0.95f};
  int panorama = kNoTexture;  // into Scene::textures
  float scale = 1;            // the panorama's colours are multiplied with this
};

// What stands in the world by an affine map: a mesh placed any number of times, or an exact shape.
//   sphere    of radius 1 around the origin
//   plane     y = 0, without end
//   box       [-1, 1]^3
//   cylinder  of radius 1 around the y axis, |y| <= 1, with its caps
//   disk      of radius 1 in the plane y = 0
// Its texture coordinates: kdtree/shapes.h.
enum class Shape : uint8_t { mesh, sphere, plane, box, cylinder, disk };
struct Object {
  Shape shape = Shape::mesh;
  uint32_t model = 0;            // into Scene::models (mesh)
  uint32_t material = kNoIndex;  // into Scene::materials; kNoIndex: the mesh's own
  Affine placement;              // from its own space to the world
  std::vector<RigidKey> motion;  // goes after the placement, about where it puts the origin; empty: it rests
};

struct Scene {
  Mesh mesh;                 // what stands in the world as it is
  std::vector<Mesh> models;  // what objects place
  std::vector<Object> objects;
  std::vector<Material> materials;  // at least one when there are triangles
  std::vector<Texture> textures;
  std::vector<Light> lights;
  Vec3 ambient{0.5f, 0.5f, 0.5f};
  Background background;
  std::vector<Camera> cameras;
  size_t dropped_triangles = 0;  // degenerate or not finite, left out by the loaders
};

Box bounds(const Mesh& mesh);  // of the positions that triangles use; empty without triangles
// The same and of all objects that have an end, those that move at all their keys.
Box bounds(const Scene& scene);

}  // namespace vitral
