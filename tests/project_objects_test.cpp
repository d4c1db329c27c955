// Objects as projects write them.
#include "io/placement.h"
#include "io/project.h"
#include "scratch.h"
#include "support.h"

#include <gtest/gtest.h>

namespace vitral::test {
namespace {

constexpr const char* kTriangle = "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl own\nf 1 2 3\n";
constexpr const char* kLibrary = "newmtl own\nKd 1 0 0\nnewmtl other\nKd 0 1 0\n";

class ProjectObjects : public testing::Test {
 protected:
  void SetUp() override {
    folder_.write("a.obj", kTriangle);
    folder_.write("m.mtl", kLibrary);
  }
  // A project whose scene holds this; it begins on line 2.
  Project load(const std::string& scene) {
    folder_.write(
        "p.xml", "<project><assets><scenes><scene>\n" + scene +
                     "\n</scene></scenes><materialLibs><mlib name='m.mtl'/></materialLibs></assets>"
                     "<pipelines><pipeline name='a'><pass class='raster'/></pipeline></pipelines></project>");
    warnings_.clear();
    return load_project(folder_ / "p.xml", warnings_);
  }
  void expect_error(const std::string& scene, const std::string& reason) {
    try {
      load(scene);
      ADD_FAILURE() << "no error: " << scene;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(reason), std::string::npos) << error.what();
    }
  }
  ScratchFolder folder_;
  Warnings warnings_;
};

void expect_point(const Object& object, const Vec3& from, const Vec3& to) {
  EXPECT_LT(length(transform_point(object.placement, from) - to), 1e-5f)
      << transform_point(object.placement, from).x << " " << transform_point(object.placement, from).y << " "
      << transform_point(object.placement, from).z;
}

TEST_F(ProjectObjects, ShapesStandWhereTheirAttributesSay) {
  const Project p = load(
      "<sphere center='1 2 3' radius='0.5'/>\n<box min='0 0 0' max='2 4 6'/>\n"
      "<cylinder from='0 0 0' to='4 0 0' radius='2'/>\n<disk center='0 1 0' normal='0 0 1' radius='3'/>\n"
      "<plane point='0 -1 0' normal='0 -1 0'/>\n<sphere/>");
  const auto& o = p.scene.objects;
  ASSERT_EQ(o.size(), 6u);
  EXPECT_TRUE(warnings_.empty());
  const Shape shapes[] = {Shape::sphere, Shape::box,   Shape::cylinder,
                          Shape::disk,   Shape::plane, Shape::sphere};
  for (size_t i = 0; i < 6; ++i) EXPECT_EQ(o[i].shape, shapes[i]);
  expect_point(o[0], {0, 1, 0}, {1, 2.5f, 3});
  expect_point(o[1], {1, -1, 1}, {2, 0, 6});
  expect_point(o[2], {0, -1, 0}, {0, 0, 0});
  expect_point(o[2], {0, 1, 0}, {4, 0, 0});
  EXPECT_NEAR(length(transform_vector(o[2].placement, Vec3{1, 0, 0})), 2, 1e-5f);
  expect_point(o[3], {0, 1, 0}, {0, 1, 1});
  EXPECT_NEAR(length(transform_vector(o[3].placement, Vec3{0, 0, 1})), 3, 1e-5f);
  expect_point(o[4], {0, 1, 0}, {0, -2, 0});
  EXPECT_EQ(o[5].placement.x, (Vec3{1, 0, 0}));
  EXPECT_EQ(p.scene.materials[o[0].material].name, "default");
  EXPECT_EQ(o[0].material, o[5].material) << "one for all";
}

TEST_F(ProjectObjects, UprightIsARotation) {
  Random random(1);
  for (int i = 0; i < 1000; ++i) {
    Vec3 n = random.direction();
    if (i < 3) n = i == 0 ? Vec3{0, -1, 0} : i == 1 ? Vec3{0, 1, 0} : normalize(Vec3{1e-5f, -1, 0});
    const Affine a = upright_along(n * random.between(0.1f, 10));
    ASSERT_LT(length(a.y - n), 1e-6f);
    ASSERT_NEAR(determinant(a), 1, 1e-5);
    ASSERT_NEAR(dot(a.x, a.z), 0, 1e-5f);
    ASSERT_NEAR(length(a.x), 1, 1e-5f);
  }
}

TEST_F(ProjectObjects, TransformsAreAppliedInTheirOrder) {
  const Project p = load(
      "<sphere><translate x='1' y='0' z='0'/><rotate axis='0 1 0' degrees='90'/><scale>2</scale></sphere>\n"
      "<sphere><scale value='2'/><rotate degrees='90'/><translate value='1 0 0'/></sphere>\n"
      "<sphere><matrix>1 0 0 5  0 2 0 6  0 0 3 7</matrix></sphere>\n"
      "<sphere><scale x='1' y='-2' z='3'/></sphere>");
  const auto& o = p.scene.objects;
  ASSERT_EQ(o.size(), 4u);
  expect_point(o[0], {0, 0, 0}, {0, 0, -2});
  expect_point(o[1], {0, 0, 0}, {1, 0, 0});
  expect_point(o[1], {1, 0, 0}, {1, 0, -2});
  expect_point(o[2], {1, 1, 1}, {6, 8, 10});
  expect_point(o[3], {1, 1, 1}, {1, -2, 3});
}

TEST_F(ProjectObjects, ModelsAreLoadedOnceAndPlacedByName) {
  const Project p = load(
      "<instance model='t' material='other'><translate x='0' y='0' z='5'/></instance>\n"
      "<model name='t'><file name='a.obj'/></model>\n<instance model='t'/>\n<sphere material='own'/>");
  EXPECT_EQ(p.scene.models.size(), 1u);
  EXPECT_EQ(p.scene.models[0].triangles.size(), 1u);
  EXPECT_TRUE(p.scene.mesh.triangles.empty());
  ASSERT_EQ(p.scene.objects.size(), 3u);
  EXPECT_EQ(p.scene.materials[p.scene.objects[0].material].name, "other") << "out of the library";
  EXPECT_EQ(p.scene.objects[1].material, kNoIndex);
  EXPECT_EQ(p.scene.materials[p.scene.objects[2].material].name, "own");
  EXPECT_EQ(p.scene.objects[2].material, p.scene.models[0].triangle_material[0]) << "the mesh's";
  EXPECT_TRUE(warnings_.empty());
}

TEST_F(ProjectObjects, ManyInstancesStandInAFile) {
  folder_.write("f.txt", "# x y z scale degrees\n1 2 3\n\n4 5 6 2 # scaled\n7 8 9 2 90\n");
  const Project p = load("<model name='t'><file name='a.obj'/></model><instances model='t' file='f.txt'/>");
  ASSERT_EQ(p.scene.objects.size(), 3u);
  expect_point(p.scene.objects[0], {1, 0, 0}, {2, 2, 3});
  expect_point(p.scene.objects[1], {1, 0, 0}, {6, 5, 6});
  expect_point(p.scene.objects[2], {1, 0, 0}, {7, 8, 7});
  const auto refused = [&](const std::string& text, const std::string& where) {
    folder_.write("f.txt", text);
    expect_error("<model name='t'><file name='a.obj'/></model><instances model='t' file='f.txt'/>", where);
  };
  refused("1 2 3\n1 2\n", "f.txt:2: not a placement");
  refused("1 2 3 4 5 6\n", "f.txt:1: not a placement");
  refused("1 2 three\n", "f.txt:1: not a placement");
  refused("1 2 3 0\n", "f.txt:1: not a placement");
  refused("1 2 inf\n", "f.txt:1: not a placement");
}

TEST_F(ProjectObjects, MotionIsReadAsKeys) {
  const Project p = load(
      "<sphere><translate x='9' y='0' z='0'/><motion><key time='0'/><key time='2'>"
      "<translate x='1' y='0' z='0'/><rotate axis='0 1 0' degrees='90'/></key></motion></sphere>");
  ASSERT_EQ(p.scene.objects.size(), 1u);
  const auto& keys = p.scene.objects[0].motion;
  ASSERT_EQ(keys.size(), 2u);
  EXPECT_EQ(keys[1].time, 2);
  EXPECT_LT(length(keys[1].translation - Vec3{0, 0, -1}), 1e-6f) << "turned after it was displaced";
  EXPECT_LT(length(rotate(keys[1].rotation, {1, 0, 0}) - Vec3{0, 0, -1}), 1e-6f);
  expect_error("<sphere>\n<motion><key time='1'/>\n<key time='1'/></motion></sphere>", "p.xml:4: the time");
  expect_error("<sphere><motion/></sphere>", "p.xml:2: <motion> has no <key>");
}

TEST_F(ProjectObjects, ErrorsSayWhere) {
  expect_error("\n<instance model='x'/>", "p.xml:3: no model is called 'x'");
  expect_error("<sphere material='x'/>", "p.xml:2: no material is called 'x'");
  expect_error("<sphere><scale>0</scale></sphere>", "p.xml:2: this placement has no inverse");
  expect_error("<sphere><matrix>1 0 0 0 1 0 0 0 0 0 1 0</matrix></sphere>", "p.xml:2: this placement");
  expect_error("<sphere><matrix>1 0 0</matrix></sphere>", "p.xml:2: <matrix> needs 12 numbers");
  expect_error("<sphere>\n<matrix>1 0 x</matrix></sphere>", "p.xml:3: <matrix> holds 'x'");
  expect_error("<sphere>\n<rotate axis='0 0 0' degrees='1'/></sphere>", "p.xml:3: the axis is zero");
  expect_error("<sphere>\n<rotate/></sphere>", "p.xml:3: <rotate> needs degrees");
  expect_error("<sphere radius='0'/>", "p.xml:2: radius");
  expect_error("<sphere center='1 2'/>", "p.xml:2: center");
  expect_error("<box min='0 0 0' max='0 1 1'/>", "p.xml:2: min is not less than max");
  expect_error("<cylinder from='1 1 1' to='1 1 1'/>", "p.xml:2: from and to are the same");
  expect_error("<plane normal='0 0 0'/>", "p.xml:2: normal is zero");
  expect_error("<model><file name='a.obj'/></model>", "p.xml:2: this model has no name");
  expect_error("<model name='a'/>", "p.xml:2: this model names no file");
  expect_error("<model name='a'>\n<file name='no.obj'/></model>", "p.xml:3: ");
  expect_error("<model name='a'><file name='a.obj'/></model>\n<model name='a'><file name='a.obj'/></model>",
               "p.xml:3: there is another model 'a'");
  expect_error("", "the project names no scene file");
  load("<sphere size='3'><turn/></sphere><cone/>");
  ASSERT_EQ(warnings_.size(), 3u);
  EXPECT_NE(warnings_[0].find("size"), std::string::npos);
  EXPECT_NE(warnings_[1].find("turn"), std::string::npos);
  EXPECT_NE(warnings_[2].find("cone"), std::string::npos);
}

}  // namespace
}  // namespace vitral::test
