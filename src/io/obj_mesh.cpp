#include "io/obj_mesh.h"

#include "io/memory.h"
#include "io/mesh_builder.h"
#include "io/normals.h"
#include "io/threads.h"
#include "io/triangulate.h"

#include <algorithm>
#include <functional>
#include <limits>

namespace vitral {
namespace {

class ObjMeshBuilder {
 public:
  ObjMeshBuilder(ObjFile& file, int threads) : file_(file), threads_(threads), all_(file.before.back()) {}

  ObjMesh build() {
    make_room();
    run_tasks(file_.chunks.size(), threads_, [this](size_t, size_t i) { copy_vertices(i); });
    groups_.resize(wants_groups() ? all_.triangles : 0);
    run_tasks(file_.chunks.size(), threads_, [this](size_t, size_t i) { emit_faces(i); });
    close_gaps();
    if (wants_normals()) {
      mesh_.triangle_normals.resize(mesh_.triangles.size(), {kNoIndex, kNoIndex, kNoIndex});
      compute_normals(mesh_, 0, groups_, threads_);
    }
    if (mesh_.normals.empty()) mesh_.triangle_normals = {};
    return {std::move(mesh_), dropped_};
  }

 private:
  // Memory is touched for the first time here, which is worth sharing out too.
  void make_room() {
    const std::function<void()> tasks[] = {
        [this] { resize_large(mesh_.triangles, all_.triangles); },
        [this] { resize_large(mesh_.triangle_normals, all_.normals > 0 ? all_.triangles : 0); },
        [this] { resize_large(mesh_.triangle_texcoords, all_.texcoords > 0 ? all_.triangles : 0); },
        [this] { resize_large(mesh_.triangle_material, all_.triangles); },
        [this] {
          resize_large(mesh_.positions, all_.positions);
          resize_large(mesh_.texcoords, all_.texcoords);
          resize_large(mesh_.normals, all_.normals);
        },
    };
    run_tasks(std::size(tasks), threads_, [&tasks](size_t, size_t i) { tasks[i](); });
    kept_.resize(file_.chunks.size());
    bad_normals_.resize(file_.chunks.size());
  }

  void copy_vertices(size_t i) {
    ObjChunk& c = file_.chunks[i];
    const ObjBefore& b = file_.before[i];
    std::copy(c.positions.begin(), c.positions.end(),
              mesh_.positions.begin() + static_cast<ptrdiff_t>(b.positions));
    std::transform(c.texcoords.begin(), c.texcoords.end(),
                   mesh_.texcoords.begin() + static_cast<ptrdiff_t>(b.texcoords), clean_texcoord);
    for (size_t n = 0; n < c.normals.size(); ++n) {
      const Vec3 normal = clean_normal(c.normals[n]);
      if (is_missing(normal)) bad_normals_[i] = 1;
      mesh_.normals[b.normals + n] = normal;
    }
    c.positions = {};
    c.texcoords = {};
    c.normals = {};
  }

  static bool is_missing(const Vec3& normal) { return !(normal.x == normal.x); }
  bool any_bad_normal() const { return std::count(bad_normals_.begin(), bad_normals_.end(), 1) > 0; }
  bool wants_normals() const {
    return all_.normals == 0 || any_bad_normal() ||
           std::any_of(file_.chunks.begin(), file_.chunks.end(),
                       [](const ObjChunk& c) { return c.corners_without_normal; });
  }
  bool wants_groups() const {
    return wants_normals() && std::any_of(file_.chunks.begin(), file_.chunks.end(),
                                          [](const ObjChunk& c) { return c.smoothing; });
  }

  // A negative index of the file counts from where its chunk starts.
  uint32_t resolve(uint32_t index, size_t base, size_t count, const char* what, size_t chunk,
                   size_t line) const {
    const bool relative = index > kLargestIndex;
    const int64_t n = relative ? static_cast<int64_t>(base) + static_cast<int32_t>(index - kRelative) : index;
    if (n >= 0 && n < static_cast<int64_t>(count)) return static_cast<uint32_t>(n);
    const std::string shown = relative
                                  ? "a relative " + std::string(what) + " index reaches back before the first"
                                  : std::string(what) + " index " + std::to_string(n + 1) +
                                        " is out of range (" + std::to_string(count) + " in the file)";
    fail(file_.path, file_.before[chunk].lines + line + 1, shown);
  }

