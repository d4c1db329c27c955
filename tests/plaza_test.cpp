// The generated square, as a reader of its files sees it: counts, indices, materials, pictures.
// PLAZA names the generator; `make test` sets it.
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "vitral/vec.h"

namespace {

namespace fs = std::filesystem;
using vitral::Vec3d;

std::string slurp(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

// A path as one word of a shell command, and a space.
std::string word(const fs::path& path) {
  std::string quoted = path.string();
  quoted.insert(quoted.begin(), '\'');
  quoted += "' ";
  return quoted;
}

int run(const std::string& arguments) {
  std::string command = word(std::getenv("PLAZA"));
  command += arguments;
  command += " >/dev/null 2>&1";
  const int status = std::system(command.c_str());
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

struct Obj {
  std::vector<Vec3d> positions, normals;
  size_t texcoords = 0, triangles = 0, turned_away = 0, bad_indices = 0, bad_numbers = 0;
  std::set<std::string> materials;
};

// The numbers of a line, whatever stands between them.
std::vector<double> numbers(std::string_view line) {
  std::vector<double> found;
  for (size_t i = 0; i < line.size();) {
    double value = 0;
    const auto [end, error] = std::from_chars(line.data() + i, line.data() + line.size(), value);
    if (error == std::errc{}) {
      found.push_back(value);
      i = static_cast<size_t>(end - line.data());
    } else {
      ++i;
    }
  }
  return found;
}

// v/vt/vn corners only: what the generator promises to write.
void read_face(std::string_view line, Obj& obj) {
  const std::vector<double> n = numbers(line);
  const size_t corners = n.size() / 3;
  if (n.size() % 3 != 0 || corners < 3 || corners > 4) {
    ++obj.bad_indices;
    return;
  }
  obj.triangles += corners - 2;
  Vec3d mean{0, 0, 0};
  for (size_t c = 0; c < corners; ++c) {
    const size_t p = static_cast<size_t>(n[3 * c]), t = static_cast<size_t>(n[3 * c + 1]),
                 k = static_cast<size_t>(n[3 * c + 2]);
    if (p < 1 || p > obj.positions.size() || t < 1 || t > obj.texcoords || k < 1 || k > obj.normals.size()) {
      ++obj.bad_indices;
      return;
    }
    mean += obj.normals[k - 1];
  }
  const auto corner = [&](size_t c) { return obj.positions[static_cast<size_t>(n[3 * c]) - 1]; };
  const Vec3d area = cross(corner(1) - corner(0), corner(2) - corner(0));
  obj.turned_away += dot(area, mean) <= 0;
}

Obj read_obj(const fs::path& file) {
  Obj obj;
  const std::string text = slurp(file);
  const auto vector_of = [&](std::string_view line) {
    const std::vector<double> n = numbers(line);
    const bool good = n.size() == 3 && std::isfinite(n[0]) && std::isfinite(n[1]) && std::isfinite(n[2]);
    obj.bad_numbers += !good;
    return good ? Vec3d{n[0], n[1], n[2]} : Vec3d{0, 0, 0};
  };
  for (size_t begin = 0; begin < text.size();) {
    const size_t end = text.find('\n', begin);
    const std::string_view line(text.data() + begin, end - begin);
    begin = end + 1;
    if (line.starts_with("v ")) obj.positions.push_back(vector_of(line.substr(2)));
    if (line.starts_with("vn ")) obj.normals.push_back(vector_of(line.substr(3)));
    if (line.starts_with("vt ")) {
      ++obj.texcoords;
      obj.bad_numbers += numbers(line.substr(3)).size() != 2;
    }
    if (line.starts_with("f ")) read_face(line.substr(2), obj);
    if (line.starts_with("usemtl ")) obj.materials.insert(std::string(line.substr(7)));
  }
  return obj;
}

class Plaza : public testing::Test {
 protected:
  void SetUp() override {
    if (!std::getenv("PLAZA")) GTEST_SKIP() << "PLAZA does not name the generator: use `make test`";
    folder_ = fs::temp_directory_path() / ("vitral_plaza_" + std::to_string(getpid()));
  }
  void TearDown() override {
    if (!folder_.empty()) fs::remove_all(folder_);
  }
  fs::path generate(const std::string& name, const std::string& options) {
    EXPECT_EQ(run(word(folder_ / name) + options), 0);
    return folder_ / name;
  }
  fs::path folder_;
};

void expect_sound(const Obj& obj) {
  EXPECT_EQ(obj.bad_numbers, 0u);
  EXPECT_EQ(obj.bad_indices, 0u);
  EXPECT_EQ(obj.turned_away, 0u) << "faces whose corners run against their normals";
}

TEST_F(Plaza, LeastDetailHasAboutTwentyThousandTriangles) {
  const Obj obj = read_obj(generate("least", "--detail 0.05") / "plaza.obj");
  expect_sound(obj);
  EXPECT_GE(obj.triangles, 15000u);
  EXPECT_LE(obj.triangles, 30000u);
}

TEST_F(Plaza, DefaultDetailIsWithinItsRangeAndComplete) {
  const fs::path folder = generate("default", "");
  const Obj obj = read_obj(folder / "plaza.obj");
  expect_sound(obj);
  EXPECT_GE(obj.triangles, 200000u);
  EXPECT_LE(obj.triangles, 400000u);

  std::set<std::string> defined;
  size_t pictures = 0;
  std::istringstream mtl(slurp(folder / "plaza.mtl"));
  for (std::string keyword, value; mtl >> keyword;) {
    if (keyword == "newmtl") {
      mtl >> value;
      EXPECT_TRUE(defined.insert(value).second) << value << " is defined twice";
    } else if (keyword.starts_with("map_")) {
      mtl >> value;
      ++pictures;
      EXPECT_TRUE(slurp(folder / value).starts_with("\x89PNG")) << value;
    }
  }
  EXPECT_GT(pictures, 15u);
  for (const std::string& material : obj.materials) EXPECT_TRUE(defined.contains(material)) << material;
  for (const char* needed : {"Vidro", "Agua", "Folhas", "CalcadaOndas"}) {
    EXPECT_TRUE(obj.materials.contains(needed)) << needed;
  }
}

TEST_F(Plaza, TwoRunsWriteTheSameBytes) {
  const fs::path a = generate("a", "--detail 0.05"), b = generate("b", "--detail 0.05");
  size_t files = 0;
  for (const auto& entry : fs::directory_iterator(a)) {
    ++files;
    EXPECT_TRUE(slurp(entry.path()) == slurp(b / entry.path().filename())) << entry.path().filename();
  }
  EXPECT_GT(files, 15u);
}

TEST_F(Plaza, BadCommandLinesAreUsageErrors) {
  EXPECT_EQ(run(""), 2);
  EXPECT_EQ(run(word(folder_) + "--detail"), 2);
  EXPECT_EQ(run(word(folder_) + "--detail -1"), 2);
  EXPECT_EQ(run(word(folder_) + "--detail many"), 2);
  EXPECT_EQ(run(word(folder_) + "other"), 2);
  EXPECT_FALSE(fs::exists(folder_)) << "nothing is written for a wrong command line";
  EXPECT_EQ(run("/dev/null/folder"), 1);
}

}  // namespace
