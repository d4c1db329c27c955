// What is rendered: triangles, materials, textures, lights, cameras. Right-handed world, metres,
// y up. Colours are linear; only texels are stored as sRGB bytes.
#pragma once
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

struct Material {
  std::string name;
  Vec3 diffuse{0.8f, 0.8f, 0.8f};  // Kd
  Vec3 specular{0, 0, 0};          // Ks
  Vec3 transmission{1, 1, 1};      // Tf: tint of one sheet, for refraction and for shadows
  float shininess = 0;             // Ns; 0: no highlight
  float index = 1.5f;              // Ni, index of refraction
  float opacity = 1;               // d
  Optics optics = Optics::opaque;
  int diffuse_map = kNoTexture;  // map_Kd, into Scene::textures
  int opacity_map = kNoTexture;  // map_d: cut-out, visible where alpha (or, without one, grey) >= 1/2
};

// Glass does not block shadow and ambient rays.
static inline bool is_glass(const Material& m) {
  return m.optics == Optics::solid || m.optics == Optics::thin || m.optics == Optics::dissolve;
}

struct Light {
  enum class Kind { directional, point };
  Kind kind = Kind::directional;
  Vec3 direction{0, -1, 0};  // unit: the way the light travels (directional)
  Vec3 position{0, 0, 0};    // (point)
  Vec3 color{1, 1, 1};       // irradiance at normal incidence; for a point light at distance 1
};

struct Camera {
  std::string name;
  Vec3 position{0, 0, 0};
  Vec3 view{0, 0, -1};            // the way it looks, any length
  Vec3 up{0, 1, 0};               // any length, not along view
  float fov = 60;                 // vertical, degrees, in (0, 180)
  float near = 0.1f, far = 1000;  // distances along view
};

struct Scene {
  Mesh mesh;
  std::vector<Material> materials;  // at least one when there are triangles
  std::vector<Texture> textures;
  std::vector<Light> lights;
  Vec3 ambient{0.5f, 0.5f, 0.5f};
  Vec3 background{0.6f, 0.75f, 0.95f};
  std::vector<Camera> cameras;
  size_t dropped_triangles = 0;  // degenerate or not finite, left out by the loaders
};

Box bounds(const Mesh& mesh);  // of the positions that triangles use; empty without triangles

}  // namespace vitral
