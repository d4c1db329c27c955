#include "io/obj.h"

#include "io/file.h"
#include "io/mesh_builder.h"
#include "io/mtl.h"
#include "io/obj_chunk.h"
#include "io/obj_mesh.h"
#include "io/text.h"
#include "io/textures.h"
#include "io/threads.h"

#include <algorithm>
#include <atomic>
#include <map>
#include <tuple>
#include <utility>
#include <vector>

namespace vitral {
namespace {

constexpr uint64_t kMinChunkBytes = uint64_t{1} << 18;
constexpr uint64_t kMaxChunkBytes = uint64_t{1} << 23;
constexpr size_t kFewWarnings = 5;

// Some write blanks in the names of files as "\\ ".
std::string without_escapes(std::string name) {
  for (size_t at = name.find("\\ "); at != std::string::npos; at = name.find("\\ ", at + 1))
    name.erase(at, 1);
  return name;
}

constexpr size_t kMaxTriangles = size_t{1} << 30;

class ObjLoader {
 public:
  ObjLoader(const std::string& path, Scene& scene, Warnings& warnings, int threads)
      : path_(path), scene_(scene), warnings_(warnings), threads_(threads) {
    file_.path = path;
  }

  void load() {
    read_chunks();
    check_chunks();
    load_materials();
    resolve_states();
    ObjMesh built = build_obj_mesh(file_, threads_);
    report_dropped(path_, built.mesh.triangles.size(), built.dropped, scene_, warnings_);
    join(std::move(built.mesh));
  }

 private:
  [[noreturn]] void fail_at(size_t chunk, size_t line, const std::string& reason) const {
    fail(path_, file_.before[chunk].lines + line + 1, reason);
  }
  void warn_at(size_t chunk, size_t line, const std::string& reason) {
    warnings_.push_back(path_ + ":" + std::to_string(file_.before[chunk].lines + line + 1) + ": " + reason);
  }

  void read_chunks();
  void check_chunks();
  void load_materials();
  void load_library(size_t chunk, const ObjNote& note);
  void warn_unread(size_t chunk, const ObjNote& note, const std::string& name, const std::string& reason);
  void resolve_states();
  void join(Mesh mesh);

