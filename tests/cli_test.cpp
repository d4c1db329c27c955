// The program as a user meets it: files that appear, exit codes, one clear line for what went wrong
// and nothing left behind.
#include "io/image_file.h"
#include "process.h"
#include "scratch.h"
#include "terminal.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <string>
#include <thread>
#include <vector>

namespace vitral {
namespace {

namespace fs = std::filesystem;
using test::Finished;
using Words = std::vector<std::string>;

constexpr const char* kTriangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

constexpr const char* kProject =
    "<project width='16' height='8'><assets>"
    "<scenes><scene name='s'><file name='a.obj'/></scene></scenes>"
    "<cameras><camera name='Near'><position>0 0 3</position></camera>"
    "<camera name='Far'><position>0 0 30</position></camera></cameras></assets>"
    "<pipelines><pipeline name='plain'><pass class='raster'/></pipeline>"
    "<pipeline name='dark'><pass class='raster'/><pass "
    "class='trace'><shadows/></pass></pipeline></pipelines></project>";

struct Cli : testing::Test {
  const std::string program = test::program();
  test::ScratchFolder folder;

  void SetUp() override {
    ASSERT_NE(program, "") << "set VITRAL to the program to be tested, as `make test` does";
    ASSERT_TRUE(fs::exists(program)) << program;
    folder.write("a.obj", kTriangle);
    folder.write("p.xml", kProject);
  }

  Finished run(const Words& words) const { return test::Process(program, words, folder.path()).wait(); }

