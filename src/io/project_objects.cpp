#include "io/project_objects.h"

#include "io/file.h"
#include "io/mesh_file.h"
#include "io/mtl.h"
#include "io/placement.h"
#include "io/text.h"
#include "io/textures.h"

#include <algorithm>
#include <filesystem>
#include <utility>

namespace vitral {
namespace {

constexpr size_t kMostObjects = 4000000;
constexpr uint64_t kMostPlacementBytes = uint64_t{256} << 20;

Vec3 vector_attribute(const Source& source, const XmlElement& element, const char* name, Vec3 otherwise) {
  const std::string* text = find_attribute(element, name);
  if (!text) return otherwise;
  if (const std::optional<Vec3> vector = parse_vector(*text, kCoordinates)) return *vector;
  fail(source, element, std::string(name) + "=\"" + printable(*text) + "\" is not three numbers");
}

void read_model(Reading& reading, const XmlElement& element) {
  const Source& source = reading.source;
  warn_unknown_attributes(source, element, {"name"});
  ModelFile model;
  model.name = attribute_or(element, "name", "");
  model.line = element.line;
  if (model.name.empty()) fail(source, element, "this model has no name");
  for (const ModelFile& other : reading.project.models) {
    if (other.name == model.name) fail(source, element, "there is another model " + named(model.name));
  }
  each(reading, element, "file", [&](const XmlElement& file) {
    if (!model.path.empty()) fail(source, file, "a model has one file");
    model.path = (reading.folder / name_of(source, file)).lexically_normal().string();
    std::error_code code;
    if (!std::filesystem::exists(model.path, code)) fail(source, file, model.path + ": no such file");
  });
  if (model.path.empty()) fail(source, element, "this model names no file");
  if (reading.project.models.size() == kMostThings)
    fail(source, element, "more than " + std::to_string(kMostThings) + " of <model>");
  reading.project.models.push_back(model);
}

// The transforms and the motion among an element's children, after what its attributes say.
void read_placement(const Source& source, const XmlElement& element, Object& object) {
  for (const XmlElement& child : element.children) {
    if (same_name(child.name, "motion")) {
      object.motion = read_motion(source, child);
    } else if (!apply_transform(source, child, object.placement)) {
      warn_unknown_child(source, element, child);
    }
  }
  check_placement(source, element, object.placement);
}

ObjectGroup group_of(const XmlElement& element) {
  ObjectGroup group;
  group.model = attribute_or(element, "model", "");
  group.material = attribute_or(element, "material", "");
  group.line = element.line;
  return group;
}

void add_group(Reading& reading, const XmlElement& element, ObjectGroup group) {
  reading.project.object_count += group.objects.size();
  if (reading.project.object_count > kMostObjects)
    fail(reading.source, element, "more than " + std::to_string(kMostObjects) + " objects");
  reading.project.objects.push_back(std::move(group));
}

void read_instance(Reading& reading, const XmlElement& element) {
  warn_unknown_attributes(reading.source, element, {"model", "material", "name"});
  ObjectGroup group = group_of(element);
  group.objects.resize(1);
  read_placement(reading.source, element, group.objects[0]);
  add_group(reading, element, std::move(group));
}

// One placement of a line: x y z [scale [degrees about y]].
bool read_line(Cursor& c, Affine& placement) {
  float numbers[5] = {0, 0, 0, 1, 0};
  int count = 0;
  for (;; ++count) {
    skip_blanks(c);
    if (at_line_end(c)) break;
    if (count == 5 || !read_float(c, numbers[count])) return false;
    const float n = numbers[count];
    if (!(n >= kCoordinates.least && n <= kCoordinates.most)) return false;
  }
  if (count < 3) return false;
  const float s = numbers[3];
  Affine scale{{s, 0, 0}, {0, s, 0}, {0, 0, s}, {0, 0, 0}};
  placement = count == 5 ? rotation({0, 1, 0}, numbers[4]) * scale : scale;
  placement.origin = {numbers[0], numbers[1], numbers[2]};
  return can_be_undone(placement);
}

void read_instances(Reading& reading, const XmlElement& element) {
  warn_unknown_attributes(reading.source, element, {"model", "material", "file", "name"});
  const std::string file = attribute_or(element, "file", "");
  if (file.empty()) fail(reading.source, element, "<instances> names no file");
  const std::string path = (reading.folder / file).lexically_normal().string();
  std::string text = read_file(path, kMostPlacementBytes);
  const size_t size = text.size();
  text.push_back('\n');
  Cursor c{text.data(), text.data() + size, 1};
  ObjectGroup group = group_of(element);
  while (c.p < c.end) {
    skip_blanks(c);
    if (!at_line_end(c)) {
      if (group.objects.size() == kMostObjects)
        fail(path, c.line, "more than " + std::to_string(kMostObjects) + " placements");
      const size_t line = c.line;
      Object object;
      if (!read_line(c, object.placement))
        fail(path, line, "not a placement: x y z [scale [degrees]], in numbers that can be undone");
      group.objects.push_back(std::move(object));
    }
    skip_line(c);
  }
  add_group(reading, element, std::move(group));
}

// The columns of `turn`, each by a length of its own.
Affine stretched(const Affine& turn, float x, float y, float z, const Vec3& origin) {
  return {turn.x * x, turn.y * y, turn.z * z, origin};
}

Vec3 direction_attribute(const Source& source, const XmlElement& element, const char* name) {
  const Vec3 direction = vector_attribute(source, element, name, {0, 1, 0});
  if (!(length(to_double(direction)) > 0)) fail(source, element, std::string(name) + " is zero");
  return direction;
}

// Where the attributes of a shape put it.
Affine shape_placement(const Source& source, const XmlElement& element, Shape shape) {
  const auto radius = [&] { return number_attribute(source, element, "radius", kDistances, 1); };
  const auto vector = [&](const char* name, const Vec3& otherwise) {
    return vector_attribute(source, element, name, otherwise);
  };
  switch (shape) {
    case Shape::sphere: {
      warn_unknown_attributes(source, element, {"center", "radius", "material", "name"});
      const float r = radius();
      return stretched({}, r, r, r, vector("center", {0, 0, 0}));
    }
    case Shape::box: {
      warn_unknown_attributes(source, element, {"min", "max", "material", "name"});
      const Vec3 low = vector("min", {-1, -1, -1}), high = vector("max", {1, 1, 1}),
                 half = (high - low) * 0.5f;
      if (!(half.x > 0 && half.y > 0 && half.z > 0)) fail(source, element, "min is not less than max");
      return stretched({}, half.x, half.y, half.z, (low + high) * 0.5f);
    }
    case Shape::cylinder: {
      warn_unknown_attributes(source, element, {"from", "to", "radius", "material", "name"});
      const Vec3 from = vector("from", {0, -1, 0}), to = vector("to", {0, 1, 0});
      const float half = static_cast<float>(length(to_double(to) - to_double(from)) * 0.5), r = radius();
      if (!(half > 0)) fail(source, element, "from and to are the same");
      return stretched(upright_along(to - from), r, half, r, (from + to) * 0.5f);
    }
    case Shape::disk: {
      warn_unknown_attributes(source, element, {"center", "normal", "radius", "material", "name"});
      const float r = radius();
      return stretched(upright_along(direction_attribute(source, element, "normal")), r, 1, r,
                       vector("center", {0, 0, 0}));
    }
    default:
      warn_unknown_attributes(source, element, {"point", "normal", "material", "name"});
      return stretched(upright_along(direction_attribute(source, element, "normal")), 1, 1, 1,
                       vector("point", {0, 0, 0}));
  }
}

void read_shape(Reading& reading, const XmlElement& element, Shape shape) {
  ObjectGroup group = group_of(element);
  Object object;
  object.shape = shape;
  object.placement = shape_placement(reading.source, element, shape);
  read_placement(reading.source, element, object);
  group.objects.push_back(object);
  add_group(reading, element, std::move(group));
}

// The material of that name, taken over from the libraries where no mesh brought it; kNoIndex: none.
uint32_t find_material(const std::string& name, Scene& scene, std::vector<MtlMaterial>& library,
                       const std::vector<std::string>& paths, std::vector<TextureUse>& textures) {
  for (size_t i = 0; i < scene.materials.size(); ++i) {
    if (scene.materials[i].name == name) return static_cast<uint32_t>(i);
  }
  for (size_t i = 0; i < library.size(); ++i) {
    const MtlMaterial& m = library[i];
    if (m.material.name != name) continue;
    const size_t number = scene.materials.size();
    scene.materials.push_back(m.material);
    if (!m.diffuse_map.empty())
      textures.push_back({TextureUse::Role::diffuse, number, m.diffuse_map, paths[i], m.diffuse_line});
    if (!m.opacity_map.empty())
      textures.push_back({TextureUse::Role::opacity, number, m.opacity_map, paths[i], m.opacity_line});
    return static_cast<uint32_t>(number);
  }
  return kNoIndex;
}

uint32_t default_material(Scene& scene) {
  scene.materials.emplace_back().name = "default";
  return static_cast<uint32_t>(scene.materials.size() - 1);
}

}  // namespace

bool read_object_element(Reading& reading, const XmlElement& element) {
  struct {
    const char* name;
    Shape shape;
  } const shapes[] = {{"sphere", Shape::sphere},
                      {"plane", Shape::plane},
                      {"box", Shape::box},
                      {"cylinder", Shape::cylinder},
                      {"disk", Shape::disk}};
  for (const auto& s : shapes) {
    if (!same_name(element.name, s.name)) continue;
    read_shape(reading, element, s.shape);
    return true;
  }
  if (same_name(element.name, "model")) {
    read_model(reading, element);
  } else if (same_name(element.name, "instance")) {
    read_instance(reading, element);
  } else if (same_name(element.name, "instances")) {
    read_instances(reading, element);
  } else {
    return false;
  }
  return true;
}

void resolve_models(Reading& reading) {
  const Project& project = reading.project;
  for (ObjectGroup& group : reading.project.objects) {
    if (group.objects.empty() || group.objects[0].shape != Shape::mesh) continue;
    const auto found = std::find_if(project.models.begin(), project.models.end(),
                                    [&](const ModelFile& m) { return m.name == group.model; });
    if (found == project.models.end())
      fail(project.file, group.line, "no model is called " + named(group.model));
    for (Object& object : group.objects) object.model = static_cast<uint32_t>(found - project.models.begin());
  }
}

void load_models(Project& project, Warnings& warnings) {
  Scene& scene = project.scene;
  for (const ModelFile& model : project.models) {
    Mesh own = std::exchange(scene.mesh, Mesh{});
    load_mesh(model.path, scene, warnings);
    scene.models.push_back(std::exchange(scene.mesh, std::move(own)));
  }
}

void load_objects(Project& project, Warnings& warnings) {
  if (project.objects.empty()) return;
  Scene& scene = project.scene;
  std::vector<MtlMaterial> library;
  std::vector<std::string> paths;
  for (const std::string& path : project.libraries) {
    for (MtlMaterial& m : load_mtl(path, warnings)) {
      library.push_back(std::move(m));
      paths.push_back(path);
    }
  }
  std::vector<TextureUse> textures;
  uint32_t plain = kNoIndex;
  scene.objects.reserve(project.object_count);
  for (ObjectGroup& group : project.objects) {
    uint32_t material = kNoIndex;
    if (!group.material.empty()) {
      material = find_material(group.material, scene, library, paths, textures);
      if (material == kNoIndex)
        fail(project.file, group.line, "no material is called " + named(group.material));
    } else if (!group.objects.empty() && group.objects[0].shape != Shape::mesh) {
      if (plain == kNoIndex) plain = default_material(scene);
      material = plain;
    }
    for (Object& object : group.objects) {
      object.material = material;
      scene.objects.push_back(std::move(object));
    }
    group.objects = {};  // there may be millions
  }
  load_textures(textures, scene, warnings, 0);
}

}  // namespace vitral
