// Generates a square in the manner of Lisbon: plaza.obj, plaza.mtl and its textures.
//
//   plaza FOLDER [--detail X]      X = 1: some 300,000 triangles; they grow about in proportion
//
// Two views are composed: `Fonte`, from (7.42, 18.61, -38.62) along (0.31, -0.36, 0.87), over the whole
// square; and `Vidro`, from (45.1, 2.5, 9.2) along (0.56, 0.05, 0.83), before the panes of a cafe. Both
// have a vertical field of view of 60 degrees. The sun travels along (0.597, -0.390, 0.700).
#include <charconv>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <future>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "layout.h"
#include "materials.h"
#include "textures.h"
#include "write_obj.h"

namespace {

struct Arguments {
  std::filesystem::path folder;
  plaza::Detail detail;
};

constexpr double kLeastDetail = 0.02, kMostDetail = 40;

// Throws std::invalid_argument when the command line makes no sense.
Arguments parse(int argc, char** argv) {
  Arguments arguments;
  for (int i = 1; i < argc; ++i) {
    const std::string_view word = argv[i];
    if (word == "--detail") {
      if (++i == argc) throw std::invalid_argument("--detail needs a number");
      const std::string_view text = argv[i];
      const auto [end, error] =
          std::from_chars(text.data(), text.data() + text.size(), arguments.detail.level);
      const bool whole = error == std::errc{} && end == text.data() + text.size();
      if (!whole || !(arguments.detail.level >= kLeastDetail && arguments.detail.level <= kMostDetail)) {
        throw std::invalid_argument("--detail wants a number from 0.02 to 40");
      }
    } else if (arguments.folder.empty() && !word.starts_with("-")) {
      arguments.folder = word;
    } else {
      throw std::invalid_argument("unexpected argument: " + std::string(word));
    }
  }
  if (arguments.folder.empty()) throw std::invalid_argument("usage: plaza FOLDER [--detail X]");
  return arguments;
}

void generate(const Arguments& arguments) {
  std::filesystem::create_directories(arguments.folder);
  // Pictures and geometry are independent of each other.
  const plaza::TextureJob job{arguments.folder, arguments.detail.level < 0.5 ? 2 : 1};
  std::vector<std::future<void>> painters;
  for (const auto paint : {plaza::paint_ground_textures, plaza::paint_wall_textures,
                           plaza::paint_wood_textures, plaza::paint_leaf_textures}) {
    painters.push_back(std::async(std::launch::async, paint, std::cref(job)));
  }
  plaza::Mesh mesh;
  mesh.detail = arguments.detail;
  plaza::lay_out(mesh);
  plaza::write_materials(arguments.folder / "plaza.mtl");
  for (auto& painter : painters) painter.get();
  // Last, because it is what make waits for.
  plaza::write_obj(mesh, arguments.folder / "plaza.obj");
  std::printf("%s: %zu triangles\n", (arguments.folder / "plaza.obj").string().c_str(),
              plaza::triangle_count(mesh));
}

}  // namespace

int main(int argc, char** argv) {
  try {
    generate(parse(argc, argv));
  } catch (const std::invalid_argument& error) {
    std::fprintf(stderr, "plaza: %s\n", error.what());
    return 2;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "plaza: %s\n", error.what());
    return 1;
  }
}