  // A run that must fail with `code`, one line on standard error that holds `text`, and no new file.
  void expect_failure(const Words& words, int code, const std::string& text) const {
    std::string line = "vitral";
    for (const std::string& word : words) line += " " + word;
    SCOPED_TRACE(line);
    const size_t files = folder.files();
    const Finished done = run(words);
    EXPECT_EQ(done.code, code) << done.err;
    EXPECT_EQ(done.lines(), 1u) << done.err;
    EXPECT_EQ(done.err.substr(0, 8), "vitral: ");
    EXPECT_NE(done.err.find(text), std::string::npos) << done.err;
    EXPECT_EQ(done.out, "");
    EXPECT_EQ(folder.files(), files) << "a file was left behind";
  }
};

TEST_F(Cli, RendersIntoTheCurrentFolder) {
  const Finished done = run({"a.obj", "--size", "16x8"});
  EXPECT_EQ(done.code, 0);
  EXPECT_EQ(done.err, "") << "no noise when nobody watches";
  EXPECT_EQ(done.out, "");
  const Image<Rgb8> picture = read_png(folder / "a.png");
  EXPECT_EQ(picture.width, 16);
  EXPECT_EQ(picture.height, 8);
  EXPECT_EQ(folder.files(), 3u) << "a.obj, p.xml, a.png";
}

// The automatic camera looks at the mesh before anything is made of its textures.
TEST_F(Cli, ShowsATexturedMeshWithoutACamera) {
  ASSERT_EQ(run({"a.obj", "--size", "16x16", "-o", "texture.png"}).code, 0);
  folder.write("t.obj",
               "mtllib t.mtl\nusemtl t\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n");
  folder.write("t.mtl", "newmtl t\nKd 1 1 1\n");
  ASSERT_EQ(run({"t.obj", "--size", "32x32", "-o", "plain.png"}).code, 0);
  folder.write("t.mtl", "newmtl t\nKd 1 1 1\nmap_Kd texture.png\n");
  const Finished done = run({"t.obj", "--size", "32x32", "-o", "textured.png"});
  EXPECT_EQ(done.code, 0);
  EXPECT_EQ(done.err, "");
  EXPECT_EQ(run({"diff", "plain.png", "textured.png"}).code, 1);
  EXPECT_EQ(run({"bench", "t.obj", "--size", "16x16", "--repeat", "1", "--effects", "none"}).code, 0);
}

TEST_F(Cli, WritesWhereItIsTold) {
  EXPECT_EQ(run({"render", "p.xml", "-o", "b.png"}).code, 0);
  EXPECT_EQ(read_png(folder / "b.png").width, 16);

  const Finished piped = run({"p.xml", "-o", "-"});
  EXPECT_EQ(piped.code, 0);
  EXPECT_EQ(piped.out, test::read_text(folder / "b.png")) << "the same bytes on standard output";
}

TEST_F(Cli, OptionsOverrideTheProject) {
  EXPECT_EQ(run({"p.xml", "--size", "20x10", "-o", "s.png"}).code, 0);
  EXPECT_EQ(read_png(folder / "s.png").width, 20);
  EXPECT_EQ(run({"p.xml", "-o", "near.png"}).code, 0);
  EXPECT_EQ(run({"p.xml", "--camera", "Far", "-o", "far.png"}).code, 0);
  EXPECT_EQ(run({"p.xml", "--eye", "0,0,30", "-o", "eye.png"}).code, 0);
  EXPECT_NE(test::read_text(folder / "near.png"), test::read_text(folder / "far.png"));
  EXPECT_EQ(test::read_text(folder / "eye.png"), test::read_text(folder / "far.png"));
  EXPECT_EQ(run({"p.xml", "--pipeline", "dark"}).code, 0);
}

TEST_F(Cli, WritesAuxiliaryPicturesBesideTheOutput) {
  EXPECT_EQ(run({"p.xml", "--aov", "depth,normal", "-o", "b.png"}).code, 0);
  EXPECT_EQ(test::read_text(folder / "b.depth.pfm").substr(0, 2), "Pf");
  EXPECT_EQ(test::read_text(folder / "b.normal.pfm").substr(0, 2), "PF");
}

TEST_F(Cli, WritesStatisticsAsJson) {
  const Finished done = run({"p.xml", "--stats", "-"});
  EXPECT_EQ(done.code, 0);
  for (const char* key :
       {"\"triangles\": 1", "\"width\": 16", "\"peak_memory_bytes\"", "\"write\"", "\"passes\"",
        "\"rays_saved\": 0"}) {
    EXPECT_NE(done.out.find(key), std::string::npos) << key << " in " << done.out;
  }
  EXPECT_EQ(run({"p.xml", "--stats", "s.json"}).code, 0);
  EXPECT_EQ(test::read_text(folder / "s.json").front(), '{');
  expect_failure({"p.xml", "-o", "-", "--stats", "-"}, 2, "same place");
}

TEST_F(Cli, InfoAndBenchPrintWhatTheyFound) {
  Finished done = run({"info", "p.xml"});
  EXPECT_EQ(done.code, 0);
  EXPECT_NE(done.out.find("1 triangles"), std::string::npos) << done.out;
  EXPECT_NE(done.out.find("dark: camera Near, effects shadows"), std::string::npos) << done.out;
  done = run({"info", "a.obj", "--json"});
  EXPECT_NE(done.out.find("\"triangles\": 1"), std::string::npos) << done.out;
  done = run({"bench", "a.obj", "--size", "16x16", "--repeat", "2", "--json"});
  EXPECT_EQ(done.code, 0);
  for (const char* key : {"\"load\"", "\"build\"", "\"frame\"", "\"ms_median\"", "\"covered_pixels\""}) {
    EXPECT_NE(done.out.find(key), std::string::npos) << key << " in " << done.out;
  }
}

TEST_F(Cli, DiffComparesExactly) {
  Image<Rgb8> picture(8, 4, {10, 20, 30});
  write_png(folder / "a.png", picture);
  write_png(folder / "same.png", picture);
  picture.row(3)[5] = {10, 20, 31};
  write_png(folder / "b.png", picture);
  write_png(folder / "small.png", Image<Rgb8>(4, 4));

  EXPECT_EQ(run({"diff", "a.png", "same.png"}).code, 0);
  const Finished different = run({"diff", "a.png", "b.png", "-o", "d.png"});
  EXPECT_EQ(different.code, 1);
  EXPECT_EQ(different.out, "1 of 32 pixels differ, by at most 1 of 255, in 5,3,1x1\n");
  EXPECT_EQ(read_png(folder / "d.png").row(3)[5].b, 255);
  EXPECT_EQ(run({"diff", "a.png", "small.png"}).code, 1);
  EXPECT_EQ(run({"diff", "a.png", "small.png", "--quiet"}).out, "");

  expect_failure({"diff", "a.png", "nosuch.png"}, 2, "nosuch.png");
  expect_failure({"diff", "a.png", "a.obj"}, 2, "a.obj");
  expect_failure({"diff", "a.png"}, 2, "diff");
  expect_failure({"diff", "a.png", "b.png", "-o", "b.png"}, 2, "b.png is an input");
}

TEST_F(Cli, HelpAndVersionGoToStandardOutput) {
  Finished done = run({"--version"});
  EXPECT_EQ(done.code, 0);
  EXPECT_EQ(done.out, "vitral 0.1.0\n");
  for (const Words& words :
       {Words{"--help"}, Words{"help"}, Words{"bench", "--help"}, Words{"help", "diff"}}) {
    done = run(words);
    EXPECT_EQ(done.code, 0);
    EXPECT_NE(done.out.find("--quiet"), std::string::npos);
    EXPECT_EQ(done.err, "");
  }
}

TEST_F(Cli, HelpNamesTheLeastImportance) {
  EXPECT_NE(run({"help", "render"}).out.find("counts as 1/4096"), std::string::npos);
}

TEST_F(Cli, AnswersBadInputWithOneLine) {
  folder.write("empty.obj", "");
  folder.write("empty.ply", "");
  folder.write("empty.xml", "");
  folder.write("points.obj", "v 0 0 0\nv 1 0 0\n");
  folder.write("wrong.xml", "<project>\n<assets>\n</project>");
  folder.write("notes.txt", "hello");
  fs::create_directory(folder / "folder");
  fs::create_directory(folder / "folder.obj");
  write_png(folder / "picture.png", Image<Rgb8>(8, 8, {200, 100, 50}));
  fs::copy_file(folder / "picture.png", folder / "picture.obj");
  fs::copy_file(folder / "picture.png", folder / "picture.xml");

  expect_failure({"nosuch.obj"}, 1, "nosuch.obj: no such file");
  expect_failure({"nosuch.xml"}, 1, "nosuch.xml: no such file");
  expect_failure({"empty.obj"}, 1, "empty.obj");
  expect_failure({"empty.ply"}, 1, "empty.ply");
  expect_failure({"empty.xml"}, 1, "empty.xml");
  expect_failure({"points.obj"}, 1, "points.obj");
  expect_failure({"wrong.xml"}, 1, "wrong.xml:3: ");
  expect_failure({"folder"}, 1, "folder: is a directory");
  expect_failure({"folder.obj"}, 1, "folder.obj: is a directory");
  expect_failure({"notes.txt"}, 1, "notes.txt");
  expect_failure({"picture.png"}, 1, "picture.png");
  expect_failure({"picture.obj"}, 1, "picture.obj");
  expect_failure({"picture.xml"}, 1, "picture.xml");
  expect_failure({"bad\nname.obj"}, 1, "bad?name.obj");
}

TEST_F(Cli, GoesOnWithoutWhatAMaterialLacks) {
  folder.write("library.obj", std::string("mtllib nosuch.mtl\n") + kTriangle);
  folder.write("texture.mtl", "newmtl m\nmap_Kd nosuch.png\n");
  folder.write("texture.obj", std::string("mtllib texture.mtl\nusemtl m\n") + kTriangle);
  const std::pair<const char*, const char*> cases[] = {{"library", "nosuch.mtl"}, {"texture", "nosuch.png"}};
  for (const auto& [name, missing] : cases) {
    const Finished done = run({std::string(name) + ".obj", "--size", "8x8"});
    EXPECT_EQ(done.code, 0);
    EXPECT_EQ(done.lines(), 1u) << done.err;
    EXPECT_NE(done.err.find(missing), std::string::npos) << done.err;
    EXPECT_EQ(read_png(folder / (std::string(name) + ".png")).width, 8);
    EXPECT_EQ(run({std::string(name) + ".obj", "--size", "8x8", "--quiet"}).err, "");
  }
}

TEST_F(Cli, ShowsTinyMeshesOrSaysThatItCannot) {
  const auto tetrahedron = [](const std::string& size) {
    return "v 0 0 0\nv " + size + " 0 0\nv 0 " + size + " 0\nv 0 0 " + size +
           "\nf 1 2 3\nf 1 3 4\nf 1 4 2\nf 2 3 4\n";
  };
  for (const char* size : {"1e-25", "1e-30"}) {
    folder.write("tiny.obj", tetrahedron(size));
    const Finished done = run({"tiny.obj", "--size", "32x32", "--stats", "-"});
    EXPECT_EQ(done.code, 0) << size << ": " << done.err;
    EXPECT_EQ(done.out.find("\"covered_pixels\": 0,"), std::string::npos) << size;
  }
  folder.write("tinier.obj", tetrahedron("1e-31"));
  expect_failure({"tinier.obj"}, 1, "tinier.obj: the mesh is too small");
}

TEST_F(Cli, RefusesWrongUsage) {
  expect_failure({}, 2, "no input");
  expect_failure({"a.obj", "--size", "0x0"}, 2, "--size");
  expect_failure({"a.obj", "--size", "100000x100000"}, 2, "--size");
  expect_failure({"a.obj", "--bogus"}, 2, "unknown option --bogus");
  expect_failure({"a.obj", "--sizes", "8x8"}, 2, "did you mean --size?");
  expect_failure({"a.obj", "--fov", "180"}, 2, "--fov");
  expect_failure({"a.obj", "--camera", "x"}, 2, "--camera");
  expect_failure({"p.xml", "--camera", "x"}, 2, "it has Near, Far");
  expect_failure({"p.xml", "--pipeline", "x"}, 2, "it has plain, dark");
  expect_failure({"p.xml", "--view", "0,1,0"}, 2, "camera");
  expect_failure({"p.xml", "--near", "5", "--far", "4"}, 2, "near");
  expect_failure({"p.xml", "--crop", "10,0,8x8"}, 2, "--crop");
  expect_failure({"nosuch.obj", "--size", "0x0"}, 2, "--size");
}

TEST_F(Cli, RefusesTwoOutputsInOneFile) {
  expect_failure({"a.obj", "--stats", "a.png"}, 2, "same place");
  expect_failure({"a.obj", "-o", "b.png", "--stats", "./b.png"}, 2, "same place");
  expect_failure({"a.obj", "--aov", "depth", "--stats", "a.depth.pfm"}, 2, "same place");
  expect_failure({"a.obj", "--aov", "depth,normal", "--stats", folder / "a.normal.pfm"}, 2, "same place");
  expect_failure({"a.obj", "--aov", "depth", "-o", "b.png", "--stats", "x/../b.depth.pfm"}, 2, "same place");
  folder.write("b.png", "an older picture");
  fs::create_symlink("b.png", folder / "link.json");
  expect_failure({"a.obj", "-o", "b.png", "--stats", "link.json"}, 2, "same place");
}

TEST_F(Cli, ChecksTheOutputBeforeItLoads) {
  fs::create_directory(folder / "folder");
  // The input does not parse: the complaint is about the output because that comes first.
  folder.write("bad.obj", "f 1 2 3\n");
  expect_failure({"bad.obj", "-o", "nosuch/x.png"}, 1, "nosuch/x.png");
  expect_failure({"bad.obj", "-o", "folder"}, 1, "folder");
  expect_failure({"bad.obj", "-o", "a.obj/x.png"}, 1, "a.obj/x.png");
  expect_failure({"bad.obj", "--stats", "nosuch/s.json"}, 1, "nosuch/s.json");
  expect_failure({"a.obj", "-o", "a.obj"}, 2, "a.obj is an input");
  expect_failure({"a.obj", "-o", "./folder/../a.obj"}, 2, "is an input");
  expect_failure({"p.xml", "-o", "a.obj"}, 2, "a.obj is an input");
  expect_failure({"a.obj", "-o", "x.jpg"}, 2, "PNG");
  EXPECT_EQ(test::read_text(folder / "a.obj"), kTriangle);
}

TEST_F(Cli, NoticesAFullDisk) {
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "there is no /dev/full";
  expect_failure({"a.obj", "--size", "8x8", "-o", "/dev/full"}, 1, "/dev/full");
  // The picture comes last: there is none when the statistics failed.
  expect_failure({"a.obj", "--size", "8x8", "--stats", "/dev/full"}, 1, "/dev/full");
  const int full = open("/dev/full", O_WRONLY);
  ASSERT_GE(full, 0);
  for (const Words& words :
       {Words{"a.obj", "--size", "8x8", "-o", "-"}, Words{"info", "a.obj"}, Words{"--help"}}) {
    const Finished done = test::Process(program, words, folder.path(), full).wait();
    EXPECT_EQ(done.code, 1);
    EXPECT_EQ(done.lines(), 1u) << done.err;
  }
  close(full);
}

// A wavy sheet of 2 * side * side triangles.
std::string wavy_sheet(int side) {
  std::string text;
  for (int y = 0; y <= side; ++y) {
    for (int x = 0; x <= side; ++x) {
      text += "v " + std::to_string(x) + " " + std::to_string((x * 7 + y * 13) % 11) + " " +
              std::to_string(y) + "\n";
    }
  }
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x) {
      const int a = y * (side + 1) + x + 1, c = a + side + 1;
      text += "f " + std::to_string(a) + " " + std::to_string(c) + " " + std::to_string(c + 1) + " " +
              std::to_string(a + 1) + "\n";
    }
  }
  return text;
}

