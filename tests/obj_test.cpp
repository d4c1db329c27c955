#include "io/obj.h"

#include "io/mesh_file.h"
#include "scratch.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

namespace vitral {
namespace {

struct Loaded {
  Scene scene;
  Warnings warnings;
};

Loaded load_text(std::string_view text, int threads = 1) {
  const test::ScratchFolder folder;
  Loaded result;
  load_obj(folder.write("mesh.obj", text), result.scene, result.warnings, threads);
  return result;
}

std::string error_in(std::string_view text) {
  const std::string error = test::error_of<InputError>([&] { load_text(text); });
  const size_t at = error.find("mesh.obj");
  return at == std::string::npos ? error : error.substr(at);
}

double area(const Mesh& mesh, const Corners& t) {
  const Vec3d a = to_double(mesh.positions[t[0]]);
  return length(cross(to_double(mesh.positions[t[1]]) - a, to_double(mesh.positions[t[2]]) - a)) / 2;
}

double area(const Mesh& mesh) {
  double sum = 0;
  for (const Corners& t : mesh.triangles) sum += area(mesh, t);
  return sum;
}

constexpr std::string_view kSquare = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

TEST(Obj, ReadsEveryFormOfIndex) {
  const Loaded l = load_text(
      "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0.25 0.5\nvt 1 0\nvt 0 1\nvn 0 0 2\n"
      "f 1 2 3\nf 1/1 2/2 3/3\nf 1//1 2//1 3//1\nf 1/1/1 2/2/1 3/3/1\nf -3/-3/-1 -2/-2/-1 -1/-1/-1\nf 1/ 2/ "
      "3/\n");
  const Mesh& m = l.scene.mesh;
  ASSERT_EQ(m.triangles.size(), 6u);
  const Corners first{0, 1, 2}, none{kNoIndex, kNoIndex, kNoIndex};
  for (const Corners& t : m.triangles) EXPECT_EQ(t, first);
  EXPECT_EQ(m.triangle_texcoords[0], none);
  EXPECT_EQ(m.triangle_texcoords[1], first);
  EXPECT_EQ(m.triangle_texcoords[2], none);
  EXPECT_EQ(m.triangle_texcoords[4], first);
  EXPECT_EQ(m.triangle_normals[2], (Corners{0, 0, 0}));
  EXPECT_EQ(m.triangle_normals[3], (Corners{0, 0, 0}));
  EXPECT_EQ(m.triangle_normals[4], (Corners{0, 0, 0}));
  EXPECT_EQ(m.normals[0], (Vec3{0, 0, 1})) << "normals are brought to unit length";
  EXPECT_EQ(m.texcoords[0].x, 0.25f);
  EXPECT_TRUE(l.warnings.empty());
}

TEST(Obj, NegativeIndicesCountFromWhereTheyStand) {
  const Mesh m =
      load_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\nv 5 0 0\nv 6 0 0\nv 5 1 0\nf -3 -2 -1\n").scene.mesh;
  ASSERT_EQ(m.triangles.size(), 2u);
  EXPECT_EQ(m.triangles[0], (Corners{0, 1, 2}));
  EXPECT_EQ(m.triangles[1], (Corners{3, 4, 5}));
}

TEST(Obj, ReadsLinesAsTheyComeInTheWild) {
  const Loaded l = load_text(
      "\xef\xbb\xbf# comment\r\n\tv\t0 0 0 1.0\r\nv 1.0e0 +0 -0.0 0.5 0.5 0.5\r\n  v 0 1 \\\r\n 0\r\n"
      "g a b\r\no thing\r\ns 1\r\nf 1 \\\r\n 2 3 # corner\r\nf 1 2 3");
  EXPECT_EQ(l.scene.mesh.triangles.size(), 2u);
  EXPECT_EQ(l.scene.mesh.positions[2], (Vec3{0, 1, 0}));
  EXPECT_TRUE(l.warnings.empty()) << l.warnings.front();
  EXPECT_EQ(load_text("v 0 0 0\rv 1 0 0\rv 0 1 0\rf 1 2 3\r").scene.mesh.triangles.size(), 1u);
}

TEST(Obj, RoundsNumbersCorrectly) {
  // Among them the midpoint of two floats, a denormal, and more digits than an integer holds.
  const char* const numbers[] = {"0.1",
                                 "-2.47668",
                                 "16777217",
                                 "1e-40",
                                 "3.4028235e38",
                                 "1.17549435e-38",
                                 "0.333333333333333333333333",
                                 "123456789012345678901234567890",
                                 ".5",
                                 "5.",
                                 "1E+2",
                                 "0.00000000000000000000000000001",
                                 "1.00000005960464477539062500000000000000000000001"};
  for (const char* const number : numbers) {
    const std::string text = std::string("v ") + number + " 0 0\nv 0 1 0\nv 0 0 1\nv 1 1 1\nf 2 3 4\n";
    const Mesh m = load_text(text).scene.mesh;
    EXPECT_EQ(m.positions[0].x, std::strtof(number, nullptr)) << number;
  }
}

TEST(Obj, CutsConcavePolygonsCorrectly) {
  // An L, a star and a comb; fans from the first corner would reach outside.
  const struct {
    std::string_view corners;
    double area;
  } shapes[] = {
      {"1 0 2 0 2 2 0 2 0 1 1 1", 3},
      {"0 3 -1 1 -3 1 -1.5 -0.5 -2 -3 0 -1.5 2 -3 1.5 -0.5 3 1 1 1", 14.5},
      {"0 0 5 0 5 3 4 3 4 1 3 1 3 3 2 3 2 1 1 1 1 3 0 3", 11},
      {"0 0 1 0.25 2 0 1 2", 1.75},
  };
  for (const auto& shape : shapes) {
    for (const char* const plane : {"xyz", "zxy", "yzx"}) {
      std::string text, face = "f";
      std::istringstream corners{std::string(shape.corners)};
      float a, b;
      for (int i = 1; corners >> a >> b; ++i) {
        const auto value = [&](char axis) { return axis == 'x' ? a : axis == 'y' ? b : 7.0f; };
        text += "v";
        for (int k = 0; k < 3; ++k) text.append(" ").append(std::to_string(value(plane[k])));
        text += "\n";
        face.append(" ").append(std::to_string(i));
      }
      const Mesh m = load_text(text + face + "\n").scene.mesh;
      EXPECT_EQ(m.triangles.size(), m.positions.size() - 2);
      EXPECT_NEAR(area(m), shape.area, 1e-9) << "triangles that overlap or reach outside have more area";
      const int up = static_cast<int>(std::strchr(plane, 'z') - plane);
      for (const Corners& t : m.triangles) {
        const Vec3 n = cross(m.positions[t[1]] - m.positions[t[0]], m.positions[t[2]] - m.positions[t[0]]);
        EXPECT_GT(component(n, up), 0) << "all triangles face the way the polygon does";
      }
    }
  }
}

TEST(Obj, KeepsEveryCornerOfAPolygonWithStraightStretches) {
  // Corner 2 lies on the line from 1 to 3: it must stay a corner of some triangle, or the edge of a
  // neighbour that uses it would leave a crack.
  const Mesh m = load_text("v 0 0 0\nv 1 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 0\nf 1 2 3 4 5\n").scene.mesh;
  ASSERT_EQ(m.triangles.size(), 3u);
  EXPECT_NEAR(area(m), 4, 1e-12);
  bool used = false;
  for (const Corners& t : m.triangles) used |= t[0] == 1 || t[1] == 1 || t[2] == 1;
  EXPECT_TRUE(used);
}

TEST(Obj, CutsHugeAndSelfCrossingPolygonsInBoundedTime) {
  std::string text, face = "f";
  const int n = 50000;
  uint32_t random = 1;
  for (int i = 1; i <= n; ++i) {
    random = random * 1664525u + 1013904223u;
    text += "v " + std::to_string(random >> 20) + std::string(" ") + std::to_string((random >> 8) & 0xfff) +
            " 0\n";
    face.append(" ").append(std::to_string(i));
  }
  const Loaded l = load_text(text + face + "\n");
  EXPECT_EQ(l.scene.mesh.triangles.size() + l.scene.dropped_triangles, static_cast<size_t>(n - 2));
}

TEST(Obj, DropsWhatCannotBeSeenAndCountsIt) {
  const Loaded l = load_text(
      "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 2 0 0\nv nan 0 0\nv 1e19 0 0\nv 1e999 0 0\nv 0 0 0\n"
      "f 1 2 3\nf 1 2 4\nf 1 1 2\nf 1 2 5\nf 1 3 6\nf 1 3 7\nf 1 8 2\nf 2 3 4\n");
  EXPECT_EQ(l.scene.mesh.triangles.size(), 2u);
  EXPECT_EQ(l.scene.mesh.triangle_material.size(), 2u);
  EXPECT_EQ(l.scene.dropped_triangles, 6u);
  ASSERT_EQ(l.warnings.size(), 1u);
  EXPECT_NE(l.warnings[0].find("6 triangles left out"), std::string::npos) << l.warnings[0];
  const Box box = bounds(l.scene.mesh);
  EXPECT_EQ(box.max, (Vec3{2, 1, 0})) << "only positions that triangles use";
}

TEST(Obj, AnswersWrongFilesWithFileLineAndReason) {
  const std::string square(kSquare);
  EXPECT_EQ(error_in(square + "f 1 2 9\n"), "mesh.obj:5: vertex index 9 is out of range (4 in the file)");
  EXPECT_EQ(error_in(square + "# a \\\n continued comment\nf 1 2 0\n"),
            "mesh.obj:7: index 0: indices start at 1");
  EXPECT_EQ(error_in("v 0 0 0\nf -1 -2 -1\n"),
            "mesh.obj:2: a relative vertex index reaches back before the first");
  EXPECT_EQ(error_in(square + "vn 0 0 1\nf 1//1 2//2 3//1\n"),
            "mesh.obj:6: normal index 2 is out of range (1 in the file)");
  EXPECT_EQ(error_in(square + "f 1 2 99999999999999999999\n"),
            "mesh.obj:5: '99999999999999999999' is not an index");
  EXPECT_EQ(error_in("v 0 zero 0\n"), "mesh.obj:1: 'zero' is not a number");
  EXPECT_EQ(error_in("v 0 1\n"), "mesh.obj:1: a vertex needs three coordinates");
  EXPECT_EQ(error_in(square + "f 1 2 3x\n"), "mesh.obj:5: 'x' after a face's corner");
  EXPECT_EQ(error_in(square), "mesh.obj: there are no triangles in it");
  EXPECT_EQ(error_in(""), "mesh.obj: the file is empty");
  EXPECT_EQ(error_in("hello world\n"), "mesh.obj: not an OBJ file: no statement is known");
  EXPECT_EQ(error_in(std::string_view("\x89PNG\r\n\x1a\n\0\0\0\rIHDR", 16)),
            "mesh.obj:1: not an OBJ file: it holds binary data");
  EXPECT_EQ(error_in("v 0 0 0\nv 0 0 0\nv 1 0 0\nf 1 2 3\n"),
            "mesh.obj: no triangle is left: 1 degenerate or not finite");
}

TEST(Obj, AFailedLoadLeavesTheSceneAsItWas) {
  const test::ScratchFolder folder;
  Scene scene;
  Warnings warnings;
  load_mesh(folder.write("good.obj", std::string(kSquare) + "f 1 2 3 4\n"), scene, warnings);
  EXPECT_THROW(load_mesh(folder.write("bad.obj", std::string(kSquare) + "f 1 2 9\n"), scene, warnings),
               InputError);
  EXPECT_EQ(scene.mesh.triangles.size(), 2u);
  EXPECT_EQ(scene.mesh.positions.size(), 4u);
  EXPECT_EQ(scene.materials.size(), 1u);
}

TEST(Obj, SkipsOtherStatementsAndSaysSoOnce) {
  const Loaded l = load_text(std::string(kSquare) + "l 1 2\np 3\ncurv 0 1 1 2\nf 1 2\nf 1 2 3\n");
  EXPECT_EQ(l.scene.mesh.triangles.size(), 1u);
  ASSERT_EQ(l.warnings.size(), 2u);
  EXPECT_NE(l.warnings[0].find("mesh.obj:5: 'l' is skipped, as are 2 more"), std::string::npos)
      << l.warnings[0];
  EXPECT_NE(l.warnings[1].find("mesh.obj:8: 1 face"), std::string::npos) << l.warnings[1];
}

TEST(Obj, AssignsMaterialsByName) {
  const test::ScratchFolder folder;
  folder.write("a b.mtl", "newmtl red\nKd 1 0 0\nnewmtl two words\nKd 0 1 0\n");
  folder.write("c.mtl", "newmtl red\nKd 0 0 1\nnewmtl blue\nKd 0 0 1\n");
  Scene scene;
  Warnings warnings;
  load_mesh(folder.write("mesh.obj", "mtllib a b.mtl c.mtl\n" + std::string(kSquare) +
                                         "f 1 2 3\nusemtl red\nf 1 2 3\nusemtl two words \nf 1 2 3\n"
                                         "usemtl blue\nf 1 2 3\nusemtl unknown\nf 1 2 3\n"),
            scene, warnings);
  const auto material = [&](size_t t) { return scene.materials.at(scene.mesh.triangle_material.at(t)); };
  EXPECT_EQ(material(0).name, "default");
  EXPECT_EQ(material(1).name, "red");
  EXPECT_EQ(material(1).diffuse, (Vec3{1, 0, 0})) << "the first library that has it counts";
  EXPECT_EQ(material(2).name, "two words");
  EXPECT_EQ(material(3).name, "blue");
  EXPECT_EQ(material(4).name, "unknown");
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_NE(warnings[0].find("mesh.obj:13: no material library defines 'unknown'"), std::string::npos)
      << warnings[0];
}

TEST(Obj, WarnsOnceOfALibraryThatIsNotThere) {
  const Loaded l = load_text("mtllib missing.mtl\n" + std::string(kSquare) +
                             "usemtl a\nf 1 2 3\nusemtl b\nf 1 2 3\nmtllib missing.mtl\nusemtl c\nf 1 2 3\n");
  EXPECT_EQ(l.scene.materials.size(), 3u);
  ASSERT_EQ(l.warnings.size(), 1u);
  EXPECT_NE(l.warnings[0].find("mesh.obj:1: material library 'missing.mtl'"), std::string::npos)
      << l.warnings[0];
}

TEST(Obj, SecondMeshJoinsTheFirst) {
  const test::ScratchFolder folder;
  folder.write("m.mtl", "newmtl a\n");
  Scene scene;
  Warnings warnings;
  load_mesh(folder.write("one.obj", std::string(kSquare) + "f 1 2 3 4\n"), scene, warnings);
  load_mesh(folder.write(
                "two.obj",
                "mtllib m.mtl\nv 9 0 0\nv 9 1 0\nv 9 0 1\nvt 1 1\nvn 1 0 0\nusemtl a\nf 1/1/1 2/1/1 3/1/1\n"),
            scene, warnings);
  const Mesh& m = scene.mesh;
  ASSERT_EQ(m.triangles.size(), 3u);
  EXPECT_EQ(m.triangles[2], (Corners{4, 5, 6}));
  ASSERT_EQ(m.triangle_texcoords.size(), 3u);
  EXPECT_EQ(m.triangle_texcoords[0][0], kNoIndex);
  EXPECT_EQ(m.triangle_texcoords[2][0], 0u);
  ASSERT_EQ(m.triangle_normals.size(), 3u);
  EXPECT_EQ(m.normals.at(m.triangle_normals[2][0]), (Vec3{1, 0, 0}));
  EXPECT_EQ(scene.materials[m.triangle_material[2]].name, "a");
  EXPECT_EQ(scene.materials[m.triangle_material[0]].name, "default");
}

TEST(Obj, RefusesWhatIsNoMesh) {
  const test::ScratchFolder folder;
  Scene scene;
  Warnings warnings;
  const auto error = [&](const std::string& path) {
    return test::error_of<InputError>([&] { load_mesh(path, scene, warnings); });
  };
  std::filesystem::create_directory((folder / "folder.obj"));
  EXPECT_EQ(error((folder / "none.obj")), (folder / "none.obj") + ": No such file or directory");
  EXPECT_EQ(error((folder / "folder.obj")), (folder / "folder.obj") + ": Is a directory");
  EXPECT_EQ(error("/dev/null.stl"), "/dev/null.stl: not a mesh: the name must end in .obj or .ply");
}

// A file of many chunks: relative indices, materials, smoothing groups and polygons must come out as
// if it were read in one piece.
TEST(Obj, DoesNotDependOnTheNumberOfThreads) {
  std::string text;
  for (int i = 0; i < 12000; ++i) {
    const std::string x = std::to_string(i % 100), y = std::to_string(i / 100),
                      z = std::to_string((i * 7) % 13 * 0.01);
    text += "v " + x + " " + y + " " + z + "\nv " + x + ".9 " + y + " 0\nv " + x + ".9 " + y + ".9 0\nv " +
            x + " " + y + ".9 0\n";
    if (i % 7 == 0) text += "usemtl m" + std::to_string(i % 5) + "\n";
    if (i % 11 == 0) text += "s " + std::to_string(i % 3) + "\n";
    text += i % 2 == 0 ? "f -4 -3 -2 -1\n" : "f -4 -3 \\\n -2\nf -1 -1 -2 # degenerate\n";
  }
  ASSERT_GT(text.size(), size_t{3} << 18);
  const Loaded one = load_text(text, 1);
  EXPECT_EQ(one.scene.mesh.triangles.size(), 18000u);
  EXPECT_EQ(one.scene.dropped_triangles, 6000u);
  for (const size_t t : {size_t{0}, size_t{8999}, size_t{17999}})
    EXPECT_LT(area(one.scene.mesh, one.scene.mesh.triangles[t]), 0.5);
  for (const int threads : {2, 3, 8}) {
    const Loaded many = load_text(text, threads);
    EXPECT_EQ(many.scene.mesh.triangles, one.scene.mesh.triangles);
    EXPECT_EQ(many.scene.mesh.triangle_normals, one.scene.mesh.triangle_normals);
    EXPECT_EQ(many.scene.mesh.triangle_material, one.scene.mesh.triangle_material);
    ASSERT_EQ(many.scene.mesh.normals.size(), one.scene.mesh.normals.size());
    EXPECT_EQ(std::memcmp(many.scene.mesh.normals.data(), one.scene.mesh.normals.data(),
                          one.scene.mesh.normals.size() * sizeof(Vec3)),
              0);
  }
  // The error named is the first of the file, whichever thread meets its own first.
  std::string broken = text + "v 0 bad 0\n";
  broken.insert(broken.find("\nv ", 700000) + 1, "v 0 worse 0\n");
  for (const int threads : {1, 4}) {
    EXPECT_NE(test::error_of<InputError>([&] { load_text(broken, threads); }).find("'worse'"),
              std::string::npos);
  }
}

// Lines that are longer than a chunk, among them one polygon of 16000 corners.
TEST(Obj, ReadsLinesOfAnyLength) {
  const int n = 16000;
  std::string text = "#" + std::string(700000, 'x') + "\n", face = "f";
  for (int i = 0; i < n; ++i) {
    const int side = i / (n / 4), along = i % (n / 4);
    const int x = side == 0 ? along : side == 1 ? n / 4 : side == 2 ? n / 4 - along : 0;
    const int y = side == 0 ? 0 : side == 1 ? along : side == 2 ? n / 4 : n / 4 - along;
    text.append("v ").append(std::to_string(x)).append(" ").append(std::to_string(y)).append(" 0\n");
    face.append(40, ' ').append(std::to_string(i + 1));
  }
  for (const int threads : {1, 4}) {
    const Mesh m = load_text(text + face + "\n", threads).scene.mesh;
    EXPECT_EQ(m.triangles.size(), static_cast<size_t>(n) - 2) << "corners on a straight line are kept";
    EXPECT_NEAR(area(m), 4000.0 * 4000.0, 1e-3);
  }
}

TEST(Obj, AHugeFileOfNothingIsRefusedAtOnce) {
  const test::ScratchFolder folder;
  Scene scene;
  Warnings warnings;
  for (const char* const name : {"a.obj", "a.ply"}) {
    const std::string path = folder.write(name, "");
    std::error_code error;
    std::filesystem::resize_file(path, uint64_t{1} << 40, error);  // a hole: it takes no room on the disk
    if (error) GTEST_SKIP() << error.message();
    EXPECT_NE(test::error_of<InputError>([&] { load_mesh(path, scene, warnings); }).find("not a"),
              std::string::npos);
  }
}

}  // namespace
}  // namespace vitral
