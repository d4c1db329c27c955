#include "io/normals.h"

#include "io/memory.h"
#include "io/threads.h"

#include <algorithm>
#include <cstring>

namespace vitral {
namespace {

// One corner of one triangle that needs a normal, met at the position under work.
struct Incident {
  uint32_t corner;       // 3 * triangle + corner, triangles counted from `first`
  uint32_t left, right;  // the positions at the other ends of its two edges
  uint32_t group;
  Vec3 normal;  // of the triangle, unit
  float angle;
  uint32_t set;  // number of the first incident corner that it shares its normal with
};

// What the corners of one set share.
struct Sum {
  Vec3d normal{0, 0, 0};
  bool flat = true;  // all triangles have the same normal
  uint32_t number = kNoIndex;
};

// acos for weights: within 7e-5 (Abramowitz and Stegun 4.4.45), the same bits everywhere.
double arc_cosine(double x) {
  const double a = x < 0 ? -x : x;
  if (a >= 1) return x < 0 ? 3.14159265358979 : 0;
  const double angle = square_root(1 - a) * (1.5707288 + a * (-0.2121144 + a * (0.0742610 + a * -0.0187293)));
  return x < 0 ? 3.14159265358979 - angle : angle;
}

uint32_t hash_position(const Vec3& p) {
  uint64_t h = 0;
  for (const float x : {p.x, p.y, p.z}) {
    uint32_t bits;
    std::memcpy(&bits, &x, sizeof bits);
    h = (h ^ bits) * 0x9e3779b97f4a7c15u;
    h ^= h >> 29;
  }
  return static_cast<uint32_t>(h >> 32) ^ static_cast<uint32_t>(h);
}

class Smoother {
 public:
  Smoother(Mesh& mesh, size_t first, std::span<const uint32_t> groups, int threads)
      : mesh_(mesh),
        first_(first),
        count_(mesh.triangles.size() - first),
        groups_(groups),
        threads_(threads) {}

  void run() {
    find_corners();
    if (needy_.empty()) return;
    number_positions();
    weld_positions();
    sort_corners();
    assign();
  }

 private:
  uint32_t position_of(size_t corner) const { return mesh_.triangles[first_ + corner / 3][corner % 3]; }

  // The corners in need of a normal, in the order of the triangles.
  void find_corners() {
    reserve_large(needy_, 3 * count_);
    for (size_t t = 0; t < count_; ++t) {
      if (!groups_.empty() && groups_[t] == 0) continue;
      for (size_t k = 0; k < 3; ++k) {
        if (mesh_.triangle_normals[first_ + t][k] == kNoIndex)
          needy_.push_back(static_cast<uint32_t>(3 * t + k));
      }
    }
  }

  // Gives the positions of the triangles of these corners consecutive numbers, in their own order.
  void number_positions() {
    resize_large(number_, mesh_.positions.size(), kNoIndex);
    for (const uint32_t corner : needy_) {
      for (const uint32_t p : mesh_.triangles[first_ + corner / 3]) number_[p] = 0;
    }
    reserve_large(positions_, number_.size());
    for (uint32_t p = 0; p < number_.size(); ++p) {
      if (number_[p] == kNoIndex) continue;
      number_[p] = static_cast<uint32_t>(positions_.size());
      positions_.push_back(p);
    }
  }

  // Positions with the same coordinates get the number of the first of them. A table with open
  // addressing; after 32 places that are taken a position stays by itself, which bounds the time of
  // an unlucky or ill-meant file.
  void weld_positions() {
    size_t slots = 16;
    while (slots < 2 * positions_.size()) slots *= 2;
    std::vector<uint32_t> table;
    resize_large(table, slots, kNoIndex);
    for (uint32_t n = 0; n < positions_.size(); ++n) {
      const Vec3& at = mesh_.positions[positions_[n]];
      size_t slot = hash_position(at + Vec3{0, 0, 0}) & (slots - 1);  // -0 becomes +0
      for (int tries = 0; tries < 32; ++tries, slot = (slot + 1) & (slots - 1)) {
        if (table[slot] == kNoIndex) {
          table[slot] = n;
          break;
        }
        if (mesh_.positions[positions_[table[slot]]] == at) {
          number_[positions_[n]] = table[slot];
          break;
        }
      }
    }
  }

