// Generates a forest: two models of trees, placed thousands of times on a hilly ground.
//
//   forest PREFIX [--trees N] [--triangles N] [--size WxH]
//
// writes the project PREFIX.xml and what it refers to. N trees in all, of some N triangles each: by default
// 10,000 of 10,000, which are 10^8 triangles.
#include <charconv>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "tree.h"

namespace {

namespace fs = std::filesystem;
using forest::between;
using forest::Random;

struct Arguments {
  fs::path prefix;
  int trees = 10000, triangles = 10000, width = 1024, height = 1024;
};

int number(std::string_view text, int least, int most) {
  int value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || value < least || value > most)
    throw std::invalid_argument("not a number from " + std::to_string(least) + " to " + std::to_string(most) +
                                ": " + std::string(text));
  return value;
}

// Throws std::invalid_argument when the command line makes no sense.
Arguments parse(int argc, char** argv) {
  Arguments a;
  for (int i = 1; i < argc; ++i) {
    const std::string_view word = argv[i];
    if (!word.starts_with("--")) {
      a.prefix = word;
      continue;
    }
    if (++i == argc) throw std::invalid_argument(std::string(word) + " needs a value");
    const std::string_view value = argv[i];
    if (word == "--trees") {
      a.trees = number(value, 1, 4000000);
    } else if (word == "--triangles") {
      a.triangles = number(value, 100, 4000000);
    } else if (word == "--size") {
      const size_t x = value.find('x');
      if (x == std::string_view::npos) throw std::invalid_argument("--size wants WxH");
      a.width = number(value.substr(0, x), 1, 16384);
      a.height = number(value.substr(x + 1), 1, 16384);
    } else {
      throw std::invalid_argument("unknown option: " + std::string(word));
    }
  }
  if (a.prefix.empty())
    throw std::invalid_argument("usage: forest PREFIX [--trees N] [--triangles N] [--size WxH]");
  return a;
}

std::ofstream open(const fs::path& prefix, const char* rest) {
  std::ofstream out(prefix.string() + rest);
  if (!out) throw std::runtime_error("cannot write " + prefix.string() + rest);
  out.setf(std::ios::fixed);
  out.precision(3);
  return out;
}

// Height of the ground, metres.
double ground(double x, double z) {
  return 3.0 * std::sin(x * 0.021 + 0.4) * std::cos(z * 0.017) + 1.2 * std::sin(x * 0.053 + z * 0.041) +
         0.00012 * z * z;
}

void write_ground(const fs::path& prefix, double half) {
  std::ofstream out = open(prefix, "_ground.obj");
  const int n = half > 100 ? 60 : 16;
  const double side = 2.6 * half / n;
  out << "mtllib " << prefix.filename().string() << ".mtl\nusemtl ground\n";
  for (int j = 0; j <= n; ++j) {
    for (int i = 0; i <= n; ++i) {
      const double x = (i - n / 2) * side, z = 0.3 * half - j * side;
      out << "v " << x << ' ' << ground(x, z) << ' ' << z << '\n';
    }
  }
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      const int a = j * (n + 1) + i + 1, b = a + n + 1;
      out << "f " << a << ' ' << a + 1 << ' ' << b + 1 << ' ' << b << '\n';
    }
  }
}

// One tree in each cell of a grid, somewhere in its middle; the cells before the camera are a clearing, and
// firs grow where it is higher.
void write_places(const fs::path& prefix, int trees, double spacing) {
  std::ofstream firs = open(prefix, "_fir.txt"), oaks = open(prefix, "_oak.txt");
  const int across = static_cast<int>(std::ceil(std::sqrt(trees)));
  Random random{7, 0};
  for (int i = 0; i < trees; ++i) {
    const double x = (i % across - 0.5 * (across - 1) + between(random, -0.4, 0.4)) * spacing;
    const double z = -(i / across + 1.5 + between(random, -0.4, 0.4)) * spacing;
    const double size = between(random, 0.7, 1.3), turn = between(random, 0, 360);
    const bool fir = between(random, -3, 3) + ground(x, z) > 1.0;
    (fir ? firs : oaks) << x << ' ' << ground(x, z) << ' ' << z << ' ' << size << ' ' << turn << '\n';
  }
}

