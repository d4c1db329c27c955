// `vitral bench`: what it prints can be read by a program, and its counts are those of the picture. Nothing
// here looks at how long something took.
#include "io/project.h"
#include "json_text.h"
#include "process.h"
#include "scratch.h"
#include "terminal.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

namespace vitral {
namespace {

namespace fs = std::filesystem;
using test::Finished;
using test::Json;
using Words = std::vector<std::string>;

// A floor that fills the view from above, and nothing else.
constexpr const char* kFloor = "v -200 0 -200\nv -200 0 200\nv 200 0 200\nv 200 0 -200\nf 1 2 3 4\n";
const Words kFromAbove{"--eye",  "0,10,0", "--view", "0,-1,0", "--up",  "0,0,-1", "--fov",  "40",
                       "--near", "0.1",    "--far",  "100",    "--sun", "0,-1,0", "--size", "40x24"};
constexpr double kPixels = 40 * 24;

// The floor before a wall so large that every mirrored ray of the view below arrives at it.
constexpr const char* kCorner =
    "v -200 0 -200\nv -200 0 200\nv 200 0 200\nv 200 0 -200\nf 1 2 3 4\n"
    "v -3000 0 -200\nv 3000 0 -200\nv 3000 3000 -200\nv -3000 3000 -200\nf 5 6 7 8\n";
const Words kAtTheFloor{"--eye", "0,10,0",        "--view", "0,-1,-1", "--fov", "20",    "--size",
                        "40x24", "--ao-distance", "1",      "--near",  "0.1",   "--far", "1000"};

// A patch of floor with a plate over it, and sky around both.
constexpr const char* kPlate =
    "v -2 0 -2\nv -2 0 2\nv 2 0 2\nv 2 0 -2\nf 1 2 3 4\n"
    "v -1 0.7 -1\nv -1 0.9 1\nv 0.5 0.9 1\nv 0.5 0.7 -1\nf 5 6 7 8\n";
const Words kAtThePlate{"--eye",       "1,4,6",         "--view", "-0.1,-0.6,-1", "--fov", "50",    "--sun",
                        "0.4,-1,-0.2", "--ao-distance", "2",      "--near",       "0.1",   "--far", "100",
                        "--size",      "72x56"};

constexpr const char* kProject =
    "<project width='16' height='8'><assets>"
    "<scenes><scene name='s'><file name='floor.obj'/></scene></scenes>"
    "<cameras><camera name='Near'><position>0 10 0</position><view>0 -1 0.1</view></camera>"
    "<camera name='Far'><position>0 20 0</position><view>0 -1 0.1</view></camera></cameras>"
    "<lights><light name='sun'><direction>0 -1 0</direction></light></lights></assets>"
    "<pipelines><pipeline name='p' defaultCamera='Far'><pass class='raster'/>"
    "<pass class='trace'><shadows/><ambientOcclusion samples='4' distance='0.5' exponent='1.6'/></pass>"
    "</pipeline></pipelines></project>";

// What the raster pass says besides.
const Words kRasterKeys{"transform_ms",  "setup_ms",      "bin_ms",          "fill_ms",
                        "attributes_ms", "mpixels_per_s", "mtriangles_per_s"};

Words joined(Words words, const Words& more) {
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

Words names_of(const Json& passes) {
  Words names;
  for (const Json& pass : passes.items) names.push_back(pass["name"].text);
  return names;
}

// The pixels of a PFM, from the bottom up.
std::vector<float> read_pfm(const std::string& path) {
  const std::string text = test::read_text(path);
  std::istringstream head(text);
  std::string magic, scale;
  size_t width = 0, height = 0;
  head >> magic >> width >> height >> scale;
  std::vector<float> pixels(width * height);
  const size_t bytes = pixels.size() * sizeof(float);
  EXPECT_EQ(magic, "Pf") << path;
  EXPECT_GT(text.size(), bytes) << path;
  if (text.size() > bytes) std::memcpy(pixels.data(), text.data() + text.size() - bytes, bytes);
  return pixels;
}

struct Bench : testing::Test {
  const std::string program = test::program();
  test::ScratchFolder folder;

  void SetUp() override {
    ASSERT_NE(program, "") << "set VITRAL to the program to be tested, as `make test` does";
    folder.write("floor.obj", kFloor);
    folder.write("corner.obj", kCorner);
    folder.write("plate.obj", kPlate);
    folder.write("p.xml", kProject);
  }

  Finished run(const Words& words) const { return test::Process(program, words, folder.path()).wait(); }

  Json json(const std::string& input, const Words& view, const Words& more = {}) const {
    const Words words =
        joined(joined({"bench", input, "--json", "--repeat", "1", "--threads", "2"}, view), more);
    const Finished done = run(words);
    EXPECT_EQ(done.code, 0) << done.err;
    EXPECT_EQ(done.err, "") << "no noise when nobody watches";
    return test::JsonReader::read(done.out);
  }

  // The rays of a pass; -1 when there is no such pass.
  static double rays(const Json& report, const std::string& name) {
    for (const Json& pass : report["passes"].items) {
      if (pass["name"].text == name) return pass["rays"].number;
    }
    return -1;
  }
};

TEST_F(Bench, PrintsTheDocumentedJson) {
  const Json report = json("floor.obj", kFromAbove, {"--isa", "scalar", "--repeat", "3"});
  EXPECT_EQ(report.keys,
            (Words{"input", "triangles", "width", "height", "threads", "isa", "passes", "checks"}));
  EXPECT_EQ(report["input"].text, "floor.obj");
  EXPECT_EQ(report["triangles"].number, 2);
  EXPECT_EQ(report["width"].number, 40);
  EXPECT_EQ(report["height"].number, 24);
  EXPECT_EQ(report["threads"].number, 2);
  EXPECT_EQ(report["isa"].text, "scalar");
  EXPECT_EQ(report["checks"].keys,
            (Words{"covered_pixels", "shadowed_pixels", "reflection_hits", "ao_mean"}));
  ASSERT_FALSE(report["passes"].items.empty());
  for (const Json& pass : report["passes"].items) {
    Words keys{"name", "ms_median", "ms_min", "rays", "mrays_per_s"};
    if (pass["name"].text == "build") keys.push_back("bytes");
    if (pass["name"].text == "raster") keys = joined(keys, kRasterKeys);
    EXPECT_EQ(pass.keys, keys);
    EXPECT_LE(pass["ms_min"].number, pass["ms_median"].number);
    EXPECT_GE(pass["ms_min"].number, 0);
    const double expected = pass["rays"].number / pass["ms_median"].number * 1e-3;
    EXPECT_NEAR(pass["mrays_per_s"].number, expected, 1e-9 * expected) << pass["name"].text;
  }
  EXPECT_GT(report["passes"].items[1]["bytes"].number, 0);
}

// The parts of one run are parts of it.
TEST_F(Bench, TakesTheRasterPassApart) {
  for (const char* layout : {"full", "min"}) {
    const Json report = json("plate.obj", kAtThePlate, {"--effects", "none", "--layout", layout});
    EXPECT_EQ(names_of(report["passes"]), (Words{"load", "build", "raster", "resolve", "frame"}));
    const Json& raster = report["passes"].items[2];
    double sum = 0;
    for (size_t i = 0; i < 5; ++i) {
      EXPECT_GE(raster[kRasterKeys[i]].number, 0) << kRasterKeys[i];
      sum += raster[kRasterKeys[i]].number;
    }
    const double ms = raster["ms_median"].number;
    EXPECT_GT(sum, 0);
    EXPECT_LE(sum, ms * 1.000001);
    EXPECT_NEAR(raster["mpixels_per_s"].number * ms, 72 * 56 * 1e-3, 1e-6);
    EXPECT_NEAR(raster["mtriangles_per_s"].number * ms, 4 * 1e-3, 1e-9);
    EXPECT_GT(report["checks"]["covered_pixels"].number, 500);
    EXPECT_LT(report["checks"]["covered_pixels"].number, 72 * 56);
  }
}

TEST_F(Bench, LayoutsAreTheRasterizers) {
  const Finished traced = run({"bench", "floor.obj", "--layout", "min", "--primary", "trace"});
  EXPECT_EQ(traced.code, 2);
  EXPECT_NE(traced.err.find("--layout"), std::string::npos) << traced.err;
  EXPECT_EQ(run({"bench", "floor.obj", "--layout", "min", "--report"}).code, 2);
  EXPECT_EQ(run({"bench", "floor.obj", "--layout", "medium"}).code, 2);
}

TEST_F(Bench, HasThePassesThatAreOn) {
  const std::pair<Words, Words> cases[] = {
      {{"--effects", "all"}, {"raster", "shadows", "reflection", "refraction", "ao"}},
      {{"--effects", "none"}, {"raster"}},
      {{"--effects", "ao"}, {"raster", "ao"}},
      {{"--effects", "refraction,shadows"}, {"raster", "shadows", "refraction"}},
      {{"--effects", "reflection", "--primary", "trace"}, {"primary", "reflection"}},
      {{"--effects", "all", "--anchor"}, {"raster", "shadows", "reflection", "ao"}},
      {{"--effects", "shadows,reflection,ao", "--anchor", "--primary", "trace"},
       {"primary", "shadows", "reflection", "ao"}},
  };
  for (const auto& [options, between] : cases) {
    const Words expected = joined(joined({"load", "build"}, between), {"resolve", "frame"});
    EXPECT_EQ(names_of(json("floor.obj", kFromAbove, options)["passes"]), expected) << options[1];
  }
}

TEST_F(Bench, CountsTheRaysOfAFloor) {
  const Json raster = json("floor.obj", kFromAbove, {"--ao-samples", "9"});
  EXPECT_EQ(rays(raster, "raster"), 0);
  EXPECT_EQ(rays(raster, "shadows"), kPixels);
  EXPECT_EQ(rays(raster, "reflection"), 0);
  EXPECT_EQ(rays(raster, "refraction"), 0);
  EXPECT_EQ(rays(raster, "ao"), 9 * kPixels);
  EXPECT_EQ(rays(raster, "frame"), 10 * kPixels);
  EXPECT_EQ(raster["checks"]["covered_pixels"].number, kPixels);
  EXPECT_EQ(raster["checks"]["shadowed_pixels"].number, 0);
  EXPECT_EQ(raster["checks"]["ao_mean"].number, 1);

  const Json traced = json("floor.obj", kFromAbove, {"--ao-samples", "9", "--primary", "trace"});
  EXPECT_EQ(rays(traced, "primary"), kPixels);
  EXPECT_EQ(rays(traced, "frame"), 11 * kPixels);

  const Json dark = json("floor.obj", kFromAbove, {"--sun", "0,1,0"});
  EXPECT_EQ(rays(dark, "shadows"), 0) << "a floor that faces away asks for no light";

  const Json crop = json("floor.obj", kFromAbove, {"--ao-samples", "4", "--crop", "30,3,7x20"});
  EXPECT_EQ(crop["checks"]["covered_pixels"].number, 7 * 20);
  EXPECT_EQ(rays(crop, "shadows"), 7 * 20);
  EXPECT_EQ(rays(crop, "ao"), 4 * 7 * 20);
  EXPECT_EQ(rays(crop, "frame"), 5 * 7 * 20);
}

TEST_F(Bench, MirrorsEverythingWhenAsked) {
  EXPECT_EQ(rays(json("floor.obj", kFromAbove), "reflection"), 0);
  const Json mirror = json("floor.obj", kFromAbove, {"--mirror-all", "--effects", "reflection"});
  EXPECT_EQ(rays(mirror, "reflection"), kPixels);
  EXPECT_EQ(rays(mirror, "frame"), kPixels);
  EXPECT_EQ(mirror["checks"]["reflection_hits"].number, 0) << "there is but sky above the floor";
  EXPECT_EQ(json("corner.obj", kAtTheFloor, {"--mirror-all", "--max-depth", "1"})["checks"]["reflection_hits"]
                .number,
            kPixels);
}

// Every mirrored ray arrives at the wall: it asks for light there when the wall faces the sun, and then the
// wall does not stand between the floor and the sun; else it does.
TEST_F(Bench, CountsTheRaysOfAnotherTracer) {
  for (const auto& [sun, facing] : {std::pair{"0,-1,-1", true}, std::pair{"0,-1,1", false}}) {
    SCOPED_TRACE(sun);
    const Json report = json("corner.obj", kAtTheFloor,
                             {"--anchor", "--primary", "trace", "--ao-samples", "4", "--sun", sun});
    const double reflection = facing ? 2 * kPixels : kPixels;
    EXPECT_EQ(rays(report, "primary"), kPixels);
    EXPECT_EQ(rays(report, "shadows"), kPixels);
    EXPECT_EQ(rays(report, "reflection"), reflection);
    EXPECT_EQ(rays(report, "ao"), 4 * kPixels);
    EXPECT_EQ(rays(report, "frame"), 6 * kPixels + reflection) << "the frame has the rays of the passes";
    EXPECT_EQ(report["checks"]["covered_pixels"].number, kPixels);
    EXPECT_EQ(report["checks"]["shadowed_pixels"].number, facing ? 0 : kPixels);
    EXPECT_EQ(report["checks"]["reflection_hits"].number, kPixels);
    EXPECT_EQ(report["checks"]["ao_mean"].number, 1) << "the wall is out of reach";
  }
}

TEST_F(Bench, ItsChecksAreThoseOfThePicture) {
  const Words effects{"--effects", "shadows,ao", "--ao-exponent", "1"};
  for (const Words& part : {Words{}, Words{"--crop", "13,9,50x41"}, Words{"--primary", "trace"}}) {
    const Words options = joined(joined(kAtThePlate, effects), part);
    const Json checks = json("plate.obj", options)["checks"];
    const Finished done = run(joined({"plate.obj", "-o", "v.png", "--aov", "depth,shadow,ao"}, options));
    ASSERT_EQ(done.code, 0) << done.err;
    const std::vector<float> depth = read_pfm(folder / "v.depth.pfm"),
                             shadow = read_pfm(folder / "v.shadow.pfm"), ao = read_pfm(folder / "v.ao.pfm");
    double covered = 0, shadowed = 0, free = 0;
    for (size_t i = 0; i < depth.size(); ++i) {
      if (!(depth[i] > 0)) continue;
      ++covered;
      shadowed += shadow[i] == 0;
      free += static_cast<double>(ao[i]);
    }
    EXPECT_GT(shadowed, 20) << "the plate throws a shadow";
    EXPECT_LT(shadowed, covered / 2);
    EXPECT_LT(covered, static_cast<double>(depth.size())) << "there is sky";
    EXPECT_EQ(checks["covered_pixels"].number, covered);
    EXPECT_EQ(checks["shadowed_pixels"].number, shadowed);
    EXPECT_LT(free, 0.99 * covered);
    EXPECT_NEAR(checks["ao_mean"].number, free / covered, 1e-6);
  }
}

TEST_F(Bench, PrintsATable) {
  const Finished done = run(joined({"bench", "floor.obj", "--repeat", "2"}, kFromAbove));
  EXPECT_EQ(done.code, 0);
  for (const char* text :
       {"floor.obj: 2 triangles, 40x24, ", "2 runs\n", "\nload ", "\nbuild ", "\nraster ", "\nshadows ",
        "\nao ", "\nresolve ", "\nframe ", "covered pixels 960, shadowed 0,"}) {
    EXPECT_NE(done.out.find(text), std::string::npos) << text << " in " << done.out;
  }
}

// Lines by their first words; the numbers of a line, without its name.
std::vector<double> numbers_after(const std::string& text, const std::string& name) {
  const size_t at = text.find("\n" + name + "  ");
  if (at == std::string::npos) return {};
  std::istringstream line(text.substr(at + 1 + name.size(), text.find('\n', at + 1) - at - 1 - name.size()));
  std::vector<double> numbers;
  for (std::string word; line >> word;) {
    double value = 0;
    if (std::from_chars(word.data(), word.data() + word.size(), value).ec == std::errc{})
      numbers.push_back(value);
  }
  return numbers;
}

TEST_F(Bench, ReportHasARowForEveryEffectAndNumberOfSamples) {
  const Finished done = run({"bench", "p.xml", "--report", "--repeat", "1"});
  ASSERT_EQ(done.code, 0) << done.err;
  EXPECT_EQ(done.err, "");
  EXPECT_LT(done.out.find(" Far "), done.out.find(" Near ")) << "the pipeline's own camera comes first";
  EXPECT_NE(done.out.find(" Near "), std::string::npos);
  // For each of two cameras a time and a share, then the report's figure or figures.
  const std::pair<const char*, std::vector<double>> effects[] = {{"no effects", {0.87}},
                                                                 {"pass-through", {5.33}},
                                                                 {"shadows", {11.77}},
                                                                 {"reflection", {7.16, 15.61}},
                                                                 {"refraction", {9.4, 23.42}},
                                                                 {"all but AO", {17.93}},
                                                                 {"all", {759.74}}};
  for (const auto& [name, reported] : effects) {
    const std::vector<double> row = numbers_after(done.out, name);
    ASSERT_EQ(row.size(), 4 + reported.size()) << name << " in " << done.out;
    EXPECT_TRUE(std::equal(reported.begin(), reported.end(), row.begin() + 4)) << name;
    for (const size_t share : {1u, 3u}) EXPECT_TRUE(row[share] >= 0 && row[share] <= 100) << name;
  }
  EXPECT_EQ(numbers_after(done.out, "no effects")[1], 0) << "nothing is traced";
  for (const int samples : {1, 4, 9, 16, 25, 36, 49, 64, 81, 100}) {
    const std::vector<double> row = numbers_after(done.out, std::to_string(samples));
    ASSERT_EQ(row.size(), 4u) << samples << " in " << done.out;
    EXPECT_EQ(row[1], 16 * 8 * samples) << "rays";
  }
}

TEST_F(Bench, ReportLooksFromWhereItIsTold) {
  const Finished one = run({"bench", "p.xml", "--report", "--repeat", "1", "--camera", "Near"});
  EXPECT_EQ(one.code, 0);
  EXPECT_EQ(one.out.find(" Far "), std::string::npos);
  EXPECT_EQ(numbers_after(one.out, "all").size(), 3u);
  const Finished mesh = run(joined({"bench", "floor.obj", "--report", "--repeat", "1"}, kFromAbove));
  EXPECT_EQ(mesh.code, 0);
  EXPECT_EQ(numbers_after(mesh.out, "all").size(), 3u);
}

// What the report's projects have in common is why one of them, with its effects switched, stands for all.
TEST_F(Bench, TheReportsProjectsDifferInTheirEffectsAlone) {
  folder.write("out/plaza/plaza.obj", "");  // must be there, and is not read
  const auto read = [&](const std::string& name) {
    const std::string file = "scenes/Scene" + name + ".xml";
    Warnings warnings;
    return read_project(folder.write(file, test::read_text(file)), warnings);
  };
  const Project all = read("Final");
  ASSERT_EQ(all.pipelines.size(), 1u);
  const Pipeline& final = all.pipelines[0];
  EXPECT_EQ(final.settings.ao_samples, 100);
  EXPECT_EQ(final.settings.ao_distance, 0.5f);
  EXPECT_EQ(final.settings.ao_exponent, 1.6f);
  ASSERT_EQ(final.maps.size(), 1u);
  EXPECT_EQ(final.maps[0].index, 1.1f);
  for (const char* name : {"NoEffects", "Dummy", "Shadows", "Reflect", "Refract", "SSAO"}) {
    SCOPED_TRACE(name);
    const Project project = read(name);
    ASSERT_EQ(project.pipelines.size(), 1u);
    const Pipeline& pipeline = project.pipelines[0];
    const Settings &s = pipeline.settings, &f = final.settings;
    EXPECT_EQ(pipeline.camera, "Fonte");
    EXPECT_EQ(pipeline.maps.size(), 1u);
    EXPECT_EQ(pipeline.maps[0].index, 1.1f);
    EXPECT_TRUE(s.width == 1024 && s.height == 1024 && s.max_depth == 5);
    EXPECT_TRUE(s.min_importance == f.min_importance && s.fresnel == f.fresnel &&
                s.compositing == f.compositing && s.seed == f.seed);
    if (s.effects.ambient_occlusion) {
      EXPECT_TRUE(s.ao_samples == f.ao_samples && s.ao_distance == f.ao_distance &&
                  s.ao_exponent == f.ao_exponent);
    }
    ASSERT_EQ(project.scene.cameras.size(), 2u);
    for (size_t i = 0; i < 2; ++i) {
      EXPECT_EQ(project.scene.cameras[i].name, all.scene.cameras[i].name);
      EXPECT_TRUE(project.scene.cameras[i].position == all.scene.cameras[i].position);
      EXPECT_TRUE(project.scene.cameras[i].view == all.scene.cameras[i].view);
    }
  }
}

TEST_F(Bench, RefusesWrongUsage) {
  for (const Words& words :
       {Words{"bench"}, Words{"bench", "floor.obj", "--repeat", "0"},
        Words{"bench", "floor.obj", "-o", "x.png"}, Words{"bench", "p.xml", "--camera", "x"},
        Words{"bench", "p.xml", "--report", "--json"}, Words{"bench", "p.xml", "--report", "--anchor"},
        Words{"bench", "p.xml", "--report", "--effects", "ao"}, Words{"p.xml", "--report"},
        Words{"bench", "floor.obj", "--anchor=1"}}) {
    const Finished done = run(words);
    EXPECT_EQ(done.code, 2) << words.back();
    EXPECT_EQ(done.lines(), 1u) << done.err;
    EXPECT_EQ(done.out, "");
  }
  EXPECT_EQ(run({"bench", "nosuch.obj"}).code, 1);
}

TEST_F(Bench, RefusesAPictureThatDoesNotFitIntoMemory) {
  // In two gigabytes the picture would fit, but not all that its pixels see.
  const auto limited = [&](const std::string& words) {
    const Words shell{"-c", "ulimit -v 2097152 && exec \"$0\" " + words, program};
    return test::Process("/bin/sh", shell, folder.path()).wait();
  };
  if (limited("--version").code != 0) GTEST_SKIP() << "a sanitizer takes more for itself";
  const Finished done = limited("bench floor.obj --size 10000x10000");
  EXPECT_EQ(done.code, 2) << done.err;
  EXPECT_NE(done.err.find("10000x10000 pixels needs "), std::string::npos) << done.err;
}

// Bench with a pseudo-terminal for its standard error.
TEST_F(Bench, ShowsABarOnATerminalUnlessQuiet) {
  const Words words = joined({"bench", "floor.obj", "--repeat", "1"}, kFromAbove);
  test::Terminal open;
  EXPECT_EQ(test::Process(program, words, folder.path(), -1, open.theirs).wait().code, 0);
  for (const char* pass : {"build", "raster", "shadows", "ao", "frame"})
    EXPECT_TRUE(open.wait_for(std::string("\r") + pass)) << open.seen;
  EXPECT_TRUE(open.wait_for("\r\x1b[K")) << "the bar is erased";

  test::Terminal quiet;
  EXPECT_EQ(test::Process(program, joined(words, {"--quiet"}), folder.path(), -1, quiet.theirs).wait().code,
            0);
  while (quiet.read_some(50)) continue;
  EXPECT_EQ(quiet.seen, "");
}

// Within a pass, and within a frame. Rays that reach far past a plate are work that no shortcut does away
// with.
TEST_F(Bench, StopsWhenInterrupted) {
  const Words work = joined(
      kAtThePlate, {"--size", "512x512", "--ao-samples", "1024", "--ao-distance", "50", "--isa", "scalar"});
  for (const auto& [shown, option] :
       {std::pair{"\rao ", "--effects=ao"}, std::pair{"\rauto, all  ", "--report"}}) {
    test::Terminal terminal;
    const Words words = joined({"bench", "plate.obj", option}, work);
    test::Process process(program, words, folder.path(), -1, terminal.theirs);
    ASSERT_TRUE(terminal.wait_for(shown)) << terminal.seen;
    process.interrupt();
    const auto start = std::chrono::steady_clock::now();
    const Finished done = process.wait();
    EXPECT_EQ(done.code, 130);
    EXPECT_EQ(done.out, "");
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(20));
    EXPECT_TRUE(terminal.wait_for("vitral: interrupted")) << terminal.seen;
  }
}

}  // namespace
}  // namespace vitral
