// The geometry toolkit: a mesh that grows by boxes, mouldings, lathes, tubes and grids.
//
// Shapes are given in a local frame and stored in the world: metres, y up, right-handed. Every
// shape shows its front (counter-clockwise corners) to the outside. Flat shapes carry flat normals;
// round ones smooth normals. Where no texture coordinates are asked for, they are the world's metres
// projected on the face's own plane, so that a pattern runs on across neighbours.
#pragma once
#include "materials.h"
#include "vitral/vec.h"

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <unordered_map>
#include <vector>

namespace plaza {

using vitral::Vec3d;
using Vec2d = vitral::Vec2T<double>;

inline constexpr double kPi = 3.14159265358979323846;

// A right-handed orthonormal frame: x to the right, y up, z toward the beholder.
struct Frame {
  Vec3d origin{0, 0, 0};
  Vec3d x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};
};
Vec3d point(const Frame& frame, const Vec3d& local);
Vec3d direction(const Frame& frame, const Vec3d& local);
Frame moved(const Frame& frame, const Vec3d& local);  // the origin goes to `local`
Frame turned(const Frame& frame, double degrees);     // about y, from z toward x
Frame leaned(const Frame& frame, double degrees);     // about x, from y toward z
Frame tilted(const Frame& frame, double degrees);     // about z, from x toward y

// How finely things are divided: 1 is the default; triangles grow about in proportion.
struct Detail {
  double level = 1;
};
bool is_bare(const Detail& detail);                          // little is left but walls, trees and monuments
bool is_coarse(const Detail& detail);                        // ornaments are left out, rooms are flat
int many(const Detail& detail, double base, int least = 1);  // things: base * level
int divisions(const Detail& detail, double base, int least = 3);  // of one length: base * sqrt(level)

struct Face {
  std::array<uint32_t, 4> positions{}, texcoords{}, normals{};
  uint8_t corners = 3;
  Surface surface{};
  uint16_t group = 0;
};

struct Mesh {
  std::vector<Vec3d> positions, normals;
  std::vector<Vec2d> texcoords;
  std::vector<Face> faces;
  std::vector<std::string> groups{"plaza"};
  std::unordered_map<uint64_t, uint32_t> normal_index;  // by rounded components
  Detail detail;
};

void begin_group(Mesh& mesh, const std::string& name);
uint32_t add_normal(Mesh& mesh, const Vec3d& unit);

// Planar, convex, in the world's coordinates. Faces without area are left out.
void triangle(Mesh& mesh, Surface surface, const Vec3d& a, const Vec3d& b, const Vec3d& c);
void quad(Mesh& mesh, Surface surface, const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d);
void quad_uv(Mesh& mesh, Surface surface, const std::array<Vec3d, 4>& corners,
             const std::array<Vec2d, 4>& texcoords, const Vec3d& normal);

// The six sides of a box, to be combined with |.
enum Sides : unsigned {
  kLeft = 1,
  kRight = 2,
  kBottom = 4,
  kTop = 8,
  kBack = 16,
  kFront = 32,
  kAllSides = 63,
  kOnWall = 63 - 16,  // its back is against something
  kOnGround = 63 - 4,
};
void box(Mesh& mesh, Surface surface, const Frame& frame, const Vec3d& min, const Vec3d& max,
         unsigned sides = kAllSides);
// A box seen from inside: a room.
void room(Mesh& mesh, Surface walls, Surface floor, const Frame& frame, const Vec3d& min, const Vec3d& max,
          unsigned sides = kAllSides);

// An outline in the (x, y) plane, counter-clockwise and convex, pushed from z0 to z1 > z0.
void extrude(Mesh& mesh, Surface surface, const Frame& frame, const std::vector<Vec2d>& outline, double z0,
             double z1);

// A moulding along x from x0 to x1: `profile` holds (z, y) from the lowest point on the wall up to
// the highest; z is how far it stands out. The ends are closed against z = 0.
void moulding(Mesh& mesh, Surface surface, const Frame& frame, const std::vector<Vec2d>& profile, double x0,
              double x1);

enum class Shading { smooth, faceted };

// `profile` holds (radius, y), upward, turned about y. Edges of more than 40 degrees stay sharp.
// With few segments and faceted shading it is a prism with mouldings; `phase` turns the corners.
void lathe(Mesh& mesh, Surface surface, const Frame& frame, const std::vector<Vec2d>& profile, int segments,
           Shading shading = Shading::smooth, double phase = 0);

enum class Ends { open, closed };

// Smooth surface p(u, v) over the unit square; dp/du x dp/dv points outward. `closed`: u = 0 and
// u = 1 are the same line. `repeats` is how often the texture repeats along u and v.
void surface_grid(Mesh& mesh, Surface surface, int nu, int nv, const std::function<Vec3d(double, double)>& p,
                  Ends ends_u, const Vec2d& repeats);

// A tube through points of the world, with a radius at each.
void tube(Mesh& mesh, Surface surface, const std::vector<Vec3d>& path, const std::vector<double>& radii,
          int sides);
void ellipsoid(Mesh& mesh, Surface surface, const Frame& frame, const Vec3d& radii, int around);

// A straight square or round bar between two points of the frame.
void bar(Mesh& mesh, Surface surface, const Frame& frame, const Vec3d& from, const Vec3d& to, double radius,
         int sides = 4);

}  // namespace plaza
