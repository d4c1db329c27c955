// An open gallery behind arches on columns.
#include <algorithm>
#include <cmath>

#include "parts.h"
#include "random.h"

namespace plaza {
namespace {

constexpr double kHeight = 5.6, kGallery = 4.2, kThick = 0.62, kSpring = 3.55;

// Square plinth, attic base, shaft with entasis, capital of echinus and abacus.
void column(Mesh& mesh, const Frame& f) {
  const double r = 0.27;
  lathe(mesh, Surface::stone, f, {{0.56, 0.0}, {0.56, 0.26}, {0, 0.26}}, 4, Shading::faceted, kPi / 4);
  if (is_bare(mesh.detail)) return bar(mesh, Surface::stone, f, {0, 0.26, 0}, {0, kSpring, 0}, 0.3, 6);
  std::vector<Vec2d> profile{{0.38, 0.26}, {0.41, 0.31}, {0.41, 0.36}, {0.34, 0.41},
                             {0.36, 0.45}, {0.36, 0.49}, {0.30, 0.53}};
  const double foot = 0.53, neck = kSpring - 0.42;
  const int steps = divisions(mesh.detail, 5, 1);
  for (int i = 0; i <= steps; ++i) {
    const double t = static_cast<double>(i) / steps;
    // Entasis: the shaft narrows by a sixth, slowly at first.
    profile.push_back({r * (1 - t * t / 6), foot + (neck - foot) * t});
  }
  const double top = r * 5 / 6;
  for (const Vec2d& p : {Vec2d{top + 0.04, neck + 0.01},
                         {top + 0.04, neck + 0.06},
                         {top, neck + 0.08},
                         {top, neck + 0.16},
                         {top + 0.05, neck + 0.2},
                         {top + 0.14, neck + 0.3}}) {
    profile.push_back(p);
  }
  lathe(mesh, Surface::stone, f, profile, divisions(mesh.detail, 16, 6));
  lathe(mesh, Surface::stone, f, {{0.0, neck + 0.3}, {0.56, neck + 0.3}, {0.56, kSpring}, {0, kSpring}}, 4,
        Shading::faceted, kPi / 4);
}

// The wall above two columns: front, back and the soffit of the arch; keystone and archivolt.
void arch(Mesh& mesh, const Frame& f, double x0, double x1, double half_pier) {
  const double a = x0 + half_pier, b = x1 - half_pier, r = (b - a) / 2, middle = (a + b) / 2;
  const int steps = 2 * divisions(mesh.detail, 6, is_bare(mesh.detail) ? 2 : 3);
  const auto rim = [&](double radius, int i) {
    const double t = kPi * (1 - static_cast<double>(i) / steps);
    return Vec2d{middle + radius * std::cos(t), kSpring + radius * std::sin(t)};
  };
  const auto strip = [&](const Vec2d& p, const Vec2d& q) {
    const auto at = [&](double x, double y, double z) { return point(f, {x, y, z}); };
    quad(mesh, Surface::ashlar, at(p.x, p.y, 0), at(q.x, q.y, 0), at(q.x, kHeight, 0), at(p.x, kHeight, 0));
    quad(mesh, Surface::ashlar, at(q.x, q.y, -kThick), at(p.x, p.y, -kThick), at(p.x, kHeight, -kThick),
         at(q.x, kHeight, -kThick));
    quad(mesh, Surface::stone, at(p.x, p.y, -kThick), at(q.x, q.y, -kThick), at(q.x, q.y, 0),
         at(p.x, p.y, 0));
  };
  strip({x0, kSpring}, {a, kSpring});
  for (int i = 0; i < steps; ++i) strip(rim(r, i), rim(r, i + 1));
  strip({b, kSpring}, {x1, kSpring});
  if (is_coarse(mesh.detail)) return;
  // The archivolt: a band that stands out a little, its face, inner and outer edge.
  for (int i = 0; i < steps; ++i) {
    const double out = 0.06, width = 0.24;
    const Vec2d p = rim(r, i), q = rim(r, i + 1), ps = rim(r + width, i), qs = rim(r + width, i + 1);
    const auto at = [&](const Vec2d& c, double z) { return point(f, {c.x, c.y, z}); };
    quad(mesh, Surface::stone, at(p, out), at(q, out), at(qs, out), at(ps, out));
    quad(mesh, Surface::stone, at(p, 0), at(q, 0), at(q, out), at(p, out));
    quad(mesh, Surface::stone, at(ps, out), at(qs, out), at(qs, 0), at(ps, 0));
  }
  extrude(mesh, Surface::stone, moved(f, {middle, kSpring, 0}),
          {{-0.14, r - 0.06}, {0.14, r - 0.06}, {0.22, r + 0.4}, {-0.22, r + 0.4}}, -0.02, 0.14);
}

}  // namespace

double arcade(Mesh& mesh, const Frame& f, int bays, double bay, Finish finish) {
  const double width = bays * bay, half_pier = 0.40;
  for (int i = 0; i <= bays; ++i) {
    const double x = std::clamp(i * bay, 0.4, width - 0.4);
    column(mesh, moved(f, {x, 0.14, -kThick / 2}));
  }
  const Frame raised = moved(f, {0, 0.14, 0});
  for (int i = 0; i < bays; ++i) arch(mesh, raised, i * bay, (i + 1) * bay, half_pier);
  box(mesh, Surface::ashlar, f, {0, 0.14 + kSpring, -kThick}, {width, 0.14 + kHeight, 0}, kLeft | kRight);
  // The gallery: step, paving, ceiling with cross beams, and doors in its back wall.
  box(mesh, Surface::stone, f, {0, 0, -kGallery}, {width, 0.14, 0.32}, kFront | kLeft | kRight | kTop);
  quad(mesh, Surface::plaster_white, point(f, {0, kHeight, -kGallery}), point(f, {width, kHeight, -kGallery}),
       point(f, {width, kHeight, -kThick}), point(f, {0, kHeight, -kThick}));
  room(mesh, Surface::plaster_white, Surface::stone, f, {0.02, 0.14, -kGallery},
       {width - 0.02, kHeight, -0.02}, kLeft | kRight);
  const Frame inner = moved(f, {0, 0.14, -kGallery});
  const double high = kHeight - 0.14;
  for (int i = 0; i < bays; ++i) {
    const double x0 = i * bay, x1 = x0 + bay, middle = 0.5 * (x0 + x1);
    const uint32_t id = hash(static_cast<uint32_t>(i), 8080);
    const Filling filling = id % 3 == 0 ? Filling::door : Filling::shopfront;
    const Hole h{middle - 1.0, middle + 1.0, 0.1, 3.6};
    const std::array<double, 4> xs{x0, h.x0, h.x1, x1}, ys{0, h.y0, h.y1, high};
    for (size_t r = 0; r < 3; ++r) {
      for (size_t c = 0; c < 3; ++c) {
        if (r == 1 && c == 1) continue;
        box(mesh, Surface::plaster_white, inner, {xs[c], ys[r], -0.3}, {xs[c + 1], ys[r + 1], 0}, kFront);
      }
    }
    fill_hole(mesh, inner, h, {filling, Surface::paint_green, finish, id});
    surround(mesh, inner, h, Surround::plain);
    if (i > 0) {
      box(mesh, Surface::plaster_white, f, {x0 - 0.25, kHeight - 0.4, -kGallery},
          {x0 + 0.25, kHeight, -kThick}, kLeft | kRight | kBottom);
    }
  }
  return kHeight + 0.14;
}

}  // namespace plaza
