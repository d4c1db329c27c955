// A forest of 10,000 trees, 10^8 triangles in all, is rendered within 1 GB; rasterized and traced it looks
// the same. FOREST names the generator, VITRAL the program; `make test` sets both.
#include "app/diff.h"
#include "io/image_file.h"
#include "json_text.h"
#include "process.h"
#include "scratch.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <sstream>

namespace vitral {
namespace {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr int kTrees = 400;  // sanitizers take time and memory of their own
#else
constexpr int kTrees = 10000;
#endif
constexpr int kTriangles = 10000;

struct Forest : testing::Test {
  test::ScratchFolder folder;

  void SetUp() override {
    const char* generator = std::getenv("FOREST");
    if (!generator || test::program().empty())
      GTEST_SKIP() << "FOREST and VITRAL do not name generator and program: use `make test`";
    const std::string made = std::filesystem::absolute(generator).string();
    const test::Finished done = test::Process(made,
                                              {"forest", "--trees", std::to_string(kTrees), "--triangles",
                                               std::to_string(kTriangles), "--size", "192x144"},
                                              folder.path())
                                    .wait();
    ASSERT_EQ(done.code, 0) << done.err;
  }

  test::Finished render(std::vector<std::string> words) const {
    words.insert(words.begin(), "forest.xml");
    words.push_back("--quiet");
    return test::Process(test::program(), words, folder.path()).wait();
  }
};

size_t lines_of(const std::string& text) {
  return static_cast<size_t>(std::count(text.begin(), text.end(), '\n'));
}

TEST_F(Forest, AHundredMillionTrianglesWithinAGigabyte) {
  size_t triangles = 0;
  for (const char* kind : {"fir", "oak"}) {
    const std::string name = std::string("forest_") + kind;
    const std::string obj = test::read_text(folder / (name + ".obj"));
    size_t faces = 0;
    for (size_t at = obj.find("\nf "); at != std::string::npos; at = obj.find("\nf ", at + 1)) ++faces;
    const size_t places = lines_of(test::read_text(folder / (name + ".txt")));
    EXPECT_GT(places, static_cast<size_t>(kTrees) / 10);
    triangles += faces * places;
  }
  EXPECT_GT(triangles, static_cast<size_t>(kTrees) * (kTriangles - 20));

  const test::Finished done = render({"--effects", "none", "--stats", "-", "-o", "forest.png"});
  ASSERT_EQ(done.code, 0) << done.err;
  const test::Json stats = test::JsonReader::read(done.out);
  EXPECT_GT(stats["covered_pixels"].number, 192 * 144 * 0.5);
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
  EXPECT_LT(stats["peak_memory_bytes"].number, 1e9 / 4);
#endif
}

TEST_F(Forest, RasterizedAndTracedAlike) {
  const std::vector<std::string> plain{"--effects", "shadows", "--size", "96x72"};
  for (const char* how : {"raster", "trace"}) {
    std::vector<std::string> words = plain;
    for (const char* word : {"--primary", how, "-o"}) words.push_back(word);
    words.push_back(std::string(how) + ".png");
    const test::Finished done = render(words);
    ASSERT_EQ(done.code, 0) << done.err;
  }
  const Image<Rgb8> a = read_png(folder / "raster.png"), b = read_png(folder / "trace.png");
  // Leaves are so small that a pixel's centre is often within 1/256 pixel of an edge.
  EXPECT_LT(compare(a, b).pixels, a.pixels.size() / 10);
}

}  // namespace
}  // namespace vitral