  const std::string& path_;
  Scene& scene_;
  Warnings& warnings_;
  int threads_;
  ObjFile file_;
  std::vector<MtlMaterial> library_;
  std::vector<size_t> library_file_;  // [material of library_]: into library_paths_
  std::vector<std::string> library_paths_;
  std::vector<std::string> unread_libraries_;  // names and files, each warned of once
  std::map<std::string, uint32_t> material_by_name_;  // into library_
};

// Chunks of text become chunks of numbers, in parallel.
void ObjLoader::read_chunks() {
  const InputFile file(path_);
  if (file.size() == 0) fail(path_, "the file is empty");
  const uint64_t share = file.size() / (8 * thread_count(threads_));  // several chunks for each thread
  const uint64_t chunk_bytes = std::clamp(share, kMinChunkBytes, kMaxChunkBytes);
  file_.chunks.resize(static_cast<size_t>((file.size() + chunk_bytes - 1) / chunk_bytes));
  std::vector<std::vector<char>> buffers(thread_count(threads_));
  std::atomic<bool> stop{false};
  run_tasks(file_.chunks.size(), threads_, [&](size_t worker, size_t i) {
    if (stop) return;
    const uint64_t begin = i * chunk_bytes;
    file_.chunks[i] =
        read_obj_chunk(file, begin, std::min(file.size(), begin + chunk_bytes), buffers[worker]);
    if (!file_.chunks[i].error.text.empty()) stop = true;
  });
}

void ObjLoader::check_chunks() {
  file_.before.resize(1);
  size_t statements = 0;
  bool with_normal = false, with_texcoord = false;
  ObjNote skipped, small;
  for (size_t i = 0; i < file_.chunks.size(); ++i) {
    const ObjChunk& c = file_.chunks[i];
    if (!c.error.text.empty()) fail_at(i, c.error.line, c.error.text);
    for (const auto& [note, sum] : {std::pair{&c.skipped, &skipped}, std::pair{&c.small_faces, &small}}) {
      if (sum->count == 0 && note->count > 0) *sum = {file_.before[i].lines + note->line, note->text, 0};
      sum->count += note->count;
    }
    ObjBefore next = file_.before[i];
    next.lines += c.lines;
    next.positions += c.positions.size();
    next.texcoords += c.texcoords.size();
    next.normals += c.normals.size();
    next.triangles += c.triangles;
    file_.before.push_back(next);
    statements += c.statements;
    with_normal |= c.corners_with_normal;
    with_texcoord |= c.corners_with_texcoord;
  }
  if (statements == 0) fail(path_, "not an OBJ file: no statement is known");
  const ObjBefore& all = file_.before.back();
  if (std::max({all.positions, all.texcoords, all.normals, all.triangles}) > kMaxTriangles) {
    fail(path_, "more than 2^30 vertices or triangles");
  }
  const auto warn = [this](const ObjNote& note, const std::string& reason) {
    if (note.count > 0) warnings_.push_back(path_ + ":" + std::to_string(note.line + 1) + ": " + reason);
  };
  warn(skipped,
       quoted(skipped.text) + " is skipped" +
           (skipped.count > 1 ? ", as are " + std::to_string(skipped.count - 1) + " more statements" : ""));
  warn(small, std::to_string(small.count) + " face(s) of fewer than three corners, the first here");
  if (with_normal && all.normals == 0)
    warnings_.push_back(path_ + ": faces name normals, but there are none");
  if (with_texcoord && all.texcoords == 0) {
    warnings_.push_back(path_ + ": faces name texture coordinates, but there are none");
  }
}

// All libraries in the order in which they are named. Of several materials of one name the first
// counts. All materials join the scene.
void ObjLoader::load_materials() {
  for (size_t i = 0; i < file_.chunks.size(); ++i) {
    for (const ObjNote& note : file_.chunks[i].libraries) load_library(i, note);
  }
  for (size_t i = 0; i < library_.size(); ++i) {
    material_by_name_.try_emplace(library_[i].material.name, static_cast<uint32_t>(i));
  }
}

// The text after mtllib is one name, or else several, each ending in ".mtl", or else several words.
void ObjLoader::load_library(size_t chunk, const ObjNote& note) {
  std::vector<std::string> found, names;
  const auto look_for = [&](const std::string& name) {
    const std::string file = find_beside(path_, name);
    if (!file.empty()) found.push_back(file);
    return !file.empty();
  };
  if (!look_for(note.text)) {
    std::string name;
    for (size_t at = 0; at < note.text.size();) {
      const size_t blank = std::min(note.text.find_first_of(" \t", at), note.text.size());
      if (!name.empty()) name += ' ';
      name += note.text.substr(at, blank - at);
      at = std::min(note.text.find_first_not_of(" \t", blank), note.text.size());
      if (lower_case(name).ends_with(".mtl") || at == note.text.size())
        names.push_back(std::exchange(name, {}));
    }
    for (const std::string& n : names) {
      if (!look_for(n) && !look_for(without_escapes(n)))
        warn_unread(chunk, note, n, quoted(n) + ": No such file or directory");
    }
  }
  for (const std::string& file : found) {
    if (std::find(library_paths_.begin(), library_paths_.end(), file) != library_paths_.end()) continue;
    library_paths_.push_back(file);
    try {
      std::vector<MtlMaterial> materials = load_mtl(file, warnings_);
      library_.insert(library_.end(), materials.begin(), materials.end());
      library_file_.resize(library_.size(), library_paths_.size() - 1);
    } catch (const InputError& error) {
      warn_unread(chunk, note, file, error.what());
    }
  }
}

void ObjLoader::warn_unread(size_t chunk, const ObjNote& note, const std::string& name,
                            const std::string& reason) {
  if (std::find(unread_libraries_.begin(), unread_libraries_.end(), name) != unread_libraries_.end()) return;
  unread_libraries_.push_back(name);
  warn_at(chunk, note.line, "material library " + reason);
}

// Carries material and smoothing group from chunk to chunk, and turns names into numbers. A name
// that no library has gets a material of default values. No word of it when some library could not be
// read: the name may well be in there, and that warning says enough.
void ObjLoader::resolve_states() {
  size_t unknown = 0;
  for (size_t i = 0; i < file_.chunks.size(); ++i) {
    ObjChunk& c = file_.chunks[i];
    std::vector<uint32_t> number;
    for (size_t n = 0; n < c.material_names.size(); ++n) {
      const std::string& name = c.material_names[n];
      const auto [entry, is_new] =
          material_by_name_.try_emplace(name, static_cast<uint32_t>(library_.size()));
      if (is_new) {
        library_.emplace_back();
        library_.back().material.name = name.empty() ? "default" : name;
        library_file_.push_back(0);
        if (unread_libraries_.empty() && ++unknown <= kFewWarnings) {
          warn_at(i, c.material_lines[n], "no material library defines " + quoted(name));
        }
      }
      number.push_back(entry->second);
    }
    ObjBefore& next = file_.before[i + 1];
    next.material = file_.before[i].material;
    next.smoothing = file_.before[i].smoothing;
    for (ObjState& state : c.states) {
      state.material = state.material == kNoIndex ? file_.before[i].material : number[state.material];
      if (!state.smoothing_known) state.smoothing = file_.before[i].smoothing;
      next.material = state.material;
      next.smoothing = state.smoothing;
    }
  }
  if (unknown > kFewWarnings) {
    warnings_.push_back(path_ + ": " + std::to_string(unknown - kFewWarnings) +
                        " more materials are not defined");
  }
}

// All materials of the libraries join the scene, with the textures of those that are in use.
void ObjLoader::join(Mesh mesh) {
  std::vector<bool> used(library_.size() + 1, false);
  const auto no_material = static_cast<uint32_t>(library_.size());
  for (uint32_t& material : mesh.triangle_material) {
    if (material == kNoIndex) material = no_material;
    used[material] = true;
  }
  const size_t first = scene_.materials.size();
  std::vector<TextureUse> uses;
  for (size_t i = 0; i < library_.size(); ++i) {
    const MtlMaterial& m = library_[i];
    scene_.materials.push_back(m.material);
    if (!used[i]) continue;
    const std::string mtl_path = library_paths_.empty() ? path_ : library_paths_[library_file_[i]];
    for (const auto& [role, file, line] :
         {std::tuple{TextureUse::Role::diffuse, m.diffuse_map, m.diffuse_line},
          std::tuple{TextureUse::Role::opacity, m.opacity_map, m.opacity_line}}) {
      if (!file.empty()) uses.push_back({role, first + i, file, mtl_path, line});
    }
  }
  if (used[no_material]) add_default_material(scene_);
  append(std::move(mesh), static_cast<uint32_t>(first), scene_.mesh);
  load_textures(uses, scene_, warnings_, threads_);
}

}  // namespace

void load_obj(const std::string& path, Scene& scene, Warnings& warnings, int threads) {
  ObjLoader(path, scene, warnings, threads).load();
}

}  // namespace vitral
