#include "tree.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <stdexcept>
#include <tuple>

namespace forest {
namespace {

constexpr double kPi = 3.14159265358979323846;

Vec3d around(double angle, double radius, double y) {
  return {radius * std::cos(angle), y, radius * std::sin(angle)};
}

Vec3d random_direction(Random& random) {
  const double y = between(random, -1, 1), a = between(random, 0, 2 * kPi);
  return around(a, std::sqrt(1 - y * y), y);
}

// A round bar that gets thinner, open at its ends; 2 * sides triangles.
void bar(Tree& tree, const Vec3d& from, const Vec3d& to, double thick, double thin, int sides) {
  const Vec3d along = normalize(to - from);
  const Vec3d u = normalize(cross(along, std::abs(along.x) < 0.5 ? Vec3d{1, 0, 0} : Vec3d{0, 0, 1}));
  const Vec3d v = cross(along, u);
  const auto out = [&](double side) {
    const double a = 2 * kPi * side / sides;
    return u * std::cos(a) - v * std::sin(a);
  };
  for (int i = 0; i < sides; ++i) {
    const Vec3d n = out(i), m = out(i + 1), middle = out(i + 0.5);
    const Vec3d a = from + n * thick, b = from + m * thick, c = to + m * thin, d = to + n * thin;
    tree.push_back({{a, d, c}, middle, Stuff::bark});
    tree.push_back({{a, c, b}, middle, Stuff::bark});
  }
}

}  // namespace

// Whorls of twigs, each longer than the next above; a needle is a triangle that hangs down from its twig.
Tree fir(int triangles) {
  Tree tree;
  Random random{1, 0};
  constexpr double height = 11, whorls = 15;
  const int sides = triangles > 1000 ? 8 : 5;
  bar(tree, {0, -0.3, 0}, {0, 0.93 * height, 0}, 0.17, 0.02, sides);
  const int needles = triangles - 2 * sides;
  const double size = 1.1 * std::pow(10000.0 / triangles, 0.42) * 0.27;
  for (int i = 0; i < needles; ++i) {
    const double h = 1 - std::sqrt(between(random, 0, 1)), step = h * whorls - std::floor(h * whorls);
    const double reach = (2.3 * (1 - h) + 0.12) * (1 - 0.4 * step);
    const double angle = between(random, 0, 2 * kPi);
    const double radius = reach * std::sqrt(between(random, 0.08, 1));
    const Vec3d at = around(angle, radius, height * (0.09 + 0.9 * h) - 0.22 * radius);
    const Vec3d out = around(angle, 1, 0);
    const double own = size * (1 - 0.65 * h);
    const Vec3d tip = at + (out + random_direction(random) * 0.7 - Vec3d{0, 0.45, 0}) * own;
    const Vec3d side = normalize(cross(tip - at, random_direction(random))) * (0.28 * own);
    const Vec3d normal = normalize(out + Vec3d{0, 0.75, 0} + random_direction(random) * 0.35);
    tree.push_back(
        {{at - side, at + side, tip}, normal, radius > 0.86 * reach ? Stuff::young_needles : Stuff::needles});
  }
  return tree;
}

// Limbs that end in round masses of leaves, which are two triangles each, a little folded.
Tree oak(int triangles) {
  Tree tree;
  Random random{2, 0};
  constexpr int limbs = 9;
  const int sides = triangles > 1000 ? 8 : 4;
  const Vec3d fork{0.1, 2.6, 0};
  bar(tree, {0, -0.3, 0}, fork, 0.34, 0.24, sides);
  struct Mass {
    Vec3d middle;
    double radius;
  };
  std::vector<Mass> masses;
  for (int i = 0; i < limbs; ++i) {
    const bool leader = i == 0;
    const double angle = 2 * kPi * (i + between(random, -0.3, 0.3)) / (limbs - 1);
    const Vec3d tip =
        around(angle, leader ? 0.2 : between(random, 1.2, 2.2), leader ? 7.2 : between(random, 4.0, 6.6));
    if (triangles > 1000) bar(tree, fork, tip, 0.13, 0.03, 5);
    masses.push_back({tip, leader ? 1.5 : between(random, 1.1, 1.5)});
  }
  const Vec3d heart{0, 5, 0};
  const int leaves = std::max(1, (triangles - static_cast<int>(tree.size())) / 2);
  const double size = 0.16 * std::pow(10000.0 / triangles, 0.45);
  for (int i = 0; i < leaves; ++i) {
    const Mass& mass = masses[static_cast<size_t>(i % limbs)];
    const Vec3d out = random_direction(random);
    const double depth = std::cbrt(between(random, 0.25, 1));
    const Vec3d at = mass.middle + Vec3d{out.x, 0.85 * out.y, out.z} * (mass.radius * depth);
    const Vec3d along = normalize(random_direction(random) + out * 0.4) * size;
    const Vec3d across = normalize(cross(along, out + random_direction(random) * 0.5)) * (0.75 * size);
    const Vec3d fold = normalize(cross(along, across)) * (0.2 * size);
    const Vec3d normal = normalize(normalize(at - heart) + out * 0.8 + random_direction(random) * 0.4);
    const Stuff stuff = depth > 0.93 ? Stuff::young_leaves : Stuff::leaves;
    tree.push_back({{at - along, at + across + fold, at + along}, normal, stuff});
    tree.push_back({{at - along, at + along, at - across + fold}, normal, stuff});
  }
  return tree;
}

size_t write_tree(const Tree& tree, const std::string& library, const std::filesystem::path& file) {
  using Place = std::tuple<int, int, int>;  // millimetres, or hundredths of a normal
  const auto rounded = [](const Vec3d& v, double scale) {
    const auto whole = [&](double x) { return static_cast<int>(std::lround(x * scale)); };
    return Place{whole(v.x), whole(v.y), whole(v.z)};
  };
  std::map<Place, size_t> positions, normals;
  std::string places, directions, faces;
  const auto index = [](std::map<Place, size_t>& known, const Place& p, const char* kind, double scale,
                        int digits, std::string& text) {
    const auto [it, is_new] = known.try_emplace(p, known.size() + 1);
    if (is_new) {
      char line[96];
      const auto [x, y, z] = p;
      std::snprintf(line, sizeof line, "%s %.*f %.*f %.*f\n", kind, digits, x / scale, digits, y / scale,
                    digits, z / scale);
      text += line;
    }
    return std::to_string(it->second);
  };
  constexpr const char* names[] = {"bark", "needles", "young_needles", "leaves", "young_leaves"};
  size_t count = 0;
  for (int stuff = 0; stuff < 5; ++stuff) {
    bool named = false;
    for (const Triangle& t : tree) {
      if (static_cast<int>(t.stuff) != stuff) continue;
      const Place a = rounded(t.corner[0], 1000), b = rounded(t.corner[1], 1000),
                  c = rounded(t.corner[2], 1000);
      if (a == b || b == c || c == a) continue;
      if (!named) faces += "usemtl " + std::string(names[stuff]) + "\n";
      named = true;
      const std::string n = "//" + index(normals, rounded(t.normal, 20), "vn", 20, 2, directions);
      faces += "f";
      for (const Place& p : {a, b, c}) faces += " " + index(positions, p, "v", 1000, 3, places) + n;
      faces += "\n";
      ++count;
    }
  }
  std::FILE* out = std::fopen(file.string().c_str(), "wb");
  if (!out) throw std::runtime_error("cannot write " + file.string());
  const std::string text = "mtllib " + library + "\n" + places + directions + faces;
  const bool written = std::fwrite(text.data(), 1, text.size(), out) == text.size();
  if (std::fclose(out) != 0 || !written) throw std::runtime_error("cannot write " + file.string());
  return count;
}

}  // namespace forest
