// The lights of project files, and the command line's say in them.
#include "app/options.h"
#include "io/project.h"
#include "scratch.h"
#include "support.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace vitral {
namespace {

struct Folder : test::ScratchFolder {
  Folder() { write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"); }

  Project read(const std::string& lights, Warnings& warnings, const std::string& trace = "") const {
    return read_project(write("p.xml",
                              "<project><assets><scenes><scene name='s'><file name='a.obj'/></scene></scenes>"
                              "<lights>\n" +
                                  lights +
                                  "</lights></assets><pipelines><pipeline name='p'><pass class='raster'/>"
                                  "<pass class='trace'>" +
                                  trace + "</pass></pipeline></pipelines></project>"),
                        warnings);
  }
  Light light(const std::string& text) const {
    Warnings warnings;
    const Project project = read(text, warnings);
    EXPECT_EQ(warnings, Warnings{});
    return project.scene.lights.at(0);
  }
  // Without the folder: "p.xml:2: reason".
  std::string complaint(const std::string& text) const {
    const std::string all = test::error_of<InputError>([&] {
      Warnings warnings;
      read(text, warnings);
    });
    return all.empty() ? all : all.substr(path().string().size() + 1);
  }
};

constexpr const char* kPosition = "<position value='1 2 3'/>";
constexpr const char* kDown = "<direction value='0 -2 0'/>";

std::string of_type(const std::string& type, const std::string& body, const std::string& more = "") {
  return "<light type='" + type + "' " + more + ">" + body + "</light>";
}

TEST(ProjectLights, HaveTheirKinds) {
  const Folder folder;
  const std::string both = std::string(kPosition) + kDown;
  EXPECT_EQ(folder.light(of_type("Directional", both)).kind, Light::Kind::directional);
  EXPECT_EQ(folder.light(of_type("point", both)).kind, Light::Kind::point);

  const Light spot =
      folder.light(of_type("spot", both + "<cone inner='12.5' outer='60'/><color value='3'/>"));
  EXPECT_EQ(spot.kind, Light::Kind::spot);
  EXPECT_EQ(spot.direction, (Vec3{0, -1, 0}));
  EXPECT_EQ(spot.position, (Vec3{1, 2, 3}));
  EXPECT_EQ(spot.color, (Vec3{3, 3, 3}));
  EXPECT_EQ(spot.inner_degrees, 12.5f);
  EXPECT_EQ(spot.outer_degrees, 60);
  const Light narrow = folder.light(of_type("spot", both + "<cone outer='20'/>"));
  EXPECT_EQ(narrow.inner_degrees, 20) << "never more than the outer one";

  const Light sphere = folder.light(of_type("sphere", std::string(kPosition) + "<radius>0.25</radius>"));
  EXPECT_EQ(sphere.kind, Light::Kind::sphere);
  EXPECT_EQ(sphere.radius, 0.25f);
  EXPECT_EQ(sphere.samples, 16) << "by itself";

  const Light sun = folder.light(of_type("sun", std::string(kDown) + "<diameter value='2'/>", "samples='9'"));
  EXPECT_EQ(sun.kind, Light::Kind::sun);
  EXPECT_EQ(sun.diameter_degrees, 2);
  EXPECT_EQ(sun.samples, 9);
  EXPECT_EQ(folder.light(of_type("sun", kDown)).diameter_degrees, 0.53f);
}

TEST(ProjectLights, RectanglesLieAcrossTheirDirection) {
  const Folder folder;
  const auto rectangle = [&](const std::string& direction, const std::string& more) {
    return folder.light(of_type("rectangle", std::string(kPosition) + "<direction value='" + direction +
                                                 "'/><size width='2' height='0.5'/>" + more));
  };
  for (const auto& [direction, side, along] :
       {std::tuple{"0 -1 0", "", Vec3{1, 0, 0}}, std::tuple{"0 1 0", "", Vec3{1, 0, 0}},
        std::tuple{"0 0 -3", "", Vec3{1, 0, 0}},
        std::tuple{"0 -1 0", "<side value='0 0 -5'/>", Vec3{0, 0, -1}},
        std::tuple{"1 0 0", "<side value='9 1 0'/>", Vec3{0, 1, 0}}}) {
    const Light light = rectangle(direction, side);
    EXPECT_EQ(light.kind, Light::Kind::rectangle);
    EXPECT_NEAR(length(light.side_u), 2, 1e-6f);
    EXPECT_NEAR(length(light.side_v), 0.5f, 1e-6f);
    EXPECT_NEAR(std::abs(dot(light.side_u, along)), 2, 1e-6f) << direction << side;
    EXPECT_NEAR(dot(light.side_u, light.direction), 0, 1e-6f);
    EXPECT_NEAR(dot(light.side_v, light.direction), 0, 1e-6f);
    EXPECT_NEAR(dot(light.side_u, light.side_v), 0, 1e-6f);
  }
}

TEST(ProjectLights, FaultsHaveTheirLine) {
  const Folder folder;
  const std::string both = std::string(kPosition) + kDown;
  const std::pair<std::string, const char*> bad[] = {
      {of_type("laser", both), "is not one of directional, point, spot, rectangle, sphere, sun"},
      {of_type("spot", kPosition), "this light has no direction"},
      {of_type("spot", kDown), "this light has no position"},
      {of_type("rectangle", both), "this light has no size"},
      {of_type("sphere", kPosition), "this light has no radius"},
      {of_type("sphere", "<radius>1</radius>"), "this light has no position"},
      {of_type("sun", kPosition), "this light has no direction"},
      {"<light/>", "this light has neither direction nor position"},
      {of_type("sphere", std::string(kPosition) + "<radius>0</radius>"), "<radius> is '0', not a number"},
      {of_type("sphere", std::string(kPosition) + "<radius>1 2</radius>"), "<radius> is '1 2'"},
      {of_type("sun", std::string(kDown) + "<diameter>190</diameter>"), "<diameter> is '190'"},
      {of_type("spot", both + "<cone inner='50' outer='40'/>"), "the inner cone is wider than the outer one"},
      {of_type("spot", both + "<cone outer='181'/>"), "outer=\"181\" is not a number"},
      {of_type("rectangle", both + "<size width='0'/>"), "width=\"0\" is not a number"},
      {of_type("rectangle", both + "<size/><side value='0 3 0'/>"), "the side is zero or runs along"},
      {of_type("rectangle", both + "<size/><side value='0 0 0'/>"), "the side is zero or runs along"},
      {of_type("sun", kDown, "samples='0'"), "samples=\"0\" is not a whole number from 1 to 1024"},
      {of_type("sun", kDown, "samples='1025'"), "samples=\"1025\" is not"},
  };
  for (const auto& [text, reason] : bad) {
    const std::string message = folder.complaint(text);
    EXPECT_EQ(message.substr(0, 9), "p.xml:2: ") << text;
    EXPECT_NE(message.find(reason), std::string::npos) << message;
  }
}

TEST(ProjectLights, WarnOfWhatOtherKindsHave) {
  const Folder folder;
  for (const std::string& text : {of_type("point", std::string(kPosition) + "<radius>1</radius>"),
                                  of_type("directional", kDown, "samples='4'"),
                                  of_type("sun", std::string(kDown) + "<cone inner='3'/>")}) {
    Warnings warnings;
    folder.read(text, warnings);
    EXPECT_EQ(warnings.size(), 1u) << text;
  }
}

TEST(ProjectLights, PipelinesMaySetTheSamplesOfAll) {
  const Folder folder;
  Warnings warnings;
  const std::string sun = of_type("sun", kDown);
  EXPECT_EQ(folder.read(sun, warnings).pipelines[0].settings.light_samples, 0);
  EXPECT_EQ(folder.read(sun, warnings, "<shadows samples='64'/>").pipelines[0].settings.light_samples, 64);
  EXPECT_EQ(warnings, Warnings{});
  EXPECT_NE(test::error_of<InputError>([&] { folder.read(sun, warnings, "<shadows samples='0'/>"); }), "");
}

TEST(ProjectLights, TheCommandLineMaySetThemToo) {
  EXPECT_FALSE(parse_options({"a.obj"}).light_samples);
  EXPECT_EQ(parse_options({"a.obj", "--light-samples", "256"}).light_samples, 256);
  for (const char* bad : {"0", "1025", "-1", "two", "1.5"}) {
    EXPECT_NE(test::error_of<UsageError>([&] {
                parse_options({"a.obj", "--light-samples", bad});
              }),
              "")
        << bad;
  }
}

}  // namespace
}  // namespace vitral
