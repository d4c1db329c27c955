#include "io/triangulate.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace vitral {
namespace {

using Vec2d = Vec2T<double>;

// The normal of a polygon, as long as twice its area (Newell's method, as in Sutherland, Sproull
// and Schumacker 1974), from coordinates relative to the first corner.
Vec3d newell_normal(std::span<const Vec3> polygon) {
  const Vec3d origin = to_double(polygon[0]);
  Vec3d normal{0, 0, 0};
  for (size_t i = 1; i + 1 < polygon.size(); ++i) {
    normal += cross(to_double(polygon[i]) - origin, to_double(polygon[i + 1]) - origin);
  }
  return normal;
}

// Drops the axis along which the normal is longest. The two others are taken in the order that
// makes the outline counter-clockwise.
void project(std::span<const Vec3> polygon, std::vector<Vec2d>& points) {
  const Vec3d n = newell_normal(polygon);
  const double x = std::fabs(n.x), y = std::fabs(n.y), z = std::fabs(n.z);
  points.clear();
  for (const Vec3& corner : polygon) {
    const Vec3d p = to_double(corner);
    if (z >= x && z >= y) {
      points.push_back(n.z >= 0 ? Vec2d{p.x, p.y} : Vec2d{p.y, p.x});
    } else if (y >= x) {
      points.push_back(n.y >= 0 ? Vec2d{p.z, p.x} : Vec2d{p.x, p.z});
    } else {
      points.push_back(n.x >= 0 ? Vec2d{p.y, p.z} : Vec2d{p.z, p.y});
    }
  }
}

// Twice the signed area of triangle abc: positive when it is counter-clockwise.
double area2(const Vec2d& a, const Vec2d& b, const Vec2d& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

bool same(const Vec2d& a, const Vec2d& b) {
  return a.x == b.x && a.y == b.y;
}

// Whether p lies in the counter-clockwise triangle abc or on its border.
bool contains(const Vec2d& a, const Vec2d& b, const Vec2d& c, const Vec2d& p) {
  return area2(a, b, p) >= 0 && area2(b, c, p) >= 0 && area2(c, a, p) >= 0;
}

// The outline that is left, as a ring.
class Ring {
 public:
  Ring(std::span<const Vec3> polygon, TriangulateScratch& scratch) : s_(scratch), size_(polygon.size()) {
    project(polygon, s_.points);
    s_.next.resize(size_);
    s_.previous.resize(size_);
    for (uint32_t i = 0; i < size_; ++i) {
      s_.next[i] = i + 1 == size_ ? 0 : i + 1;
      s_.previous[i] = i == 0 ? static_cast<uint32_t>(size_) - 1 : i - 1;
    }
    sort_reflex_corners();
  }

  size_t size() const { return size_; }
  uint32_t next(uint32_t i) const { return s_.next[i]; }
  bool is_cut(uint32_t i) const { return s_.next[i] == kGone; }
  LocalCorners triangle(uint32_t i) const { return {s_.previous[i], i, s_.next[i]}; }
  double turn(uint32_t i) const {
    return area2(s_.points[s_.previous[i]], s_.points[i], s_.points[s_.next[i]]);
  }

  // A corner is an ear when the outline turns left there and no other corner of the outline lies
  // in its triangle. Only corners where it does not turn left can do that. Corners at the same place
  // as one of the triangle's are no obstacle: outlines with holes touch themselves so. `steps` is
  // counted down by the cells and corners looked at.
  bool is_ear(uint32_t i, size_t& steps) {
    if (turn(i) <= 0) return false;
    const Vec2d a = s_.points[s_.previous[i]], b = s_.points[i], c = s_.points[s_.next[i]];
    const size_t left = column(std::min({a.x, b.x, c.x})), right = column(std::max({a.x, b.x, c.x}));
    const size_t bottom = row(std::min({a.y, b.y, c.y})), top = row(std::max({a.y, b.y, c.y}));
    for (size_t y = bottom; y <= top; ++y) {
      for (size_t x = left; x <= right; ++x) {
        if (!is_cell_clear(y * side_ + x, a, b, c, steps)) return false;
      }
    }
    return true;
  }

  void cut(uint32_t i) {
    s_.next[s_.previous[i]] = s_.next[i];
    s_.previous[s_.next[i]] = s_.previous[i];
    s_.next[i] = kGone;
    --size_;
  }

 private:
  static constexpr uint32_t kGone = 0xffffffffu;

  // With the cube root of their number as the grid's side a small ear meets few corners, and a large
  // one not too many cells.
  void sort_reflex_corners() {
    Vec2d high = s_.points[0];
    low_ = high;
    size_t count = 0;
    for (uint32_t i = 0; i < size_; ++i) {
      const Vec2d p = s_.points[i];
      low_ = {std::min(low_.x, p.x), std::min(low_.y, p.y)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y)};
      if (turn(i) <= 0) ++count;
    }
    while ((side_ + 1) * (side_ + 1) * (side_ + 1) <= count) ++side_;
    const auto cells = static_cast<double>(side_);
    scale_ = {high.x > low_.x ? cells / (high.x - low_.x) : 0,
              high.y > low_.y ? cells / (high.y - low_.y) : 0};

    // A counting sort; the ends move up while the cells are filled.
    s_.cell_begin.assign(side_ * side_ + 1, 0);
    for (uint32_t i = 0; i < size_; ++i) {
      if (turn(i) <= 0) ++s_.cell_begin[cell(i) + 1];
    }
    for (size_t k = 1; k < s_.cell_begin.size(); ++k) s_.cell_begin[k] += s_.cell_begin[k - 1];
    s_.cell_end = s_.cell_begin;
    s_.reflex.resize(count);
    for (uint32_t i = 0; i < size_; ++i) {
      if (turn(i) <= 0) s_.reflex[s_.cell_end[cell(i)]++] = i;
    }
  }

  size_t slice(double offset) const {
    return offset > 0 ? std::min(static_cast<size_t>(offset), side_ - 1) : 0;
  }
  size_t column(double x) const { return slice((x - low_.x) * scale_.x); }
  size_t row(double y) const { return slice((y - low_.y) * scale_.y); }
  size_t cell(uint32_t i) const { return row(s_.points[i].y) * side_ + column(s_.points[i].x); }

  // Whether no corner of the cell lies in triangle abc. Corners that are cut off or have become
  // convex leave the cell.
  bool is_cell_clear(size_t cell, const Vec2d& a, const Vec2d& b, const Vec2d& c, size_t& steps) {
    if (steps > 0) --steps;
    for (uint32_t k = s_.cell_begin[cell]; k < s_.cell_end[cell];) {
      if (steps > 0) --steps;
      const uint32_t r = s_.reflex[k];
      if (is_cut(r) || turn(r) > 0) {
        s_.reflex[k] = s_.reflex[--s_.cell_end[cell]];
        continue;
      }
      const Vec2d p = s_.points[r];
      if (contains(a, b, c, p) && !same(p, a) && !same(p, b) && !same(p, c)) return false;
      ++k;
    }
    return true;
  }

  TriangulateScratch& s_;
  size_t size_;
  size_t side_ = 1;  // cells of the grid along each axis
  Vec2d low_{0, 0}, scale_{0, 0};
};

bool finite(const Vec3& p) {
  constexpr float kLargest = 1e18f;
  return std::fabs(p.x) <= kLargest && std::fabs(p.y) <= kLargest && std::fabs(p.z) <= kLargest;
}

// A quadrilateral is cut along the diagonal from its first corner, unless it is concave (or folded)
// and that diagonal lies outside.
void cut_quadrilateral(std::span<const Vec3> q, std::vector<LocalCorners>& triangles) {
  const Vec3d a = to_double(q[0]), b = to_double(q[1]), c = to_double(q[2]), d = to_double(q[3]);
  const Vec3d normal = cross(c - a, d - b);  // twice the area
  const auto front = [&normal](const Vec3d& p, const Vec3d& r, const Vec3d& s) {
    return dot(cross(r - p, s - p), normal) > 0;
  };
  const bool first_diagonal = front(a, b, c) && front(a, c, d);
  if (!first_diagonal && front(a, b, d) && front(b, c, d)) {
    triangles = {{0, 1, 3}, {1, 2, 3}};
  } else {
    triangles = {{0, 1, 2}, {0, 2, 3}};
  }
}

}  // namespace