// Work of minutes, stopped by `interrupt` once its bar says that the frame is being made.
struct LongRun : Cli {
  test::Terminal terminal;

  int code_after(const std::function<void(const test::Process&)>& interrupt) {
    folder.write("sheet.obj", wavy_sheet(40));
    const size_t files = folder.files();
    test::Process process(program, {"sheet.obj", "--size", "4096x4096", "--ao-samples", "1024"},
                          folder.path(), -1, terminal.theirs);
    EXPECT_TRUE(terminal.wait_for("%")) << terminal.seen;
    interrupt(process);
    const int code = process.wait().code;
    EXPECT_EQ(folder.files(), files) << "a file was left behind";
    return code;
  }
};

TEST_F(LongRun, StopsWhenInterrupted) {
  std::chrono::steady_clock::time_point start;
  EXPECT_EQ(code_after([&](const test::Process& process) {
              start = std::chrono::steady_clock::now();
              process.interrupt();
            }),
            130);
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(20));
  EXPECT_TRUE(terminal.wait_for("vitral: interrupted")) << terminal.seen;
}

TEST_F(LongRun, StopsInOrderWhenInterruptedTwice) {
  EXPECT_EQ(code_after([](const test::Process& process) {
              process.interrupt();
              std::this_thread::sleep_for(std::chrono::microseconds(200));
              process.interrupt();
            }),
            130);
}

