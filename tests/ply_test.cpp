#include "io/ply.h"

#include "scratch.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>

namespace vitral {
namespace {

struct Loaded {
  Scene scene;
  Warnings warnings;
};

Loaded load(const std::string& bytes) {
  const test::ScratchFolder folder;
  Loaded result;
  load_ply(folder.write("mesh.ply", bytes), result.scene, result.warnings, 1);
  return result;
}

std::string error_in(const std::string& bytes) {
  const std::string error = test::error_of<InputError>([&] { load(bytes); });
  const size_t at = error.find("mesh.ply");
  return at == std::string::npos ? error : error.substr(at);
}

const std::string kAscii =
    "ply\nformat ascii 1.0\ncomment by hand \\\nelement vertex 4\nproperty float x\nproperty float "
    "y\nproperty float z\n"
    "property uchar red\nelement face 2\nproperty list uchar int vertex_indices\nend_header\n";

enum class Order { little, big };

template <class T>
void put(std::string& bytes, T value, Order order) {
  auto raw = std::bit_cast<std::array<char, sizeof(T)>>(value);
  if (order == Order::big) std::reverse(raw.begin(), raw.end());
  bytes.append(raw.data(), raw.size());
}

// A square with texture coordinates and normals, and things to be skipped before, between and after.
std::string binary(Order order) {
  std::string b = std::string("ply\r\nformat binary_") + (order == Order::big ? "big" : "little") +
                  "_endian 1.0\r\nelement junk 2\r\nproperty list ushort double stuff\r\nproperty char c\r\n"
                  "element vertex 4\r\nproperty double x\r\nproperty float nx\r\nproperty float "
                  "ny\r\nproperty float nz\r\n"
                  "property short y\r\nproperty list uchar int extra\r\nproperty float z\r\nproperty float "
                  "s\r\nproperty float t\r\n"
                  "element face 1\r\nproperty uchar flags\r\nproperty list int ushort vertex_index\r\n"
                  "property list uchar float texcoord\r\nend_header\r\n";
  for (int i = 0; i < 2; ++i) {
    put(b, uint16_t{2}, order);
    put(b, 1.0, order);
    put(b, 2.0, order);
    put(b, int8_t{7}, order);
  }
  for (int i = 0; i < 4; ++i) {
    const bool right = i == 1 || i == 2, up = i >= 2;
    put(b, right ? 2.5 : 0.0, order);
    for (const float n : {0.0f, 0.0f, 3.0f}) put(b, n, order);
    put(b, static_cast<int16_t>(up ? 2 : 0), order);
    put(b, uint8_t{1}, order);
    put(b, int32_t{-1}, order);
    put(b, 0.0f, order);
    put(b, right ? 1.0f : 0.0f, order);
    put(b, up ? 1.0f : 0.0f, order);
  }
  put(b, uint8_t{9}, order);
  put(b, int32_t{4}, order);
  for (uint16_t i = 0; i < 4; ++i) put(b, i, order);
  put(b, uint8_t{0}, order);
  return b;
}

TEST(Ply, ReadsAscii) {
  const Loaded l = load(kAscii + "0 0 0 255\n1 0 0 255\n1 1 0 255\n0 1 0 1\n3 0 1 2\n4 0 1 2 3\n");
  const Mesh& m = l.scene.mesh;
  ASSERT_EQ(m.triangles.size(), 3u);
  EXPECT_EQ(m.triangles[0], (Corners{0, 1, 2}));
  EXPECT_EQ(m.positions[2], (Vec3{1, 1, 0}));
  ASSERT_EQ(l.scene.materials.size(), 1u);
  EXPECT_EQ(l.scene.materials[0].name, "default");
  EXPECT_EQ(m.triangle_material, (std::vector<uint32_t>{0, 0, 0}));
  EXPECT_TRUE(m.triangle_texcoords.empty());
}

TEST(Ply, ReadsBothByteOrders) {
  for (const Order order : {Order::little, Order::big}) {
    const Mesh m = load(binary(order)).scene.mesh;
    ASSERT_EQ(m.triangles.size(), 2u);
    EXPECT_EQ(m.positions[2], (Vec3{2.5f, 2, 0}));
    EXPECT_EQ(m.normals[1], (Vec3{0, 0, 1}));
    EXPECT_EQ(m.triangle_normals[1], m.triangles[1]);
    EXPECT_EQ(m.triangle_texcoords[1], m.triangles[1]);
    EXPECT_EQ(m.texcoords[2].x, 1);
    EXPECT_EQ(m.texcoords[1].y, 0);
  }
}

TEST(Ply, ReadsTriangleStrips) {
  const std::string header =
      "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\n"
      "element tristrips 1\nproperty list int int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n0 "
      "2 0\n";
  const Mesh m = load(header + "9 0 1 2 3 4 -1 0 1 2\n").scene.mesh;
  ASSERT_EQ(m.triangles.size(), 4u);
  for (const Corners& t : m.triangles) {
    EXPECT_GT(cross(m.positions[t[1]] - m.positions[t[0]], m.positions[t[2]] - m.positions[t[0]]).z, 0);
  }
}

TEST(Ply, AnswersWrongFilesWithAReason) {
  const std::string vertices = "0 0 0 255\n1 0 0 255\n1 1 0 255\n0 1 0 1\n";
  EXPECT_EQ(error_in(""), "mesh.ply: the file is empty");
  EXPECT_EQ(error_in("v 0 0 0\n"), "mesh.ply: not a PLY file: it does not begin with 'ply'");
  EXPECT_EQ(error_in("ply\nformat ascii 1.0\n"), "mesh.ply:3: the header has no end");
  EXPECT_EQ(error_in("ply\nformat excel 1.0\nend_header\n"), "mesh.ply:2: 'excel' is not a PLY format");
  EXPECT_EQ(error_in("ply\nformat ascii 1.0\nelement vertex 3\nproperty real x\nend_header\n"),
            "mesh.ply:4: 'real' is not a PLY type");
  EXPECT_EQ(error_in("ply\nformat ascii 1.0\nelement vertex -3\nend_header\n"),
            "mesh.ply:3: '-3' is not a count");
  EXPECT_EQ(error_in(kAscii + vertices + "3 0 1 4\n3 0 1 2\n"),
            "mesh.ply:16: vertex index 4 is out of range (4 in the file)");
  EXPECT_EQ(error_in(kAscii + vertices + "3 0 1 -1\n3 0 1 2\n"),
            "mesh.ply:16: vertex index -1 is out of range (4 in the file)");
  EXPECT_EQ(error_in(kAscii + vertices + "3 0 1 2\n3 0 1"), "mesh.ply:17: the file ends too early");
  EXPECT_EQ(error_in(kAscii + vertices + "3 0 1 x\n3 0 1 2\n"), "mesh.ply:16: 'x' is not a number");
  EXPECT_EQ(error_in(kAscii + vertices + "99 0 1 2\n3 0 1 2\n"),
            "mesh.ply:16: a list is longer than the file, or shorter than nothing");
}

TEST(Ply, BelievesNoCountThatTheFileCannotHold) {
  std::string bytes = binary(Order::little);
  const size_t at = bytes.find("element vertex 4");
  bytes.replace(at, 16, "element vertex 4000000000000000000");
  EXPECT_EQ(error_in(bytes),
            "mesh.ply: the header promises 4000000000000000000 of 'vertex', more than the file holds");
  // A row without properties has no bytes: any number of them is nothing.
  std::string empty_rows = binary(Order::little);
  empty_rows.insert(empty_rows.find("element junk"), "element nothing 18446744073709551615\r\n");
  EXPECT_EQ(load(empty_rows).scene.mesh.triangles.size(), 2u);
}

TEST(Ply, APointCloudHasNoTriangles) {
  EXPECT_EQ(
      error_in(
          "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
          "end_header\n1 2 3\n"),
      "mesh.ply: there are no triangles in it");
}

// Cut anywhere, a file is answered with an error and nothing else.
TEST(Ply, EveryTruncationIsAnError) {
  const std::string whole = binary(Order::big);
  for (size_t n = 0; n < whole.size(); n += n < 600 ? 7 : 1) EXPECT_NE(error_in(whole.substr(0, n)), "") << n;
}

}  // namespace
}  // namespace vitral