bool is_degenerate(const Vec3& a, const Vec3& b, const Vec3& c) {
  if (!finite(a) || !finite(b) || !finite(c)) return true;
  const Vec3d n = cross(to_double(b) - to_double(a), to_double(c) - to_double(a));
  return (n.x == 0 && n.y == 0 && n.z == 0) || b == c;
}

void triangulate(std::span<const Vec3> polygon, TriangulateScratch& scratch,
                 std::vector<LocalCorners>& triangles) {
  triangles.clear();
  const size_t n = polygon.size();
  if (n == 4 && std::all_of(polygon.begin(), polygon.end(), finite))
    return cut_quadrilateral(polygon, triangles);
  if (n <= 4 || !std::all_of(polygon.begin(), polygon.end(), finite)) {
    for (uint32_t i = 1; i + 1 < n; ++i) triangles.push_back({0, i, i + 1});
    return;
  }

  // Look at all corners in turn and cut those that are ears. A cut makes only its two neighbours
  // worth another look, which they get at the end of the queue: so the triangles stay stout. When
  // nobody in the whole outline is an ear it crosses itself (or rounding says so): then a corner
  // that merely turns left is cut, or else any corner.
  Ring ring(polygon, scratch);
  std::vector<uint32_t>& queue = scratch.queue;
  enum { ears, left_turns, anything } accept = ears;
  size_t steps = 1024 * n, cuts = 1;
  uint32_t left = 0;  // a corner that is left
  queue.clear();
  for (size_t head = 0; ring.size() > 3; ++head) {
    if (head == queue.size()) {
      if (cuts == 0) accept = accept == ears ? left_turns : anything;
      cuts = head = 0;
      queue.clear();
      for (size_t k = 0; k < ring.size(); ++k, left = ring.next(left)) queue.push_back(left);
    }
    const uint32_t i = queue[head];
    if (ring.is_cut(i)) continue;
    if (steps == 0) accept = anything;
    if (!(accept == anything || (accept == left_turns ? ring.turn(i) > 0 : ring.is_ear(i, steps)))) continue;
    triangles.push_back(ring.triangle(i));
    ring.cut(i);
    const auto [before, cut, after] = triangles.back();
    queue.push_back(before);
    queue.push_back(after);
    if (queue[head + 1] == after) ++head;
    left = after;
    accept = ears;
    ++cuts;
  }
  triangles.push_back(ring.triangle(left));
}

}  // namespace vitral
