#include "write_obj.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <numeric>
#include <stdexcept>
#include <string_view>

namespace plaza {
namespace {

void put(std::string& text, std::string_view s) {
  text += s;
}
void put(std::string& text, uint64_t number) {
  char digits[24];
  text.append(digits, std::to_chars(digits, digits + sizeof digits, number).ptr);
}

// Four decimals, by integers: no rounding mode and no locale has a say.
void put_decimal(std::string& text, double value) {
  int64_t units = std::llround(value * 10000);
  if (units < 0) {
    text += '-';
    units = -units;
  }
  put(text, static_cast<uint64_t>(units / 10000));
  int64_t rest = units % 10000;
  if (rest == 0) return;
  char digits[5] = {'.', '0', '0', '0', '0'};
  for (int i = 4; i > 0; --i, rest /= 10) digits[i] = static_cast<char>('0' + rest % 10);
  size_t length = 5;
  while (digits[length - 1] == '0') --length;
  text.append(digits, length);
}

void put_vector(std::string& text, std::string_view keyword, const Vec3d& v) {
  put(text, keyword);
  for (const double c : {v.x, v.y, v.z}) {
    text += ' ';
    put_decimal(text, c);
  }
  text += '\n';
}

void put_face(std::string& text, const Face& face) {
  text += 'f';
  for (size_t i = 0; i < face.corners; ++i) {
    text += ' ';
    put(text, face.positions[i] + 1ull);
    text += '/';
    put(text, face.texcoords[i] + 1ull);
    text += '/';
    put(text, face.normals[i] + 1ull);
  }
  text += '\n';
}

}  // namespace

size_t triangle_count(const Mesh& mesh) {
  size_t count = 0;
  for (const Face& face : mesh.faces) count += face.corners - 2u;
  return count;
}

void write_obj(const Mesh& mesh, const std::filesystem::path& file) {
  std::ofstream out(file, std::ios::binary);
  std::string text = "# A square in the manner of Lisbon. Metres, y up.\nmtllib plaza.mtl\n";
  const auto flush = [&](size_t limit) {
    if (text.size() <= limit) return;
    out.write(text.data(), static_cast<std::streamsize>(text.size()));
    text.clear();
  };
  constexpr size_t kChunk = 1u << 20;
  for (const Vec3d& p : mesh.positions) put_vector(text, "v", p), flush(kChunk);
  for (const Vec2d& t : mesh.texcoords) {
    put(text, "vt ");
    put_decimal(text, t.x);
    text += ' ';
    put_decimal(text, t.y);
    text += '\n';
    flush(kChunk);
  }
  for (const Vec3d& n : mesh.normals) put_vector(text, "vn", n), flush(kChunk);

  std::vector<size_t> order(mesh.faces.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::sort(order.begin(), order.end(), [&](size_t a, size_t b) {
    const Face &f = mesh.faces[a], &g = mesh.faces[b];
    if (f.group != g.group) return f.group < g.group;
    if (f.surface != g.surface) return f.surface < g.surface;
    return a < b;
  });
  const Face* previous = nullptr;
  for (const size_t i : order) {
    const Face& face = mesh.faces[i];
    const bool new_group = !previous || previous->group != face.group;
    if (new_group) {
      put(text, "g ");
      put(text, mesh.groups[face.group]);
      text += '\n';
    }
    if (new_group || previous->surface != face.surface) {
      put(text, "usemtl ");
      put(text, material_name(face.surface));
      text += '\n';
    }
    put_face(text, face);
    flush(kChunk);
    previous = &face;
  }
  flush(0);
  out.flush();
  if (!out) throw std::runtime_error(file.string() + ": cannot be written");
}

}  // namespace plaza
