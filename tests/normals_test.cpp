#include "io/normals.h"

#include "io/obj.h"
#include "scratch.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

namespace vitral {
namespace {

Mesh load(const std::string& text) {
  const test::ScratchFolder folder;
  Scene scene;
  Warnings warnings;
  load_obj(folder.write("mesh.obj", text), scene, warnings, 1);
  return scene.mesh;
}

constexpr const char* kCube =
    "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n"
    "f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";

// A band of `n` quadrilaterals around the unit circle.
std::string cylinder(int n) {
  std::string text;
  for (int i = 0; i < n; ++i) {
    const double angle = 2 * 3.141592653589793 * i / n;
    for (const char* const z : {"0", "1"}) {
      text += std::string("v ") + std::to_string(std::cos(angle)) + " " + std::to_string(std::sin(angle)) +
              " " + z + "\n";
    }
  }
  for (int i = 0; i < n; ++i) {
    const int a = 2 * i + 1, b = 2 * ((i + 1) % n) + 1;
    text += std::string("f ") + std::to_string(a) + " " + std::to_string(b) + " " + std::to_string(b + 1) +
            " " + std::to_string(a + 1) + "\n";
  }
  return text;
}

TEST(Normals, ACubeStaysFlat) {
  const Mesh m = load(kCube);
  EXPECT_EQ(m.triangles.size(), 12u);
  EXPECT_TRUE(m.normals.empty());
  EXPECT_TRUE(m.triangle_normals.empty());
}

TEST(Normals, ACylinderIsRound) {
  const Mesh m = load(cylinder(24));
  ASSERT_EQ(m.triangle_normals.size(), 48u);
  EXPECT_EQ(m.normals.size(), 48u) << "one for each position, shared by all triangles there";
  for (size_t t = 0; t < m.triangles.size(); ++t) {
    for (size_t k = 0; k < 3; ++k) {
      ASSERT_NE(m.triangle_normals[t][k], kNoIndex);
      const Vec3 p = m.positions[m.triangles[t][k]], n = m.normals[m.triangle_normals[t][k]];
      EXPECT_NEAR(n.x, p.x, 1e-4);
      EXPECT_NEAR(n.y, p.y, 1e-4);
      EXPECT_NEAR(n.z, 0, 1e-4);
    }
  }
}

TEST(Normals, EdgesSharperThanTheCreaseAngleStay) {
  EXPECT_TRUE(load(cylinder(8)).normals.empty()) << "45 degrees from side to side";
  EXPECT_FALSE(load(cylinder(10)).normals.empty()) << "36 degrees";
}

TEST(Normals, PositionsWrittenTwiceCountAsOne) {
  // A soup of triangles, as scanners and STL converters write it.
  const Mesh joined = load(cylinder(24));
  std::string soup;
  for (const Corners& t : joined.triangles) {
    for (const uint32_t p : t) {
      const Vec3& v = joined.positions[p];
      char line[128];
      std::snprintf(line, sizeof line, "v %.9g %.9g %.9g\n", static_cast<double>(v.x),
                    static_cast<double>(v.y), static_cast<double>(v.z));
      soup += line;
    }
    soup += "f -3 -2 -1\n";
  }
  const Mesh m = load(soup);
  EXPECT_EQ(m.normals.size(), joined.normals.size());
}

TEST(Normals, SmoothingGroupsDecideWhereTheFileHasThem) {
  const std::string cube(kCube);
  const Mesh smooth = load("s 1\n" + cube);
  ASSERT_EQ(smooth.normals.size(), 8u);
  for (size_t t = 0; t < smooth.triangles.size(); ++t) {
    for (size_t k = 0; k < 3; ++k) {
      const Vec3 p = smooth.positions[smooth.triangles[t][k]],
                 n = smooth.normals.at(smooth.triangle_normals[t][k]);
      // Three faces of equal angle meet at each corner, however they are cut into triangles.
      EXPECT_NEAR(n.x, p.x > 0.5f ? 0.57735 : -0.57735, 1e-3);
      EXPECT_NEAR(n.y, p.y > 0.5f ? 0.57735 : -0.57735, 1e-3);
      EXPECT_NEAR(n.z, p.z > 0.5f ? 0.57735 : -0.57735, 1e-3);
    }
  }
  EXPECT_TRUE(load("s off\n" + cylinder(24)).normals.empty());
  EXPECT_TRUE(load("s 0\n" + cylinder(24)).normals.empty());

  // Two sides in one group, each of the others alone.
  const std::string sides = "s 7\nf 1 4 3 2\nf 1 2 6 5\ns 2\nf 5 6 7 8\n";
  const Mesh partly = load(cube.substr(0, cube.find('f')) + sides);
  EXPECT_EQ(partly.normals.size(), 2u) << "only the common edge is round";
}

TEST(Normals, GivenNormalsAreKeptAndBrokenOnesComputed) {
  const Mesh m = load("v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 3 4\nvn 0 0 0\nvn nan 0 0\nf 1//1 2//2 3//3\n");
  ASSERT_EQ(m.triangle_normals.size(), 1u);
  EXPECT_EQ(m.normals[m.triangle_normals[0][0]], (Vec3{0, 0.6f, 0.8f}));
  EXPECT_EQ(m.triangle_normals[0][1], kNoIndex);
  EXPECT_EQ(m.triangle_normals[0][2], kNoIndex);
}

TEST(Normals, AHundredThousandTrianglesAtOneVertexTakeNoLonger) {
  const int n = 100000;
  std::string text = "v 0 0 1\n";
  for (int i = 0; i < n; ++i) {
    const double angle = 2 * 3.141592653589793 * i / n;
    char line[96];
    std::snprintf(line, sizeof line, "v %.9g %.9g 0\n", std::cos(angle), std::sin(angle));
    text += line;
  }
  for (int i = 0; i < n; ++i)
    text += std::string("f 1 ") + std::to_string(i + 2) + " " + std::to_string((i + 1) % n + 2) + "\n";
  const Mesh m = load(text);
  ASSERT_EQ(m.triangle_normals.size(), static_cast<size_t>(n));
  ASSERT_NE(m.triangle_normals[0][0], kNoIndex);
  EXPECT_NEAR(m.normals[m.triangle_normals[0][0]].z, 1, 1e-3) << "the tip looks along the axis";
}

TEST(Normals, FrontAndBackOfASheetDoNotMix) {
  const std::string one_side = cylinder(24);
  std::string both = one_side;
  for (int i = 0; i < 24; ++i) {
    const int a = 2 * i + 1, b = 2 * ((i + 1) % 24) + 1;
    both += std::string("f ") + std::to_string(a + 1) + " " + std::to_string(b + 1) + " " +
            std::to_string(b) + " " + std::to_string(a) + "\n";
  }
  const Mesh m = load(both);
  ASSERT_EQ(m.triangle_normals.size(), 96u);
  for (size_t t = 0; t < m.triangles.size(); ++t) {
    const Vec3 p = m.positions[m.triangles[t][0]], n = m.normals.at(m.triangle_normals[t][0]);
    EXPECT_NEAR(n.x * p.x + n.y * p.y, t < 48 ? 1 : -1, 1e-3);
  }
}

}  // namespace
}  // namespace vitral