void write_materials(const fs::path& prefix) {
  open(prefix, ".mtl") << "newmtl ground\nKd 0.23 0.21 0.10\n\nnewmtl bark\nKd 0.16 0.11 0.07\n\n"
                          "newmtl needles\nKd 0.05 0.15 0.06\n\nnewmtl young_needles\nKd 0.10 0.22 0.07\n\n"
                          "newmtl leaves\nKd 0.19 0.28 0.05\n\nnewmtl young_leaves\nKd 0.32 0.36 0.08\n";
}

// Seen from between the first trees, or from above them where there are enough to fill a landscape.
void write_project(const Arguments& a) {
  const std::string name = a.prefix.filename().string();
  const double above = a.trees > 1000 ? 27 : 15;
  std::ofstream out = open(a.prefix, ".xml");
  out << R"(<?xml version="1.0" encoding="UTF-8"?>
<!-- Instances: two trees, placed )"
      << a.trees << R"( times -->
<project width=")"
      << a.width << R"(" height=")" << a.height << R"(">
  <assets>
    <scenes>
      <scene name="main">
        <file name=")"
      << name << R"(_ground.obj"/>
)";
  for (const std::string kind : {"fir", "oak"}) {
    const std::string file = name + "_" + kind;
    out << "        <model name=\"" << kind << "\"><file name=\"" << file << ".obj\"/></model>\n"
        << "        <instances model=\"" << kind << "\" file=\"" << file << ".txt\"/>\n";
  }
  out << R"(      </scene>
    </scenes>
    <viewports><viewport name="main"><bgcolor r="0.55" g="0.7" b="0.9"/></viewport></viewports>
    <cameras>
      <camera name="main">
        <perspective fov="50" near="0.1" far="5000"/>
        <position x="0" y=")"
      << ground(0, 12) + above << R"(" z="12"/>
        <view x="0.05" y="-0.22" z="-1"/>
      </camera>
    </cameras>
    <lights>
      <light name="sun">
        <direction x="0.55" y="-0.75" z="-0.35"/>
        <color value="1.7"/>
        <ambient value="0.5"/>
      </light>
    </lights>
  </assets>
  <pipelines>
    <pipeline name="main" default="true" defaultCamera="main">
      <pass class="raster" name="raster"/>
      <pass class="trace" name="trace">
        <shadows/>
        <ambientOcclusion samples="16" distance="2"/>
      </pass>
      <pass class="combine" name="combine"/>
    </pipeline>
  </pipelines>
</project>
)";
}

void generate(const Arguments& a) {
  if (a.prefix.has_parent_path()) fs::create_directories(a.prefix.parent_path());
  constexpr double spacing = 5;
  write_materials(a.prefix);
  write_ground(a.prefix, 0.5 * spacing * std::sqrt(a.trees) + 10);
  write_places(a.prefix, a.trees, spacing);
  const std::string library = a.prefix.filename().string() + ".mtl";
  const size_t fir = forest::write_tree(forest::fir(a.triangles), library, a.prefix.string() + "_fir.obj");
  const size_t oak = forest::write_tree(forest::oak(a.triangles), library, a.prefix.string() + "_oak.obj");
  // Last, because it is what make waits for.
  write_project(a);
  std::printf("%s.xml: %d trees, a fir of %zu triangles and an oak of %zu\n", a.prefix.string().c_str(),
              a.trees, fir, oak);
}

}  // namespace

int main(int argc, char** argv) {
  try {
    generate(parse(argc, argv));
  } catch (const std::invalid_argument& error) {
    std::fprintf(stderr, "forest: %s\n", error.what());
    return 2;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "forest: %s\n", error.what());
    return 1;
  }
}
