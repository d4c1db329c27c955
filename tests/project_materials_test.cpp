// Materials and backgrounds of project files.
#include "io/project.h"
#include "vitral/render.h"

#include "scratch.h"

#include <gtest/gtest.h>

#include <cstring>
#include <string>

namespace vitral {
namespace {

// A picture of one pixel as an uncompressed TGA.
const std::string kPicture =
    std::string("\0\0\2\0\0\0\0\0\0\0\0\0\1\0\1\0\x18\0", 18) + std::string("\x40\x80\xc0", 3);

// A folder with a triangle of material a beside the project.
struct Folder : test::ScratchFolder {
  Folder() {
    write("a.obj", "mtllib a.mtl\nusemtl a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    write("a.mtl", "newmtl a\nKd 1 0 0\nKs 0.5 0.5 0.5\nNs 7\n");
    write("sky.tga", kPicture);
  }
  // A project with these assets; `passes` stand in its pipeline.
  Project load(const std::string& assets, const std::string& passes = "") {
    warnings.clear();
    return load_project(write("p.xml",
                              "<project><assets><scenes><scene name='s'><file name='a.obj'/></scene>"
                              "</scenes>\n" +
                                  assets +
                                  "</assets><pipelines><pipeline name='p'>"
                                  "<pass class='raster'>" +
                                  passes + "</pass></pipeline></pipelines></project>"),
                        warnings);
  }
  // Without the folder: "p.xml:2: reason".
  std::string complaint(const std::string& assets, const std::string& passes = "") {
    const std::string text = test::error_of<InputError>([&] { load(assets, passes); });
    return text.empty() ? text : text.substr(path().string().size() + 1);
  }
  Warnings warnings;
};

const Material& find(const Scene& scene, const std::string& name) {
  for (const Material& m : scene.materials) {
    if (m.name == name) return m;
  }
  throw std::runtime_error("no material " + name);
}

TEST(ProjectMaterials, OverrideWhatTheyGive) {
  Folder folder;
  const Project project = folder.load(
      "<materials><material name='a' kind='polished' reflectivity='0.1 0.2 0.3' absorption='4'>"
      "<emission r='5' g='6' b='7'/><texture file='sky.tga'/></material></materials>");
  EXPECT_EQ(folder.warnings, Warnings{});
  ASSERT_EQ(project.scene.materials.size(), 1u);
  const Material& m = project.scene.materials[0];
  EXPECT_EQ(m.optics, Optics::polished);
  EXPECT_EQ(m.reflectivity, (Vec3{0.1f, 0.2f, 0.3f}));
  EXPECT_EQ(m.absorption, (Vec3{4, 4, 4}));
  EXPECT_EQ(m.emission, (Vec3{5, 6, 7}));
  EXPECT_EQ(m.diffuse_map, 0);
  EXPECT_EQ(project.scene.textures.size(), 1u);
  EXPECT_EQ(m.diffuse, (Vec3{1, 0, 0})) << "not given, as the library has it";
  EXPECT_EQ(m.shininess, 7);
}

TEST(ProjectMaterials, OrAreNew) {
  Folder folder;
  const Project project = folder.load(
      "<materials><material name='gold' diffuse='0.8 0.6 0.2' specular='0.5' shininess='40' index='2' "
      "transmission='0.25'/>\n<material name='veil' opacity='0.5'/><material name='gone' opacity='0.5' "
      "kind='opaque'><cutout file='sky.tga'/></material></materials>");
  EXPECT_EQ(folder.warnings, Warnings{});
  const Material& gold = find(project.scene, "gold");
  EXPECT_EQ(gold.diffuse, (Vec3{0.8f, 0.6f, 0.2f}));
  EXPECT_EQ(gold.specular, (Vec3{0.5f, 0.5f, 0.5f}));
  EXPECT_EQ(gold.transmission, (Vec3{0.25f, 0.25f, 0.25f}));
  EXPECT_EQ(gold.shininess, 40);
  EXPECT_EQ(gold.index, 2);
  EXPECT_EQ(gold.optics, Optics::opaque);
  EXPECT_EQ(find(project.scene, "veil").optics, Optics::dissolve);
  EXPECT_EQ(find(project.scene, "gone").optics, Optics::opaque);
  EXPECT_EQ(find(project.scene, "gone").opacity_map, 0);
}

TEST(ProjectMaterials, Patterns) {
  Folder folder;
  const Project project = folder.load(
      "<materials><material name='c'><checker first='1 0 0' second='0.5' size='2'/></material>"
      "<material name='b'><brick size='3' height='1.5' mortar='0.25'/></material>"
      "<material name='m'><marble turbulence='3'/></material></materials>");
  EXPECT_EQ(folder.warnings, Warnings{});
  const Pattern &c = find(project.scene, "c").pattern, &b = find(project.scene, "b").pattern,
                &m = find(project.scene, "m").pattern;
  EXPECT_EQ(c.kind, Pattern::Kind::checker);
  EXPECT_EQ(c.first, (Vec3{1, 0, 0}));
  EXPECT_EQ(c.second, (Vec3{0.5f, 0.5f, 0.5f}));
  EXPECT_EQ(c.size, 2);
  EXPECT_EQ(b.kind, Pattern::Kind::brick);
  EXPECT_EQ(b.size, 3);
  EXPECT_EQ(b.height, 1.5f);
  EXPECT_EQ(b.mortar, 0.25f);
  EXPECT_EQ(m.kind, Pattern::Kind::marble);
  EXPECT_EQ(m.turbulence, 3);
}

TEST(ProjectMaterials, MapsGiveTheSameFigures) {
  Folder folder;
  const Project project = folder.load("<materials><material name='a' emission='1'/></materials>",
                                      "<materialMaps><map fromMaterial='a' kind='solid' reflectivity='0.5' "
                                      "absorption='1 2 3'/></materialMaps>");
  EXPECT_EQ(folder.warnings, Warnings{});
  const Material& m = project.scene.materials[0];
  EXPECT_EQ(m.optics, Optics::solid);
  EXPECT_EQ(m.reflectivity, (Vec3{0.5f, 0.5f, 0.5f}));
  EXPECT_EQ(m.absorption, (Vec3{1, 2, 3}));
  EXPECT_EQ(m.emission, (Vec3{1, 1, 1})) << "a map that does not give it leaves it";
}

TEST(ProjectMaterials, SayWhatIsWrong) {
  Folder folder;
  const auto material = [&](const std::string& rest) {
    return folder.complaint("<materials>\n<material name='x'" + rest + "</materials>");
  };
  EXPECT_EQ(material(" reflectivity='1.5'/>"),
            "p.xml:3: reflectivity='1.5' is not one or three numbers from 0 to 1");
  EXPECT_EQ(material(" emission='-1'/>"),
            "p.xml:3: emission='-1' is not one or three numbers from 0 to 1000000");
  EXPECT_EQ(material(" kind='wood'/>"),
            "p.xml:3: kind='wood' is not one of opaque, mirror, polished, solid, thin, dissolve");
  EXPECT_EQ(material(">\n<texture file='no.png'/></material>").substr(0, 8), "p.xml:4:");
  EXPECT_EQ(material("><checker/>\n<brick/></material>"), "p.xml:4: there is another pattern");
  EXPECT_EQ(material(">\n<brick height='0.1' mortar='0.1'/></material>"),
            "p.xml:4: the mortar leaves no room for bricks");
  EXPECT_EQ(material("/>\n<material name='x'/>"), "p.xml:4: there is another material 'x'");
  EXPECT_EQ(folder.complaint("<materials>\n<material/></materials>"), "p.xml:3: this material has no name");
  for (const char* bad :
       {" index='0.5'/>", " opacity='2'/>", " shininess='-1'/>", "><checker size='0'/></material>",
        "><marble turbulence='-1'/></material>", "><emission r='1' g='1' b='x'/></material>"})
    EXPECT_EQ(material(bad).substr(0, 8), "p.xml:3:") << bad;
  folder.load("<materials><material name='a' colour='1'><wood/></material></materials>");
  EXPECT_EQ(folder.warnings.size(), 2u);
}

TEST(ProjectBackground, OfEachKind) {
  Folder folder;
  const auto background = [&](const std::string& rest) {
    const Project p = folder.load("<viewports><viewport name='v'>" + rest + "</viewport></viewports>");
    EXPECT_EQ(folder.warnings, Warnings{});
    return p.scene.background;
  };
  EXPECT_EQ(background("<bgcolor r='1' g='0' b='0'/>").kind, Background::Kind::constant);
  EXPECT_EQ(background("<background color='0.25'/>").color, (Vec3{0.25f, 0.25f, 0.25f}));
  const Background gradient = background("<bgcolor r='1' g='0' b='0'/><background zenith='0 0 2'/>");
  EXPECT_EQ(gradient.kind, Background::Kind::gradient);
  EXPECT_EQ(gradient.color, (Vec3{1, 0, 0}));
  EXPECT_EQ(gradient.zenith, (Vec3{0, 0, 2}));
  const Background panorama = background("<background file='sky.tga' scale='3'/>");
  EXPECT_EQ(panorama.kind, Background::Kind::panorama);
  EXPECT_EQ(panorama.panorama, 0);
  EXPECT_EQ(panorama.scale, 3);
  EXPECT_EQ(background("<background kind='constant' zenith='1'/>").kind, Background::Kind::constant);
}

TEST(ProjectBackground, SaysWhatIsWrong) {
  Folder folder;
  folder.write("broken.png", "no picture");
  const auto complaint = [&](const std::string& rest) {
    return folder.complaint("<viewports><viewport name='v'>\n<background " + rest +
                            "/></viewport></viewports>");
  };
  EXPECT_EQ(complaint("kind='sky'"), "p.xml:3: kind='sky' is not one of constant, gradient, panorama");
  EXPECT_EQ(complaint("kind='panorama'"), "p.xml:3: a panorama needs a file");
  EXPECT_EQ(complaint("file='none.png'").substr(0, 8), "p.xml:3:");
  EXPECT_EQ(complaint("color='-1'").substr(0, 8), "p.xml:3:");
  EXPECT_EQ(complaint("file='broken.png'").substr(0, 11), "broken.png:");
}

// Features that depend on the pixel alone are the same in a crop whose blocks and tiles are not whole.
TEST(ProjectMaterials, ACropIsThePartOfTheWhole) {
  for (const char* name : {"absorption", "marble", "panorama", "reflectivity"}) {
    Warnings warnings;
    Project project = load_project("scenes/" + std::string(name) + ".xml", warnings);
    Settings s = project.pipelines[0].settings;
    Control control;
    for (const Primary primary : {Primary::raster, Primary::trace}) {
      s.primary = primary;
      s.crop = {};
      const Frame whole = render(project.scene, project.scene.cameras[0], s, control);
      s.crop = {29, 13, 37, 45};
      const Frame part = render(project.scene, project.scene.cameras[0], s, control);
      for (int y = 0; y < 45; ++y) {
        EXPECT_EQ(std::memcmp(part.radiance.row(y), whole.radiance.row(y + 13) + 29, 37 * sizeof(Vec3)), 0)
            << name << " row " << y;
      }
    }
  }
}

}  // namespace
}  // namespace vitral