// Whether a file of a temporary name is in the folder.
bool has_temporary(const fs::path& folder) {
  std::error_code code;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, code)) {
    if (entry.path().extension() == ".tmp") return true;
  }
  return false;
}

TEST_F(Cli, FinishesTheFileItWritesWhenInterruptedTwice) {
  // A file is written for a moment when the folder is tried, and longer when there is a large picture.
  for (int round = 0; round < 6; ++round) {
    const Words words{"a.obj", "--size", round % 2 == 0 ? "16x16" : "1024x1024", "--aov", "normal,depth"};
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(30);
    test::Process process(program, words, folder.path());
    while (!has_temporary(folder.path()) && !fs::exists(folder / "a.png")) {
      ASSERT_LT(std::chrono::steady_clock::now(), end);
    }
    process.interrupt();
    std::this_thread::sleep_for(std::chrono::microseconds(200));
    process.interrupt();
    const Finished done = process.wait();
    EXPECT_FALSE(has_temporary(folder.path()));
    // It may have come to its end before it is interrupted; without a picture it has not.
    EXPECT_TRUE(done.code == 130 || (done.code == 0 && fs::exists(folder / "a.png")))
        << done.code << done.err;
    fs::remove(folder / "a.png");
  }
}

TEST_F(Cli, ShowsABarAndASummaryOnATerminal) {
  test::Terminal terminal;
  EXPECT_EQ(
      test::Process(program, {"a.obj", "--size", "64x64"}, folder.path(), -1, terminal.theirs).wait().code,
      0);
  EXPECT_TRUE(terminal.wait_for("a.png: 64x64, 1 triangles")) << terminal.seen;

  test::Terminal quiet;
  test::Process(program, {"a.obj", "--size", "64x64", "--quiet"}, folder.path(), -1, quiet.theirs).wait();
  pollfd stream{quiet.ours, POLLIN, 0};
  EXPECT_EQ(poll(&stream, 1, 0), 0) << "not a word";

  const Finished refused = test::Process(program, {"a.obj", "-o", "-"}, folder.path(), quiet.theirs).wait();
  EXPECT_EQ(refused.code, 2) << "no picture on a terminal";
}

}  // namespace
}  // namespace vitral
