// Reads the project file: scenes, cameras, lights and the pipelines that render them.
//
// The format. Names of elements and attributes are compared without regard to case; what is not
// listed here is a warning. A NUMBER is finite. A VECTOR is written x="1" y="2" z="3", value="1 2 3"
// or as text, with spaces or commas; a COLOR the same with r, g, b, or as one number for grey. A
// plain name or file is written name="...", file="..." or as text. Paths are relative to the project.
//
//   <project width="1024" height="1024">                 size of the picture, 1..16384
//     <assets>
//       <scenes><scene name="..."><file name="a.obj"/>   any number of .obj and .ply; all are loaded
//         <model name="tree"><file name="tree.obj"/></model>   loaded, but placed only by instances:
//         <instance model="tree" material="...">TRANSFORMS</instance>   with a material for all of it, or its
//         <instances model="tree" file="forest.txt"/>   own; a line for each: x y z [scale [degrees about y]]
//         <sphere center="0 0 0" radius="1" material="...">TRANSFORMS</sphere>   exact shapes; what is left
//         <box min="-1 -1 -1" max="1 1 1"/>                                      out is as written here
//         <cylinder from="0 -1 0" to="0 1 0" radius="1"/>
//         <disk center="0 0 0" normal="0 1 0" radius="1"/>
//         <plane point="0 0 0" normal="0 1 0"/>   without end
//       <viewports><viewport name="...">               what rays see that meet nothing:
//         <bgcolor COLOR/>                               one colour, or
//         <background kind="constant|gradient|panorama" color="0.6 0.75 0.95" zenith="..." file="..."
//           scale="1"/>       gradient: from color at the horizon to zenith; panorama: a latitude-longitude
//                             picture (PNG, JPEG, TGA, BMP) with -z in its middle, times scale. Without a
//                             kind, a file makes it a panorama and a zenith a gradient
//       <cameras><camera name="...">
//         <perspective fov="60" near="0.1" far="1000"/>  fov vertical, in degrees
//         <position VECTOR/> <view VECTOR/> <up VECTOR/>  view: the way it looks; up: 0 1 0 if left out
//         <lens aperture="0.05" focus="4"/>    diameter, and the depth that is sharp; without it a pinhole
//         <shutter open="0" close="0.5"/>      times; the picture is the mean of what is seen between them
//         <motion><key time="0"> <position/> <view/> <up/>   where it is at some times, in their order; what
//                                              a key leaves out is as in the key before
//       <lights><light name="..." type="directional|point|spot|rectangle|sphere|sun" samples="16">
//         <direction VECTOR/> <position VECTOR/>   without a type: with a direction the light is
//         <color COLOR/> <ambient COLOR/>          directional, with a position only it is a point;
//                                                  ambient adds to the scene
//         <cone inner="30" outer="40"/>            spot: degrees from its direction, 0..180; between them
//                                                  the intensity fades, outside of both it is 0
//         <size width="1" height="1"/>             rectangle: it shines to the side of its direction; width
//         <side VECTOR/>                           runs along the side, or else horizontally
//         <radius>0.5</radius>                     sphere
//         <diameter>0.53</diameter>                sun: the disk, in degrees from edge to edge
//       <materials><material name="..." kind="opaque|mirror|polished|solid|thin|dissolve"
//         diffuse="0.8" specular="0" transmission="1" reflectivity="0" emission="0" absorption="0"
//         shininess="0" index="1.5" opacity="1">   what is given goes before what the libraries say of the
//                                                  materials of this name; no library's: a new material. The
//                                                  figures are those of Material in scene.h; a colour may
//                                                  be an element, too: <emission r="1" g="0.5" b="0"/>
//         <texture file="..."/> <cutout file="..."/>   map_Kd and map_d
//         <checker first="0.8" second="0.1" size="1"/>              a pattern, instead of diffuse: one of
//         <brick first="..." second="..." size="1" height="0.3" mortar="0.05"/>  these (Pattern in scene.h)
//         <marble first="..." second="..." size="1" turbulence="0.5"/>
//       <materialLibs><mlib name="a.mtl"/>         must exist; an OBJ loads its own by itself
//     <pipelines>
//       <pipeline name="..." default="true" defaultCamera="...">   one or more
//         <pass class="raster" name="..."          the targets pos, norm, color (other name: default),
//               primary="raster|trace"             found by the rasterizer, or by the tracer along such rays
//               samples="1"                        per pixel, 1..65536: over the pixel, lens and shutter
//               filter="box|tent|mitchell"/>       over 1, 2 and 4 pixels
//         <pass class="trace" name="...">          (other name: optix); empty: a pass-through
//           <shadows samples="16"                  for all lights with a size; or else their own
//                    terminator="facet|smooth"/>   where their rays leave meshes with normals: the triangle,
//                                                  or the smooth surface that it stands for
//           <reflection maxDepth="5" minImportance="0.005" fresnel="exact|schlick|report"/>
//           <refraction maxDepth="5" minImportance="0.005" fresnel="exact|schlick|report"/>
//           <ambientOcclusion samples="16" distance="0.5" exponent="1"/>   samples: a square number
//         <pass class="combine" name="..."/>       (other name: quad)
//
// TRANSFORMS are any number of <translate VECTOR/>, <rotate axis="0 1 0" degrees="30"/>, <scale VECTOR/> or
// <scale>2</scale> and <matrix>, three rows of four numbers, each applied after the ones before it, about the
// origin of the world. Besides, <motion> holds in order of time <key time="0">: <translate/> and <rotate/>,
// which go after them, the rotation about where they put the object's origin; between keys what moves is
// displaced and turned evenly. The materials of objects have their names from the meshes' own libraries, from
// a materialLib, or from <materials>.
//
// Rectangle, sphere and sun cast soft shadows: a point sends `samples` rays to each, 1..1024. They are not
// seen themselves; a surface that shows one may stand where it is. The color is the irradiance at normal
// incidence, of lights with a position at distance 1: what a point light there would have.
//
// reflection and refraction share their figures: what both give must agree; a minImportance below
// 1/4096 counts as 1/4096. Any pass may have
// compositing="physical|report" and seed="1", and may name the <camera>, <lights>, <scenes>,
// <viewport> and <renderTarget(s)> it uses: the camera serves where the pipeline names none, the
// others must exist, and everything of the assets takes part in every pass. Any pass may also hold
//
//   <materialMaps><map fromMaterial="Vidro" kind="thin|solid|mirror" index="1.1" tint="0.9"/>
//
// which gives the material of that name, in this pipeline, its glass: the index of refraction and
// the tint (COLOR) of one sheet, or of a mirror, and where they stand there reflectivity, emission and
// absorption; toMaterial and toLibrary may be there and say nothing.
#pragma once
#include "vitral/error.h"
#include "vitral/render.h"
#include "vitral/scene.h"

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace vitral {

// What a <map> makes of the materials called `from`.
struct MaterialMap {
  std::string from;
  Optics optics = Optics::thin;  // thin, solid or mirror
  float index = 1.1f;            // of refraction, 1..10
  Vec3 tint{1, 1, 1};
  std::optional<Vec3> reflectivity, emission, absorption;
  size_t line = 0;
};

// What a project says of the materials of a name.
struct MaterialFigures {
  std::string name;
  std::optional<Vec3> diffuse, specular, transmission, reflectivity, emission, absorption;
  std::optional<float> shininess, index, opacity;
  std::optional<Optics> optics;
  std::optional<Pattern> pattern;
  std::string texture, cut_out;  // files; empty: as they are
  size_t line = 0;
};

struct Pipeline {
  std::string name;
  std::string camera;  // name of its default camera; empty when the project has none
  Settings settings;   // effects and their figures; width and height of the project
  std::vector<MaterialMap> maps;
};

struct MeshFile {
  std::string path;  // as it can be opened
  size_t line = 0;   // where the project names it
};

// A mesh that is loaded, but stands nowhere unless it is placed.
struct ModelFile {
  std::string name;
  std::string path;
  size_t line = 0;
};

// Objects of one element. Their materials are not known before the meshes are loaded.
struct ObjectGroup {
  std::string model, material;  // names; empty: none given
  size_t line = 0;
  std::vector<Object> objects;
};

struct Project {
  std::string file;
  std::vector<MeshFile> meshes;
  std::vector<ModelFile> models;
  std::vector<ObjectGroup> objects;
  size_t object_count = 0;
  std::vector<std::string> libraries;  // of materials, as they can be opened
  std::vector<MaterialFigures> materials;
  std::string panorama;  // as it can be opened; empty: none
  Scene scene;
  std::vector<Pipeline> pipelines;  // at least one
  size_t default_pipeline = 0;
};

// Reads the project file alone, so that what it asks for can be checked before its meshes are
// loaded. Throws InputError with file:line; unknown elements and attributes are warnings.
Project read_project(const std::string& path, Warnings& warnings);

// Loads the meshes into project.scene and applies the material maps of one pipeline.
void load_assets(Project& project, const Pipeline& pipeline, Warnings& warnings);

// Both, for the default pipeline.
Project load_project(const std::string& path, Warnings& warnings);

// Says in a few words what is wrong with a camera; empty when nothing is.
std::string camera_fault(const Camera& camera);

}  // namespace vitral
