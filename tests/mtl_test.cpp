#include "io/mtl.h"

#include "io/image_file.h"
#include "io/mesh_file.h"
#include "scratch.h"

#include <gtest/gtest.h>

#include <map>

namespace vitral {
namespace {

MtlMaterial parse_one(const std::string& statements, Warnings* warnings = nullptr) {
  Warnings ignored;
  const auto materials =
      parse_mtl("newmtl m\n" + statements, "m.mtl", warnings != nullptr ? *warnings : ignored);
  EXPECT_EQ(materials.size(), 1u);
  return materials.at(0);
}

// A picture of one pixel as an uncompressed TGA: r, g, b and, unless it is negative, alpha.
std::string tga(int r, int g, int b, int a = -1) {
  std::string bytes(18, '\0');
  bytes[2] = 2;
  bytes[12] = bytes[14] = 1;
  bytes[16] = a < 0 ? 24 : 32;
  bytes[17] = a < 0 ? 0 : 8;
  for (const int c : {b, g, r}) bytes += static_cast<char>(c);
  if (a >= 0) bytes += static_cast<char>(a);
  return bytes;
}

// Loads a triangle whose material has these statements, out of a folder with these pictures.
Scene load_with(const test::ScratchFolder& folder, const std::string& statements, Warnings& warnings) {
  folder.write("m.mtl", "newmtl m\n" + statements);
  Scene scene;
  load_mesh(folder.write("mesh.obj", "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\n"), scene,
            warnings);
  return scene;
}

TEST(Mtl, ReadsColoursAndNumbers) {
  const Material m =
      parse_one(
          "  Kd 0.1 0.2 0.3\r\n\tKs 0.5\nTf 1 0.5 0\nNs 250\nNi 1.33\nd 0.75\nKa 1 1 1\nKe 1 0 0\nPr 0.5\n")
          .material;
  EXPECT_EQ(m.name, "m");
  EXPECT_EQ(m.diffuse, (Vec3{0.1f, 0.2f, 0.3f}));
  EXPECT_EQ(m.specular, (Vec3{0.5f, 0.5f, 0.5f})) << "one number stands for three";
  EXPECT_EQ(m.transmission, (Vec3{1, 0.5f, 0}));
  EXPECT_EQ(m.emission, (Vec3{1, 0, 0}));
  EXPECT_EQ(parse_one("Ke 12 3 0.5\n").material.emission, (Vec3{12, 3, 0.5f})) << "light may exceed 1";
  EXPECT_EQ(m.shininess, 250);
  EXPECT_EQ(m.index, 1.33f);
  EXPECT_EQ(m.opacity, 0.75f);
}

TEST(Mtl, IllumAndOpacityDecideTheOptics) {
  const std::pair<const char*, Optics> cases[] = {{"", Optics::opaque},
                                                  {"illum 0\n", Optics::opaque},
                                                  {"illum 2\n", Optics::opaque},
                                                  {"illum 3\n", Optics::mirror},
                                                  {"illum 4\n", Optics::solid},
                                                  {"illum 5\n", Optics::polished},
                                                  {"illum 6\n", Optics::solid},
                                                  {"illum 7\n", Optics::solid},
                                                  {"illum 8\n", Optics::polished},
                                                  {"illum 9\n", Optics::solid},
                                                  {"illum 10\n", Optics::opaque},
                                                  {"illum 2\nd 0.5\n", Optics::dissolve},
                                                  {"d 0.5\n", Optics::dissolve},
                                                  {"Tr 0.5\n", Optics::dissolve},
                                                  {"d 0.5\nillum 7\n", Optics::solid},
                                                  {"d 0.5\nillum 3\n", Optics::mirror},
                                                  {"d 0.5\nmap_d a.png\n", Optics::opaque}};
  for (const auto& [text, optics] : cases) EXPECT_EQ(parse_one(text).material.optics, optics) << text;
}

TEST(Mtl, DissolveGoesBeforeTransparency) {
  EXPECT_EQ(parse_one("Tr 0.25\n").material.opacity, 0.75f);
  EXPECT_EQ(parse_one("Tr 0.25\nd 0.5\n").material.opacity, 0.5f);
  EXPECT_EQ(parse_one("d 0.5\nTr 0.25\n").material.opacity, 0.5f);
  EXPECT_EQ(parse_one("d -halo 0.5\n").material.opacity, 0.5f);
}

TEST(Mtl, BringsValuesIntoTheirRanges) {
  Warnings warnings;
  const Material m =
      parse_one("Kd nan 0 0\nKs 2 -1 0.5\nNs inf\nNi 0\nd 7\nTf 0 zero 0\n", &warnings).material;
  EXPECT_EQ(m.diffuse, Material{}.diffuse);
  EXPECT_EQ(m.specular, (Vec3{1, 0, 0.5f}));
  EXPECT_EQ(m.shininess, 0);
  EXPECT_EQ(m.index, 1.5f);
  EXPECT_EQ(m.opacity, 1);
  EXPECT_EQ(m.transmission, (Vec3{1, 1, 1}));
  ASSERT_EQ(warnings.size(), 3u);
  EXPECT_EQ(warnings[0].substr(0, 8), "m.mtl:2:");
  EXPECT_EQ(warnings[1].substr(0, 8), "m.mtl:4:");
  EXPECT_EQ(warnings[2].substr(0, 8), "m.mtl:7:");
}

TEST(Mtl, SkipsTheOptionsOfMaps) {
  Warnings warnings;
  EXPECT_EQ(
      parse_one("map_Kd -s 1 1 1 -o 0 0 -bm 2 -clamp off -imfchan r -mm 0 1 my picture 1.png \n", &warnings)
          .diffuse_map,
      "my picture 1.png");
  EXPECT_TRUE(warnings.empty());
  EXPECT_EQ(parse_one("map_Kd -s 2 2 pic.png\n", &warnings).diffuse_map, "pic.png");
  ASSERT_EQ(warnings.size(), 1u) << "a scale that is not applied changes the picture";
  EXPECT_EQ(warnings[0], "m.mtl:2: texture option -s is ignored");
  EXPECT_EQ(parse_one("map_Kd -o 1 2 3 12\n").diffuse_map, "12") << "a name may be a number";
  EXPECT_EQ(parse_one("map_Kd \"a b.png\"\n").diffuse_map, "a b.png");
  EXPECT_EQ(parse_one("map_Kd -odd name.png\n").diffuse_map, "-odd name.png");
  EXPECT_EQ(parse_one("map_d mask.png\n").opacity_map, "mask.png");
}

TEST(Mtl, ABlackKdBesideATextureIsWhite) {
  EXPECT_EQ(parse_one("Kd 0 0 0\nmap_Kd a.png\n").material.diffuse, (Vec3{1, 1, 1}));
  EXPECT_EQ(parse_one("Kd 0 0 0\n").material.diffuse, (Vec3{0, 0, 0}));
  EXPECT_EQ(parse_one("Kd 0.5 0 0\nmap_Kd a.png\n").material.diffuse, (Vec3{0.5f, 0, 0}));
}

TEST(Mtl, FindsTexturesUnderTheNamesPeopleWrite) {
  const test::ScratchFolder folder;
  folder.write("maps/Brick Wall.TGA", tga(10, 20, 30));
  for (const char* const name : {"maps/Brick Wall.TGA", "maps\\brick wall.tga", "./MAPS/BRICK WALL.TGA"}) {
    Warnings warnings;
    const Scene scene = load_with(folder, std::string("map_Kd ") + name + "\n", warnings);
    EXPECT_TRUE(warnings.empty()) << warnings.front();
    ASSERT_EQ(scene.textures.size(), 1u) << name;
    EXPECT_EQ(scene.textures[0].texels, (std::vector<uint8_t>{10, 20, 30, 255}));
    EXPECT_EQ(scene.materials[0].diffuse_map, 0);
  }
  folder.write("wood.tga", tga(1, 2, 3));
  Warnings warnings;
  EXPECT_EQ(load_with(folder, "map_Kd C:\\Users\\me\\Wood.tga\n", warnings).textures.size(), 1u);
}

TEST(Mtl, AMissingOrBrokenTextureIsAWarning) {
  const test::ScratchFolder folder;
  folder.write("broken.png", "\x89PNG\r\n\x1a\n");
  folder.write("empty.png", "");
  for (const char* const name : {"missing.png", "broken.png", "empty.png"}) {
    Warnings warnings;
    const Scene scene = load_with(folder, std::string("Kd 1 0 0\nmap_Kd ") + name + "\n", warnings);
    ASSERT_EQ(warnings.size(), 1u);
    EXPECT_NE(warnings[0].find("m.mtl:3: texture "), std::string::npos) << warnings[0];
    EXPECT_NE(warnings[0].find(name), std::string::npos) << warnings[0];
    EXPECT_EQ(scene.materials[0].diffuse_map, kNoTexture);
    EXPECT_EQ(scene.materials[0].diffuse, (Vec3{1, 0, 0}));
  }
}

TEST(Mtl, OpacityIsAlphaOrElseGrey) {
  const test::ScratchFolder folder;
  folder.write("rgba.tga", tga(200, 100, 50, 40));
  folder.write("rgb.tga", tga(60, 60, 60));
  folder.write("opaque.tga", tga(70, 70, 70, 255));
  Warnings warnings;

  Scene scene = load_with(folder, "map_Kd rgba.tga\nmap_d rgba.tga\n", warnings);
  ASSERT_EQ(scene.textures.size(), 1u) << "a file used twice is loaded once";
  EXPECT_EQ(scene.materials[0].diffuse_map, 0);
  EXPECT_EQ(scene.materials[0].opacity_map, 0);
  EXPECT_EQ(scene.textures[0].texels, (std::vector<uint8_t>{200, 100, 50, 40}));

  scene = load_with(folder, "map_Kd rgba.tga\nmap_d rgb.tga\n", warnings);
  ASSERT_EQ(scene.textures.size(), 2u);
  EXPECT_EQ(scene.textures[static_cast<size_t>(scene.materials[0].opacity_map)].texels[3], 60)
      << "no alpha: grey";

  scene = load_with(folder, "map_d opaque.tga\n", warnings);
  EXPECT_EQ(scene.textures.at(0).texels[3], 70) << "an alpha channel that says nothing";

  scene = load_with(folder, "map_Kd rgba.tga\n", warnings);
  EXPECT_EQ(scene.materials[0].opacity_map, kNoTexture)
      << "a colour texture with alpha does not cut out by itself";
  EXPECT_TRUE(warnings.empty());
}

TEST(Mtl, TexturesOfUnusedMaterialsAreNotLoaded) {
  const test::ScratchFolder folder;
  folder.write("a.tga", tga(1, 2, 3));
  Warnings warnings;
  const Scene scene = load_with(folder, "Kd 1 1 1\nnewmtl other\nmap_Kd a.tga\n", warnings);
  EXPECT_EQ(scene.materials.size(), 2u);
  EXPECT_TRUE(scene.textures.empty());
}

}  // namespace
}  // namespace vitral
