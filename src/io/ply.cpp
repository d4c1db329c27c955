#include "io/ply.h"

#include "io/file.h"
#include "io/mesh_builder.h"
#include "io/normals.h"
#include "io/ply_header.h"
#include "io/text.h"
#include "io/triangulate.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>

namespace vitral {
namespace {

constexpr uint64_t kMaxFileBytes = uint64_t{4} << 30;

// The numbers of the body, one after the other.
class PlyBody {
 public:
  // `bytes` ends with a line feed that does not belong to the file.
  PlyBody(const PlyHeader& header, std::string_view bytes, const std::string& path)
      : format_(header.format), path_(path) {
    c_ = {bytes.data() + header.body, bytes.data() + bytes.size() - 1, header.body_line};
  }

  // Every number is exact as a double. Throws InputError at the end of the file.
  double read(PlyType type) { return format_ == PlyFormat::ascii ? read_text(type) : read_binary(type); }

  // How many numbers there may still be.
  uint64_t room(PlyType type) const {
    const auto left = static_cast<uint64_t>(c_.end - c_.p);
    return format_ == PlyFormat::ascii ? left / 2 + 1 : left / byte_size(type);
  }

  // `what` and `row` tell where, when the file has no lines.
  [[noreturn]] void fail_here(const std::string& reason, const std::string& what, uint64_t row) const {
    if (format_ == PlyFormat::ascii) fail(path_, c_.line, reason);
    fail(path_, quoted(what) + " " + std::to_string(row) + ": " + reason);
  }

 private:
  double read_text(PlyType type) {
    while (c_.p < c_.end && (is_blank(*c_.p) || is_newline(*c_.p))) {
      if (*c_.p == '\n' || (*c_.p == '\r' && c_.p[1] != '\n')) ++c_.line;
      ++c_.p;
    }
    if (c_.p == c_.end) fail(path_, c_.line, "the file ends too early");
    if (type != PlyType::float32 && type != PlyType::float64) {
      Cursor next = c_;
      int64_t whole = 0;
      if (read_integer(next, whole) && (is_blank(*next.p) || is_newline(*next.p))) {
        c_ = next;
        return static_cast<double>(whole);
      }
    }
    float value = 0;
    if (!read_float(c_, value) || !(is_blank(*c_.p) || is_newline(*c_.p))) {
      fail(path_, c_.line, quoted(read_word(c_)) + " is not a number");
    }
    return static_cast<double>(value);
  }

  double read_binary(PlyType type) {
    const size_t size = byte_size(type);
    if (static_cast<size_t>(c_.end - c_.p) < size) fail(path_, "the file ends too early");
    uint64_t bits = 0;
    for (size_t i = 0; i < size; ++i) {
      const size_t at = format_ == PlyFormat::little_endian ? size - 1 - i : i;
      bits = (bits << 8) | static_cast<uint8_t>(c_.p[at]);
    }
    c_.p += size;
    switch (type) {
      case PlyType::int8:
        return static_cast<int8_t>(bits);
      case PlyType::int16:
        return static_cast<int16_t>(bits);
      case PlyType::int32:
        return static_cast<int32_t>(bits);
      case PlyType::float32:
        return static_cast<double>(std::bit_cast<float>(static_cast<uint32_t>(bits)));
      case PlyType::float64:
        return std::bit_cast<double>(bits);
      default:
        return static_cast<double>(bits);
    }
  }

  Cursor c_;
  PlyFormat format_;
  const std::string& path_;
};

float narrow(double x) {
  constexpr double kLargest = std::numeric_limits<float>::max();
  if (std::fabs(x) > kLargest)
    return x > 0 ? std::numeric_limits<float>::infinity() : -std::numeric_limits<float>::infinity();
  return static_cast<float>(x);
}

class PlyLoader {
 public:
  PlyLoader(const std::string& path, Scene& scene, Warnings& warnings, int threads)
      : path_(path), scene_(scene), warnings_(warnings), threads_(threads) {}

  void load() {
    {
      check_magic();
      std::string bytes = read_file(path_, kMaxFileBytes);
      const PlyHeader header = read_ply_header(bytes, path_);
      find_vertex_count(header);
      bytes += '\n';
      PlyBody body(header, bytes, path_);
      for (const PlyElement& element : header.elements) read_element(element, body);
    }
    cut_faces();
    report_dropped(path_, mesh_.triangles.size(), dropped_, scene_, warnings_);
    finish();
  }

