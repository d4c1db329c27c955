// Golden images: every small scene of scenes/ shows one thing and must come out as its picture in
// tests/golden, pixel for pixel, for every instruction set of this machine and any number of threads.
// A failure writes out/diff/NAME.{expected,actual,difference}.png. With VITRAL_GOLDEN=rewrite the
// pictures are written instead, and the run fails, so that nobody leaves it on.
#include "app/diff.h"
#include "io/image_file.h"
#include "io/project.h"
#include "render/kernel_choice.h"
#include "vitral/render.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <ostream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace vitral {
namespace {

namespace fs = std::filesystem;

// The projects of the plaza begin so; they are large and no golden images.
constexpr std::string_view kPlazaPrefix = "Scene";

std::vector<std::string> names_in(const fs::path& folder, const char* extension) {
  std::vector<std::string> names;
  std::error_code code;
  for (const auto& entry : fs::directory_iterator(folder, code)) {
    const std::string name = entry.path().stem().string();
    if (entry.path().extension() == extension && !name.starts_with(kPlazaPrefix)) names.push_back(name);
  }
  std::sort(names.begin(), names.end());
  return names;
}

fs::path golden(const std::string& name) {
  return fs::path("tests/golden") / (name + ".png");
}

bool rewriting() {
  const char* mode = std::getenv("VITRAL_GOLDEN");
  return mode && std::string_view(mode) == "rewrite";
}

std::vector<std::pair<const char*, Isa>> available_isas() {
  std::vector<std::pair<const char*, Isa>> isas;
  for (const Kernels* kernels : available_kernels()) {
    for (const auto& [name, isa] : {std::pair{"scalar", Isa::scalar}, std::pair{"v2", Isa::v2},
                                    std::pair{"avx2", Isa::avx2}, std::pair{"avx512", Isa::avx512}}) {
      if (std::string_view(kernels->isa) == name) isas.emplace_back(name, isa);
    }
  }
  return isas;
}

// A scene with its camera and settings, as `vitral NAME.xml` renders it.
struct Golden : testing::TestWithParam<std::string> {
  Project project;
  Camera camera;
  Settings settings;

  void load() {
    Warnings warnings;
    project = load_project("scenes/" + GetParam() + ".xml", warnings);
    EXPECT_EQ(warnings, Warnings{});
    const Pipeline& pipeline = project.pipelines[project.default_pipeline];
    settings = pipeline.settings;
    for (const Camera& candidate : project.scene.cameras) {
      if (candidate.name == pipeline.camera) camera = candidate;
    }
    ASSERT_EQ(camera.name, pipeline.camera);
    ASSERT_LE(settings.width * settings.height, 128 * 128) << "a golden image is small";
  }

  Frame render_with(int threads, Isa isa) {
    settings.threads = threads;
    settings.isa = isa;
    Control control;
    return render(project.scene, camera, settings, control);
  }
};

void expect_same_pixels(const std::string& name, const Image<Rgb8>& expected, const Image<Rgb8>& actual) {
  ASSERT_EQ(actual.width, expected.width);
  ASSERT_EQ(actual.height, expected.height);
  const Difference difference = compare(expected, actual);
  EXPECT_EQ(difference.pixels, 0u) << "by at most " << difference.largest << " of 255; see out/diff/" << name
                                   << ".*.png";
  if (difference.pixels == 0) return;
  fs::create_directories("out/diff");
  write_png("out/diff/" + name + ".expected.png", expected);
  write_png("out/diff/" + name + ".actual.png", actual);
  write_png("out/diff/" + name + ".difference.png", difference.picture);
}

TEST_P(Golden, MatchesOnEveryInstructionSetAndThreadCount) {
  load();
  if (HasFatalFailure()) return;
  if (rewriting()) {
    fs::create_directories("tests/golden");
    write_png(golden(GetParam()).string(), render_with(1, Isa::automatic).pixels);
    FAIL() << "VITRAL_GOLDEN=rewrite: " << golden(GetParam())
           << " was written; run the tests again without it";
  }
  ASSERT_TRUE(fs::exists(golden(GetParam()))) << "make golden writes it";
  const Image<Rgb8> expected = read_png(golden(GetParam()).string());

  const Frame first = render_with(1, Isa::scalar);
  EXPECT_EQ(first.stats.not_finite_pixels, 0u);
  ASSERT_FALSE(available_isas().empty());
  for (const auto& [name, isa] : available_isas()) {
    for (const int threads : {1, 2, 5}) {
      SCOPED_TRACE(std::string(name) + ", " + std::to_string(threads) + " threads");
      const Frame frame = render_with(threads, isa);
      expect_same_pixels(GetParam(), expected, frame.pixels);
      // The linear colours too: 8 bits would hide a difference in the last place.
      ASSERT_EQ(frame.radiance.pixels.size(), first.radiance.pixels.size());
      EXPECT_EQ(std::memcmp(frame.radiance.pixels.data(), first.radiance.pixels.data(),
                            first.radiance.pixels.size() * sizeof(Vec3)),
                0);
      if (HasFailure()) return;  // one set of pictures is enough
    }
  }
}

INSTANTIATE_TEST_SUITE_P(, Golden, testing::ValuesIn(names_in("scenes", ".xml")),
                         [](const auto& scene) { return scene.param; });

TEST(GoldenSet, EverySceneHasItsPictureAndEveryPictureItsScene) {
  const std::vector<std::string> scenes = names_in("scenes", ".xml");
  EXPECT_GE(scenes.size(), 16u) << "run the tests in the folder of the README";
  EXPECT_EQ(names_in("tests/golden", ".png"), scenes);
}

TEST(GoldenSet, AFailureIsSeen) {
  Image<Rgb8> a(4, 3), b(4, 3);
  EXPECT_EQ(compare(a, b).pixels, 0u);
  b.row(2)[1] = {0, 1, 0};
  b.row(1)[3] = {5, 0, 0};
  const Difference difference = compare(a, b);
  EXPECT_EQ(difference.pixels, 2u);
  EXPECT_EQ(difference.largest, 5);
  EXPECT_EQ(difference.box.x, 1);
  EXPECT_EQ(difference.box.y, 1);
  EXPECT_EQ(difference.box.width, 3);
  EXPECT_EQ(difference.box.height, 2);
  EXPECT_EQ(difference.picture.row(1)[3].r, 255);
  EXPECT_EQ(difference.picture.row(2)[1].g, 51);
  EXPECT_EQ(difference.picture.row(0)[0].r, 0);
}

}  // namespace
}  // namespace vitral
