#include "io/textures.h"

#include "io/decode_texture.h"
#include "io/text.h"
#include "io/threads.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <vector>

namespace vitral {
namespace {

namespace fs = std::filesystem;

bool is_there(const fs::path& path) {
  std::error_code error;
  return fs::exists(path, error);
}

// The entry of `folder` called `name`, whatever the case of its letters; of several the first in
// the order of bytes. Empty: none.
fs::path find_any_case(const fs::path& folder, const std::string& name) {
  const std::string wanted = lower_case(name);
  fs::path found;
  std::error_code error;
  for (fs::directory_iterator entry(folder.empty() ? "." : folder, error), end; !error && entry != end;
       entry.increment(error)) {
    const fs::path candidate = entry->path().filename();
    if (lower_case(candidate.string()) == wanted && (found.empty() || candidate < found)) found = candidate;
  }
  return found.empty() ? found : folder / found;
}

fs::path find_path(const fs::path& folder, const fs::path& relative) {
  if (is_there(folder / relative)) return folder / relative;
  fs::path at = folder;
  for (const fs::path& part : relative) {
    const fs::path next = at / part;
    at = is_there(next) ? next : find_any_case(at, part.string());
    if (at.empty()) return {};
  }
  return at;
}

struct Loaded {
  std::string path;
  bool colour = false, opacity = false;  // what it is wanted for
  DecodedTexture picture;
  std::string error;
};

void load(Loaded& wanted) {
  try {
    wanted.picture = decode_texture(wanted.path);
  } catch (const InputError& error) {
    wanted.error = error.what();
    return;
  }
  if (!wanted.opacity) return;
  std::vector<uint8_t>& texels = wanted.picture.texture.texels;
  bool use_grey = wanted.picture.alpha == Alpha::none;
  if (!use_grey && !wanted.colour) {
    use_grey = true;
    for (size_t i = 3; i < texels.size() && use_grey; i += 4) use_grey = texels[i] == 255;
  }
  if (!use_grey) return;
  for (size_t i = 0; i < texels.size(); i += 4) {
    texels[i + 3] = static_cast<uint8_t>((texels[i] * 77 + texels[i + 1] * 150 + texels[i + 2] * 29) >> 8);
  }
}

}  // namespace

std::string find_beside(const std::string& other, const std::string& name) {
  std::string forward = name;
  std::replace(forward.begin(), forward.end(), '\\', '/');
  if (forward.empty() || forward.size() > 4096 || forward.find('\0') != std::string::npos) return {};
  const fs::path folder = fs::path(other).parent_path();
  const fs::path path(forward);
  const fs::path found = find_path(folder, path);
  if (!found.empty() || !path.has_filename()) return found.string();
  return find_path(folder, path.filename()).string();
}

void load_textures(std::span<const TextureUse> uses, Scene& scene, Warnings& warnings, int threads) {
  // Two names of one file are one picture.
  std::vector<Loaded> pictures;
  std::vector<size_t> picture_of(uses.size());
  std::map<std::string, size_t> known;
  for (size_t i = 0; i < uses.size(); ++i) {
    const std::string path = find_beside(uses[i].mtl_path, uses[i].file);
    const auto [entry, is_new] = known.try_emplace(
        path.empty() ? "?" + uses[i].file : fs::path(path).lexically_normal().string(), pictures.size());
    if (is_new) {
      pictures.emplace_back();
      pictures.back().path = path;
      if (path.empty()) pictures.back().error = uses[i].file + ": No such file or directory";
    }
    Loaded& picture = pictures[entry->second];
    (uses[i].role == TextureUse::Role::diffuse ? picture.colour : picture.opacity) = true;
    picture_of[i] = entry->second;
  }
  run_tasks(pictures.size(), threads, [&](size_t, size_t i) {
    if (pictures[i].error.empty()) load(pictures[i]);
  });

  // Number those that were read, in the order in which they were named.
  constexpr size_t kFewWarnings = 5;
  size_t failed = 0;
  std::vector<int> number(pictures.size(), kNoTexture);
  std::vector<bool> warned(pictures.size(), false);
  for (size_t i = 0; i < uses.size(); ++i) {
    const size_t p = picture_of[i];
    if (!pictures[p].error.empty()) {
      if (!warned[p] && ++failed <= kFewWarnings) {
        warnings.push_back(uses[i].mtl_path + ":" + std::to_string(uses[i].mtl_line) + ": texture " +
                           pictures[p].error);
      }
      warned[p] = true;
      continue;
    }
    if (number[p] == kNoTexture) {
      number[p] = static_cast<int>(scene.textures.size());
      scene.textures.push_back(std::move(pictures[p].picture.texture));
    }
    Material& material = scene.materials[uses[i].material];
    (uses[i].role == TextureUse::Role::diffuse ? material.diffuse_map : material.opacity_map) = number[p];
  }
  if (failed > kFewWarnings) {
    warnings.push_back(uses[0].mtl_path + ": " + std::to_string(failed - kFewWarnings) +
                       " more textures are missing");
  }
}

}  // namespace vitral