 private:
  // Before a large file is read that is none.
  void check_magic() const {
    const InputFile file(path_);
    std::array<char, 4> magic{};
    const auto size = static_cast<size_t>(std::min<uint64_t>(file.size(), magic.size()));
    file.read(0, {magic.data(), size});
    check_ply_magic({magic.data(), size}, path_);
  }

  // Where a vertex keeps the number that a property holds.
  enum Slot { x, y, z, nx, ny, nz, u, v, kSlots, elsewhere };

  static Slot slot_of(const PlyProperty& property) {
    constexpr std::array<std::pair<std::string_view, Slot>, 12> kNames = {{{"x", x},
                                                                           {"y", y},
                                                                           {"z", z},
                                                                           {"nx", nx},
                                                                           {"ny", ny},
                                                                           {"nz", nz},
                                                                           {"u", u},
                                                                           {"v", v},
                                                                           {"s", u},
                                                                           {"t", v},
                                                                           {"texture_u", u},
                                                                           {"texture_v", v}}};
    for (const auto& [name, slot] : kNames) {
      if (!property.is_list && property.name == name) return slot;
    }
    return elsewhere;
  }

  void find_vertex_count(const PlyHeader& header) {
    for (const PlyElement& element : header.elements) {
      if (element.name != "vertex") continue;
      if (vertex_count_ > 0) fail(path_, "there is more than one element 'vertex'");
      vertex_count_ = element.count;
    }
    if (vertex_count_ > (uint64_t{1} << 30)) fail(path_, "more than 2^30 vertices");
  }

  enum class List { skipped, face, strips };

  void read_element(const PlyElement& element, PlyBody& body) {
    if (element.properties.empty()) return;  // rows without bytes, however many
    if (element.name == "vertex") return read_vertices(element, body);
    const List wanted = element.name == "face"        ? List::face
                        : element.name == "tristrips" ? List::strips
                                                      : List::skipped;
    for (uint64_t row = 0; row < element.count; ++row) {
      bool found = false;  // only the first of several lists of corners counts
      for (const PlyProperty& p : element.properties) {
        const bool is_it = !found && p.is_list && (p.name == "vertex_indices" || p.name == "vertex_index");
        found |= is_it;
        read_property(p, body, element.name, row, is_it ? wanted : List::skipped);
      }
    }
  }

  // Reads or skips one property; the faces of a list go to corners_ and sizes_.
  void read_property(const PlyProperty& p, PlyBody& body, const std::string& what, uint64_t row, List list) {
    if (!p.is_list) {
      body.read(p.type);
      return;
    }
    const double count = body.read(p.count_type);
    if (!(count >= 0) || count > static_cast<double>(body.room(p.type))) {
      body.fail_here("a list is longer than the file, or shorter than nothing", what, row);
    }
    const auto n = static_cast<uint64_t>(count);
    uint32_t strip = 0;  // vertices since the strip began
    for (uint64_t i = 0; i < n; ++i) {
      const double index = body.read(p.type);
      if (list == List::skipped) continue;
      if (list == List::strips && index == -1) {
        strip = 0;
        continue;
      }
      if (!(index >= 0) || index >= static_cast<double>(vertex_count_)) {
        body.fail_here("vertex index " +
                           std::to_string(static_cast<long long>(std::clamp(index, -1e15, 1e15))) +
                           " is out of range (" + std::to_string(vertex_count_) + " in the file)",
                       what, row);
      }
      if (list == List::strips) {
        add_to_strip(static_cast<uint32_t>(index), strip++);
      } else {
        corners_.push_back(static_cast<uint32_t>(index));
      }
    }
    if (list == List::face) sizes_.push_back(static_cast<uint32_t>(n));
  }

  // Each vertex makes a triangle with the two before it, turned the other way every time. Repeated
  // vertices only lead the strip elsewhere.
  void add_to_strip(uint32_t vertex, uint32_t number) {
    last_[number % 3] = vertex;
    if (number < 2) return;
    const uint32_t a = last_[(number + 1) % 3], b = last_[(number + 2) % 3];
    if (a == b || b == vertex || a == vertex) return;
    const bool turned = number % 2 == 1;
    corners_.insert(corners_.end(), {turned ? b : a, turned ? a : b, vertex});
    sizes_.push_back(3);
  }