  // Some files refer to normals or texture coordinates and hold none at all, as if they were cut out.
  ObjCorner resolve(const ObjCorner& raw, const ObjBefore& b, size_t chunk, size_t line) const {
    ObjCorner corner = raw;
    corner.position = resolve(raw.position, b.positions, all_.positions, "vertex", chunk, line);
    if (all_.texcoords == 0) {
      corner.texcoord = kNoIndex;
    } else if (raw.texcoord != kNoIndex) {
      corner.texcoord = resolve(raw.texcoord, b.texcoords, all_.texcoords, "texture coordinate", chunk, line);
    }
    if (all_.normals == 0) {
      corner.normal = kNoIndex;
    } else if (raw.normal != kNoIndex) {
      corner.normal = resolve(raw.normal, b.normals, all_.normals, "normal", chunk, line);
      if (is_missing(mesh_.normals[corner.normal])) corner.normal = kNoIndex;
    }
    return corner;
  }

  // Writes the triangles of a chunk's faces where they would be if no triangle of the file were left
  // out; close_gaps() moves them together.
  void emit_faces(size_t i) {
    ObjChunk& c = file_.chunks[i];
    const ObjBefore& b = file_.before[i];
    size_t out = b.triangles;
    auto state = c.states.begin();
    uint32_t material = b.material, smoothing = b.smoothing;
    std::vector<ObjCorner> face;
    std::vector<Vec3> polygon;
    std::vector<LocalCorners> cut;
    TriangulateScratch scratch;

    const ObjCorner* next = c.corners.data();
    for (size_t f = 0; f < c.faces.size(); ++f) {
      for (; state != c.states.end() && state->face <= f; ++state) {
        material = state->material;
        smoothing = state->smoothing;
      }
      const size_t n = c.faces[f].corners;
      face.resize(n);
      for (ObjCorner& corner : face) corner = resolve(*next++, b, i, c.faces[f].line);
      if (n == 3) {
        cut.assign(1, {0, 1, 2});
      } else {
        polygon.clear();
        for (const ObjCorner& corner : face) polygon.push_back(mesh_.positions[corner.position]);
        triangulate(polygon, scratch, cut);
      }
      for (const LocalCorners& t : cut)
        out += emit(face[t[0]], face[t[1]], face[t[2]], material, smoothing, out);
    }
    kept_[i] = out - b.triangles;
    c.corners = {};
    c.faces = {};
    c.states = {};
  }

  // Returns how many triangles were written: none when it is degenerate.
  size_t emit(const ObjCorner& p, const ObjCorner& q, const ObjCorner& r, uint32_t material,
              uint32_t smoothing, size_t out) {
    if (is_degenerate(mesh_.positions[p.position], mesh_.positions[q.position], mesh_.positions[r.position]))
      return 0;
    mesh_.triangles[out] = {p.position, q.position, r.position};
    mesh_.triangle_material[out] = material;
    if (!mesh_.triangle_normals.empty()) mesh_.triangle_normals[out] = {p.normal, q.normal, r.normal};
    if (!mesh_.triangle_texcoords.empty())
      mesh_.triangle_texcoords[out] = {p.texcoord, q.texcoord, r.texcoord};
    if (!groups_.empty()) groups_[out] = smoothing;
    return 1;
  }

  void close_gaps() {
    size_t kept = 0;
    for (const size_t n : kept_) kept += n;
    dropped_ = all_.triangles - kept;
    if (dropped_ == 0) return;
    close_gaps(mesh_.triangles, kept);
    close_gaps(mesh_.triangle_normals, kept);
    close_gaps(mesh_.triangle_texcoords, kept);
    close_gaps(mesh_.triangle_material, kept);
    close_gaps(groups_, kept);
  }

  template <class T>
  void close_gaps(std::vector<T>& list, size_t kept) const {
    if (list.empty()) return;
    auto to = list.begin();
    for (size_t i = 0; i < kept_.size(); ++i) {
      const auto from = list.begin() + static_cast<ptrdiff_t>(file_.before[i].triangles);
      to = std::move(from, from + static_cast<ptrdiff_t>(kept_[i]), to);
    }
    list.resize(kept);
    trim(list);
  }

  ObjFile& file_;
  int threads_;
  const ObjBefore& all_;
  Mesh mesh_;
  std::vector<uint32_t> groups_;   // smoothing group of each triangle; empty: not needed
  std::vector<size_t> kept_;       // triangles of each chunk
  std::vector<char> bad_normals_;  // whether a chunk holds normals that are zero or not finite
  size_t dropped_ = 0;
};

}  // namespace

ObjMesh build_obj_mesh(ObjFile& file, int threads) {
  return ObjMeshBuilder(file, threads).build();
}

}  // namespace vitral