  // Sorts the corners by position; those of one position stay in the order of their triangles.
  void sort_corners() {
    resize_large(begin_, positions_.size() + 1, uint32_t{0});
    for (const uint32_t corner : needy_) ++begin_[number_[position_of(corner)] + 1];
    for (size_t i = 1; i < begin_.size(); ++i) begin_[i] += begin_[i - 1];
    resize_large(corners_, needy_.size());
    std::vector<uint32_t> cursor(begin_.begin(), begin_.end() - 1);
    for (const uint32_t corner : needy_) corners_[cursor[number_[position_of(corner)]]++] = corner;
    needy_ = {};
  }

  // Blocks of positions are independent. Each makes its own list of normals; the lists are joined
  // in order and the corners' numbers moved by where their block's list went.
  void assign() {
    constexpr size_t kBlock = 8192;
    const size_t blocks = (positions_.size() + kBlock - 1) / kBlock;
    std::vector<std::vector<Vec3>> lists(blocks);
    run_tasks(blocks, threads_, [&](size_t, size_t block) {
      std::vector<Incident> star;
      std::vector<Sum> sums;
      std::vector<std::pair<uint32_t, uint32_t>> edges;
      const size_t end = std::min(positions_.size(), (block + 1) * kBlock);
      for (size_t p = block * kBlock; p < end; ++p) {
        if (begin_[p + 1] - begin_[p] < 2) continue;  // a lone corner has its own normal
        gather(p, star);
        if (groups_.empty()) {
          join_over_edges(star, edges);
        } else {
          join_by_group(star);
        }
        emit(star, sums, lists[block]);
      }
    });

    std::vector<size_t> offset(blocks + 1, mesh_.normals.size());
    for (size_t b = 0; b < blocks; ++b) offset[b + 1] = offset[b] + lists[b].size();
    mesh_.normals.reserve(offset.back());
    for (auto& list : lists) {
      mesh_.normals.insert(mesh_.normals.end(), list.begin(), list.end());
      list = {};
    }
    run_tasks(blocks, threads_, [&](size_t, size_t block) {
      const size_t end = std::min(positions_.size(), (block + 1) * kBlock);
      for (size_t i = begin_[block * kBlock]; i < begin_[end]; ++i) {
        uint32_t& normal = mesh_.triangle_normals[first_ + corners_[i] / 3][corners_[i] % 3];
        if (normal != kNoIndex) normal += static_cast<uint32_t>(offset[block]);
      }
    });
  }

  void gather(size_t p, std::vector<Incident>& star) const {
    star.clear();
    for (uint32_t i = begin_[p]; i < begin_[p + 1]; ++i) {
      Incident c;
      c.corner = corners_[i];
      const size_t t = c.corner / 3, k = c.corner % 3;
      const Corners& triangle = mesh_.triangles[first_ + t];
      const uint32_t right = triangle[(k + 1) % 3], left = triangle[(k + 2) % 3];
      c.left = number_[left];
      c.right = number_[right];
      c.group = groups_.empty() ? 0 : groups_[t];
      const Vec3d at = to_double(mesh_.positions[triangle[k]]);
      const Vec3d e = to_double(mesh_.positions[right]) - at, f = to_double(mesh_.positions[left]) - at;
      c.normal = to_float(normalize(cross(e, f)));
      c.angle = static_cast<float>(arc_cosine(dot(e, f) / square_root(dot(e, e) * dot(f, f))));
      c.set = static_cast<uint32_t>(star.size());
      star.push_back(c);
    }
  }

  static uint32_t find_set(std::vector<Incident>& star, uint32_t i) {
    while (star[i].set != i) i = star[i].set = star[star[i].set].set;
    return i;
  }