  void read_vertices(const PlyElement& element, PlyBody& body) {
    std::vector<Slot> slots;
    std::array<bool, elsewhere + 1> has{};
    for (const PlyProperty& p : element.properties) {
      slots.push_back(slot_of(p));
      has[slots.back()] = true;
    }
    if (!has[x] || !has[y] || !has[z]) fail(path_, "the vertices have no x, y and z");
    const bool with_normals = has[nx] && has[ny] && has[nz], with_texcoords = has[u] && has[v];

    mesh_.positions.reserve(element.count);
    mesh_.normals.reserve(with_normals ? element.count : 0);
    mesh_.texcoords.reserve(with_texcoords ? element.count : 0);
    std::array<double, elsewhere + 1> value{};
    for (uint64_t row = 0; row < element.count; ++row) {
      for (size_t i = 0; i < slots.size(); ++i) {
        const PlyProperty& p = element.properties[i];
        if (p.is_list) {
          read_property(p, body, element.name, row, List::skipped);
        } else {
          value[slots[i]] = body.read(p.type);
        }
      }
      mesh_.positions.push_back({narrow(value[x]), narrow(value[y]), narrow(value[z])});
      if (with_normals) {
        mesh_.normals.push_back(clean_normal({narrow(value[nx]), narrow(value[ny]), narrow(value[nz])}));
      }
      if (with_texcoords) mesh_.texcoords.push_back(clean_texcoord({narrow(value[u]), narrow(value[v])}));
    }
  }

  void cut_faces() {
    if (!corners_.empty() && mesh_.positions.empty()) fail(path_, "the vertices have no properties");
    size_t triangles = 0;
    for (const uint32_t n : sizes_) triangles += n >= 3 ? n - 2 : 0;
    if (triangles > (size_t{1} << 30)) fail(path_, "more than 2^30 triangles");
    mesh_.triangles.reserve(triangles);
    std::vector<Vec3> polygon;
    std::vector<LocalCorners> cut;
    TriangulateScratch scratch;
    const uint32_t* face = corners_.data();
    for (const uint32_t n : sizes_) {
      polygon.clear();
      for (uint32_t i = 0; i < n; ++i) polygon.push_back(mesh_.positions[face[i]]);
      cut.clear();
      if (n >= 3) triangulate(polygon, scratch, cut);
      for (const LocalCorners& t : cut) {
        if (is_degenerate(polygon[t[0]], polygon[t[1]], polygon[t[2]])) {
          ++dropped_;
        } else {
          mesh_.triangles.push_back({face[t[0]], face[t[1]], face[t[2]]});
        }
      }
      face += n;
    }
    trim(mesh_.triangles);
    corners_ = {};
    sizes_ = {};
  }

  // A vertex has its normal and texture coordinates under its own number.
  void finish() {
    const Corners none{kNoIndex, kNoIndex, kNoIndex};
    if (!mesh_.texcoords.empty()) mesh_.triangle_texcoords = mesh_.triangles;
    bool missing = mesh_.normals.empty();
    if (missing) {
      mesh_.triangle_normals.assign(mesh_.triangles.size(), none);
    } else {
      mesh_.triangle_normals = mesh_.triangles;
      for (Corners& corners : mesh_.triangle_normals) {
        for (uint32_t& normal : corners) {
          if (mesh_.normals[normal].x == mesh_.normals[normal].x) continue;  // NaN: none
          normal = kNoIndex;
          missing = true;
        }
      }
    }
    if (missing) compute_normals(mesh_, 0, {}, threads_);
    if (mesh_.normals.empty()) mesh_.triangle_normals = {};
    const uint32_t material = add_default_material(scene_);
    mesh_.triangle_material.assign(mesh_.triangles.size(), 0);
    append(std::move(mesh_), material, scene_.mesh);
  }

  const std::string& path_;
  Scene& scene_;
  Warnings& warnings_;
  int threads_;
  uint64_t vertex_count_ = 0;
  Mesh mesh_;
  std::vector<uint32_t> corners_;   // of all faces, one after the other
  std::vector<uint32_t> sizes_;     // of each face
  std::array<uint32_t, 3> last_{};  // vertices of a strip
  size_t dropped_ = 0;
};

}  // namespace

void load_ply(const std::string& path, Scene& scene, Warnings& warnings, int threads) {
  PlyLoader(path, scene, warnings, threads).load();
}

}  // namespace vitral
