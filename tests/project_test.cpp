// Project files: what they mean, what is wrong with them and in which line.
#include "io/project.h"

#include "scratch.h"

#include <gtest/gtest.h>

#include <string>

namespace vitral {
namespace {

constexpr const char* kTriangle = "usemtl Vidro\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

// A folder with a triangle in a.obj, and projects beside it.
struct Folder : test::ScratchFolder {
  Folder() {
    write("a.obj", std::string("mtllib a.mtl\n") + kTriangle), write("a.mtl", "newmtl Vidro\nKd 1 0 0\n");
  }

  Project read(const std::string& text, Warnings* warnings = nullptr) const {
    Warnings here;
    return read_project(write("p.xml", text), warnings ? *warnings : here);
  }
  // Without the folder: "p.xml:3: reason".
  std::string complaint(const std::string& text) const {
    try {
      read(text);
    } catch (const InputError& error) {
      return std::string(error.what()).substr(path().string().size() + 1);
    }
    return "";
  }
};

constexpr const char* kScenes = "<scenes><scene name='s'><file name='a.obj'/></scene></scenes>";
constexpr const char* kCamera = "<cameras><camera name='c'/></cameras>";
constexpr const char* kPipelines =
    "<pipelines><pipeline name='p'><pass class='raster'/></pipeline></pipelines>";

std::string project_with_assets(const std::string& assets) {
  return "<project><assets>" + std::string(kScenes) + "\n" + assets + "</assets>" + kPipelines + "</project>";
}
std::string project_with_passes(const std::string& passes) {
  return "<project><assets>" + std::string(kScenes) + kCamera +
         "</assets><pipelines><pipeline name='p'><pass class='raster'/>\n" + passes +
         "</pipeline></pipelines></project>";
}

TEST(Project, ReadsTheReportsVocabulary) {
  const Folder folder;
  Warnings warnings;
  const Project project = folder.read(R"(<?xml version="1.0"?>
<project width=640 height="480">
  <assets>
    <scenes><scene name="Main"><file name="a.obj"/></scene></scenes>
    <viewports><viewport name="v"><bgcolor r="0.1" g="0.2" b="0.3"/></viewport></viewports>
    <cameras>
      <camera name="Fonte" type="perspective">
        <perspective fov="50" near="0.3" far="1000"/>
        <position x="7.42" y="18.61" z="-38.62"/>
        <view value="0.31, -0.36, 0.87"/>
        <up>0 1 0</up>
      </camera>
      <camera name="Other"/>
    </cameras>
    <lights>
      <light name="Sun"><direction x="0" y="-2" z="0"/><color r="0.9" g="0.8" b="0.7"/><ambient value="0.5"/></light>
      <light name="Lamp"><position x="1" y="2" z="3"/><ambient r="0" g="0.25" b="0"/></light>
    </lights>
    <materialLibs><mlib name="a.mtl"/></materialLibs>
  </assets>
  <pipelines>
    <pipeline name="plain"><pass class="default" name="r"/></pipeline>
    <pipeline name="full" default="true" defaultCamera="Other">
      <pass class="raster" name="r" primary="trace">
        <camera name="Fonte"/> <viewport>v</viewport>
        <scenes><scene name="Main"/></scenes> <lights><light name="Sun"/></lights>
        <materialMaps><map fromMaterial="Vidro" kind="solid" index="1.3" tint="0.9 0.8 0.7" toMaterial="x"/></materialMaps>
      </pass>
      <pass class="optix" name="t" seed="7">
        <shadows terminator="smooth"/>
        <reflection maxDepth="3" fresnel="schlick"/>
        <ambientOcclusion samples="25" distance="2" exponent="1.6"/>
      </pass>
      <pass class="quad" name="c" compositing="report"/>
    </pipeline>
  </pipelines>
</project>)",
                                      &warnings);
  EXPECT_EQ(warnings, Warnings{});
  ASSERT_EQ(project.scene.cameras.size(), 2u);
  const Camera& fonte = project.scene.cameras[0];
  EXPECT_EQ(fonte.name, "Fonte");
  EXPECT_EQ(fonte.position, (Vec3{7.42f, 18.61f, -38.62f}));
  EXPECT_EQ(fonte.view, (Vec3{0.31f, -0.36f, 0.87f}));
  EXPECT_EQ(fonte.fov, 50);
  EXPECT_EQ(fonte.near, 0.3f);
  EXPECT_EQ(fonte.far, 1000);
  EXPECT_EQ(project.scene.background.color, (Vec3{0.1f, 0.2f, 0.3f}));
  ASSERT_EQ(project.scene.lights.size(), 2u);
  EXPECT_EQ(project.scene.lights[0].kind, Light::Kind::directional);
  EXPECT_EQ(project.scene.lights[0].direction, (Vec3{0, -1, 0})) << "of unit length";
  EXPECT_EQ(project.scene.lights[0].color, (Vec3{0.9f, 0.8f, 0.7f}));
  EXPECT_EQ(project.scene.lights[1].kind, Light::Kind::point);
  EXPECT_EQ(project.scene.lights[1].position, (Vec3{1, 2, 3}));
  EXPECT_EQ(project.scene.ambient, (Vec3{0.5f, 0.75f, 0.5f})) << "the sum of the lights'";