  // The lower number stands for both.
  static void join(std::vector<Incident>& star, uint32_t a, uint32_t b) {
    a = find_set(star, a);
    b = find_set(star, b);
    star[std::max(a, b)].set = std::min(a, b);
  }

  static void join_if_round(std::vector<Incident>& star, uint32_t a, uint32_t b) {
    if (dot(star[a].normal, star[b].normal) >= kCreaseCosine) join(star, a, b);
  }

  static void join_over_edges(std::vector<Incident>& star,
                              std::vector<std::pair<uint32_t, uint32_t>>& edges) {
    constexpr size_t kFew = 16;
    const auto n = static_cast<uint32_t>(star.size());
    if (n <= kFew) {
      for (uint32_t a = 0; a < n; ++a) {
        for (uint32_t b = a + 1; b < n; ++b) {
          const Incident &s = star[a], &t = star[b];
          if (s.left == t.right || s.right == t.left || s.left == t.left || s.right == t.right) {
            join_if_round(star, a, b);
          }
        }
      }
      return;
    }
    // Sort the edges by their far end. Of very many triangles at one edge only neighbours in this
    // order are compared.
    edges.clear();
    for (uint32_t a = 0; a < n; ++a) {
      edges.emplace_back(star[a].left, a);
      edges.emplace_back(star[a].right, a);
    }
    std::sort(edges.begin(), edges.end());
    for (size_t i = 0; i < edges.size(); ++i) {
      for (size_t j = i + 1; j < std::min(edges.size(), i + kFew) && edges[j].first == edges[i].first; ++j) {
        join_if_round(star, edges[i].second, edges[j].second);
      }
    }
  }

  static void join_by_group(std::vector<Incident>& star) {
    std::vector<std::pair<uint32_t, uint32_t>> order;
    for (uint32_t i = 0; i < star.size(); ++i) order.emplace_back(star[i].group, i);
    std::sort(order.begin(), order.end());
    for (size_t i = 1; i < order.size(); ++i) {
      if (order[i].first == order[i - 1].first) join(star, order[i - 1].second, order[i].second);
    }
  }

  // Sums the normals of every set in the order of the triangles, and gives them to its corners
  // unless all are equal (or cancel): then the corners stay flat. Numbers count within the block's
  // list until the lists are joined.
  void emit(std::vector<Incident>& star, std::vector<Sum>& sums, std::vector<Vec3>& list) {
    sums.assign(star.size(), Sum{});
    for (uint32_t i = 0; i < star.size(); ++i) {
      star[i].set = find_set(star, i);
      Sum& sum = sums[star[i].set];
      sum.normal += to_double(star[i].normal) * static_cast<double>(star[i].angle);
      if (!(star[i].normal == star[star[i].set].normal)) sum.flat = false;
    }
    for (uint32_t i = 0; i < star.size(); ++i) {
      Sum& sum = sums[star[i].set];
      if (sum.flat) continue;
      if (sum.number == kNoIndex) {
        const double size = length(sum.normal);
        if (!(size > 1e-6)) {
          sum.flat = true;
          continue;
        }
        sum.number = static_cast<uint32_t>(list.size());
        list.push_back(to_float(sum.normal * (1 / size)));
      }
      mesh_.triangle_normals[first_ + star[i].corner / 3][star[i].corner % 3] = sum.number;
    }
  }

  Mesh& mesh_;
  size_t first_, count_;
  std::span<const uint32_t> groups_;
  int threads_;
  std::vector<uint32_t> needy_;      // corners, as 3 * triangle + corner, triangles counted from first_
  std::vector<uint32_t> positions_;  // that their triangles use
  std::vector<uint32_t> number_;     // [position]: into positions_, equal ones the same
  std::vector<uint32_t> begin_;      // [number]: its corners are corners_[begin .. next begin)
  std::vector<uint32_t> corners_;
};

}  // namespace

void compute_normals(Mesh& mesh, size_t first, std::span<const uint32_t> groups, int threads) {
  if (first < mesh.triangles.size()) Smoother(mesh, first, groups, threads).run();
}

}  // namespace vitral