  ASSERT_EQ(project.pipelines.size(), 2u);
  EXPECT_EQ(project.default_pipeline, 1u);
  const Settings& plain = project.pipelines[0].settings;
  EXPECT_EQ(plain.width, 640);
  EXPECT_EQ(plain.height, 480);
  EXPECT_FALSE(plain.effects.shadows || plain.effects.reflection || plain.effects.refraction ||
               plain.effects.ambient_occlusion);
  EXPECT_EQ(project.pipelines[0].camera, "Fonte") << "the first";

  const Pipeline& full = project.pipelines[1];
  EXPECT_EQ(full.camera, "Other");
  EXPECT_TRUE(full.settings.effects.shadows && full.settings.effects.reflection &&
              full.settings.effects.ambient_occlusion);
  EXPECT_FALSE(full.settings.effects.refraction);
  EXPECT_EQ(full.settings.max_depth, 3);
  EXPECT_EQ(full.settings.fresnel, Fresnel::schlick);
  EXPECT_EQ(full.settings.ao_samples, 25);
  EXPECT_EQ(full.settings.ao_distance, 2);
  EXPECT_EQ(full.settings.ao_exponent, 1.6f);
  EXPECT_EQ(full.settings.seed, 7u);
  EXPECT_EQ(full.settings.primary, Primary::trace);
  EXPECT_EQ(full.settings.terminator, Terminator::smooth);
  EXPECT_EQ(project.pipelines[0].settings.primary, Primary::raster);
  EXPECT_EQ(project.pipelines[0].settings.terminator, Terminator::facet);
  EXPECT_EQ(full.settings.compositing, Compositing::report);
  ASSERT_EQ(full.maps.size(), 1u);
  EXPECT_EQ(full.maps[0].from, "Vidro");
  EXPECT_EQ(full.maps[0].optics, Optics::solid);
  EXPECT_EQ(full.maps[0].index, 1.3f);
  EXPECT_EQ(full.maps[0].tint, (Vec3{0.9f, 0.8f, 0.7f}));
}

TEST(Project, GivesNamedMaterialsTheirGlass) {
  const Folder folder;
  const std::string path = folder.write(
      "p.xml",
      project_with_passes("<pass class='trace'><materialMaps><map fromMaterial='Vidro' tint='0.9'/>\n"
                          "<map fromMaterial='Nothing'/></materialMaps></pass>"));
  Warnings warnings;
  const Project project = load_project(path, warnings);
  ASSERT_EQ(project.scene.mesh.triangles.size(), 1u);
  bool found = false;
  for (const Material& material : project.scene.materials) {
    if (material.name != "Vidro") continue;
    found = true;
    EXPECT_EQ(material.optics, Optics::thin);
    EXPECT_EQ(material.index, 1.1f);
    EXPECT_EQ(material.transmission, (Vec3{0.9f, 0.9f, 0.9f}));
  }
  EXPECT_TRUE(found);
  EXPECT_EQ(warnings, Warnings{path + ":3: no material is called 'Nothing'"});
}

TEST(Project, AmbientLightIsTheDefaultWhenNoLightGivesOne) {
  const Folder folder;
  const std::string sun = "<lights><light><direction x='0' y='-1' z='0'/></light></lights>";
  EXPECT_EQ(folder.read(project_with_assets(sun)).scene.ambient, Scene{}.ambient);
}

TEST(Project, WarnsOfWhatItDoesNotKnow) {
  const Folder folder;
  Warnings warnings;
  const std::string text =
      project_with_assets("<cameras><camera name='c' lens='wide'><fisheye/>\n</camera></cameras>\n<sounds/>");
  folder.read(text, &warnings);
  const std::string file = folder / "p.xml";
  ASSERT_EQ(warnings.size(), 3u);
  EXPECT_EQ(warnings[0], file + ":2: unknown attribute 'lens' of <camera>");
  EXPECT_EQ(warnings[1], file + ":2: unknown element <fisheye> in <camera>");
  EXPECT_EQ(warnings[2], file + ":4: unknown element <sounds> in <assets>");
}

TEST(Project, KeepsAFewWarningsOfMany) {
  const Folder folder;
  std::string sounds;
  for (int i = 0; i < 1000; ++i) sounds += "<sound/>";
  Warnings warnings;
  folder.read(project_with_assets(sounds), &warnings);
  EXPECT_GT(warnings.size(), 1u);
  EXPECT_LT(warnings.size(), 50u);
}

TEST(Project, RefusesNumbersOutOfRange) {
  const Folder folder;
  const auto camera = [&](const std::string& inside) {
    return folder.complaint(
        project_with_assets("<cameras><camera name='c'>\n" + inside + "</camera></cameras>"));
  };
  EXPECT_EQ(camera("<perspective fov='60' near='1' far='2'/>"), "");
  EXPECT_EQ(camera("<perspective fov='180'/>"), "p.xml:3: fov=\"180\" is not a number from 0.01 to 179");
  EXPECT_EQ(camera("<perspective near='0'/>").substr(0, 8), "p.xml:3:");
  EXPECT_EQ(camera("<perspective near='nan'/>").substr(0, 8), "p.xml:3:");
  EXPECT_EQ(camera("<perspective far='inf'/>").substr(0, 8), "p.xml:3:");
  EXPECT_EQ(camera("<perspective far='1e40'/>").substr(0, 8), "p.xml:3:");
  EXPECT_EQ(camera("<perspective far='12abc'/>").substr(0, 8), "p.xml:3:");
  EXPECT_EQ(camera("<perspective near='2' far='1'/>"), "p.xml:2: camera 'c': near is not less than far");
  EXPECT_EQ(camera("<view x='0' y='0' z='0'/>"), "p.xml:2: camera 'c': the view direction is zero");
  EXPECT_EQ(camera("<view x='0' y='3' z='0'/>"), "p.xml:2: camera 'c': the up direction is along the view");
  EXPECT_EQ(camera("<position x='1' y='2'/>"), "p.xml:3: <position> needs three components");
  EXPECT_EQ(camera("<position>1 2</position>").substr(0, 8), "p.xml:3:");
  EXPECT_EQ(camera("<position>1 2 3 4</position>").substr(0, 8), "p.xml:3:");
  EXPECT_EQ(camera("<position/>").substr(0, 8), "p.xml:3:");

  const std::string rest = std::string(">\n<assets>") + kScenes + "</assets>" + kPipelines + "</project>";
  EXPECT_EQ(folder.complaint("<project width='16384'" + rest), "");
  EXPECT_EQ(folder.complaint("<project width='0'" + rest),
            "p.xml:1: width=\"0\" is not a whole number from 1 to 16384");
  EXPECT_NE(folder.complaint("<project width='16385'" + rest), "");
  EXPECT_NE(folder.complaint("<project width='-5'" + rest), "");
  EXPECT_NE(folder.complaint("<project width='1e3'" + rest), "");

  const auto trace = [&](const std::string& inside) {
    return folder.complaint(project_with_passes("<pass class='trace'>" + inside + "</pass>"));
  };
  EXPECT_EQ(trace("<ambientOcclusion samples='100'/>"), "");
  EXPECT_EQ(trace("<ambientOcclusion samples='10'/>"),
            "p.xml:2: samples='10' is not a square number from 1 to 1024");
  EXPECT_NE(trace("<ambientOcclusion samples='0'/>"), "");
  EXPECT_NE(trace("<ambientOcclusion samples='1089'/>"), "");
  EXPECT_NE(trace("<ambientOcclusion distance='0'/>"), "");
  EXPECT_NE(trace("<ambientOcclusion exponent='-1'/>"), "");
  EXPECT_NE(trace("<reflection maxDepth='101'/>"), "");
  EXPECT_NE(trace("<reflection fresnel='magic'/>"), "");
  EXPECT_NE(trace("<reflection maxDepth='3'/><refraction maxDepth='4'/>"), "") << "they share the limit";
  EXPECT_EQ(trace("<reflection maxDepth='3'/><refraction maxDepth='3'/>"), "");
  EXPECT_NE(trace("<materialMaps><map fromMaterial='a' kind='jelly'/></materialMaps>"), "");
  EXPECT_NE(trace("<materialMaps><map fromMaterial='a' tint='2'/></materialMaps>"), "");
  EXPECT_NE(trace("<materialMaps><map index='1.5'/></materialMaps>"), "");
}

TEST(Project, RefusesNamesOfNothing) {
  const Folder folder;
  EXPECT_EQ(folder.complaint(project_with_passes("<pass class='blur'/>")),
            "p.xml:2: class=\"blur\" is not one of raster, trace, combine");
  EXPECT_EQ(folder.complaint(project_with_passes("<pass class='trace'><camera name='x'/></pass>")),
            "p.xml:2: there is no camera 'x'");
  EXPECT_NE(
      folder.complaint(project_with_passes("<pass class='trace'><lights><light name='x'/></lights></pass>")),
      "");
  EXPECT_NE(folder.complaint(project_with_assets("<cameras><camera name='c'/><camera name='c'/></cameras>")),
            "");
  EXPECT_NE(folder.complaint(project_with_assets("<cameras><camera/></cameras>")), "");
  EXPECT_NE(folder.complaint(project_with_assets("<lights><light/></lights>")), "");

  const auto pipelines = [&](const std::string& inside) {
    return folder.complaint("<project><assets>" + std::string(kScenes) + kCamera + "</assets>\n<pipelines>" +
                            inside + "</pipelines></project>");
  };
  EXPECT_EQ(pipelines("<pipeline name='p'><pass class='trace'/></pipeline>"),
            "p.xml:2: pipeline 'p' has no raster pass");
  EXPECT_EQ(pipelines(""), "p.xml:1: the project has no pipeline");
  EXPECT_NE(pipelines("<pipeline><pass class='raster'/></pipeline>"), "");
  EXPECT_NE(pipelines("<pipeline name='p' defaultCamera='x'><pass class='raster'/></pipeline>"), "");
  const std::string one = "<pipeline name='p' default='1'><pass class='raster'/></pipeline>";
  EXPECT_EQ(pipelines(one), "");
  EXPECT_EQ(pipelines(one + one), "p.xml:2: there is another pipeline 'p'");
  EXPECT_NE(pipelines(one + "<pipeline name='q' default='1'><pass class='raster'/></pipeline>"), "");
  EXPECT_EQ(folder.complaint("<house/>"), "p.xml:1: expected <project>, found <house>");
}

TEST(Project, SaysWhichFileIsMissing) {
  const Folder folder;
  const std::string text =
      "<project><assets><scenes><scene name='s'>\n<file name='b.obj'/></scene></scenes></assets>" +
      std::string(kPipelines) + "</project>";
  EXPECT_EQ(folder.complaint(text), "p.xml:2: " + (folder / "b.obj") + ": no such file");
  EXPECT_EQ(folder.complaint("<project><assets/>" + std::string(kPipelines) + "</project>"),
            "p.xml:1: the project names no scene file");
  Warnings warnings;
  folder.read(project_with_assets("<materialLibs><mlib name='b.mtl'/></materialLibs>"), &warnings);
  EXPECT_EQ(warnings, Warnings{(folder / "p.xml") + ":2: " + (folder / "b.mtl") + ": no such file"});
}

TEST(Project, ReadsLensesShuttersAndMotion) {
  const Folder folder;
  Warnings warnings;
  const Project project = folder.read(project_with_assets(R"(<cameras><camera name='c'>
<motion><key time='-1'/><key time='0.5'><position>1 2 3</position></key>
<key time='2'><view>1 0 0</view><up>0 0 1</up></key></motion>
<position>0 0 5</position><view>0 0 -2</view>
<lens aperture='0.25' focus='4'/><shutter open='0.5' close='0.75'/>
</camera></cameras>)"),
                                      &warnings);
  EXPECT_EQ(warnings, Warnings{});
  const Camera& c = project.scene.cameras.at(0);
  EXPECT_EQ(c.aperture, 0.25f);
  EXPECT_EQ(c.focus, 4);
  EXPECT_EQ(c.shutter_open, 0.5f);
  EXPECT_EQ(c.shutter_close, 0.75f);
  ASSERT_EQ(c.motion.size(), 3u);
  EXPECT_EQ(c.motion[0].position, (Vec3{0, 0, 5})) << "the first key starts from the camera";
  EXPECT_EQ(c.motion[0].view, (Vec3{0, 0, -2}));
  EXPECT_EQ(c.motion[1].position, (Vec3{1, 2, 3}));
  EXPECT_EQ(c.motion[1].view, (Vec3{0, 0, -2})) << "what a key leaves out is as before";
  EXPECT_EQ(c.motion[2].position, (Vec3{1, 2, 3}));
  EXPECT_EQ(c.motion[2].up, (Vec3{0, 0, 1}));
  EXPECT_EQ(c.motion[2].time, 2);
}

TEST(Project, RefusesLensesAndMotionThatMakeNoSense) {
  const Folder folder;
  const auto camera = [&](const std::string& inside) {
    return folder.complaint(
        project_with_assets("<cameras><camera name='c'>\n" + inside + "</camera></cameras>"));
  };
  EXPECT_NE(camera("<lens aperture='-1'/>"), "");
  EXPECT_NE(camera("<lens focus='0'/>"), "");
  EXPECT_EQ(camera("<shutter open='1' close='0.5'/>"), "p.xml:3: the shutter closes before it opens");
  EXPECT_EQ(camera("<motion><key/></motion>"), "p.xml:3: this key has no time");
  EXPECT_EQ(camera("<motion><key time='1'/><key time='1'/></motion>"),
            "p.xml:3: this key is not later than the one before");
  EXPECT_NE(camera("<motion><key time='1'><view>0 1 0</view></key></motion>"), "");
}

TEST(Project, ARasterPassSaysHowManySamples) {
  const Folder folder;
  const auto pipelines = [&](const std::string& attributes) {
    return "<project><assets>" + std::string(kScenes) + kCamera +
           "</assets>\n<pipelines><pipeline name='p'><pass class='raster' " + attributes +
           "/></pipeline></pipelines></project>";
  };
  const Project project = folder.read(pipelines("samples='16' filter='tent'"));
  EXPECT_EQ(project.pipelines[0].settings.samples, 16);
  EXPECT_EQ(project.pipelines[0].settings.filter, Filter::tent);
  EXPECT_NE(folder.complaint(pipelines("samples='0'")), "");
  EXPECT_NE(folder.complaint(pipelines("samples='65537'")), "");
  EXPECT_EQ(folder.complaint(pipelines("filter='sharp'")),
            "p.xml:2: filter='sharp' is not one of box, tent, mitchell");
}

}  // namespace
}  // namespace vitral
