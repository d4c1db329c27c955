#include "io/mtl.h"

#include "io/file.h"
#include "io/text.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

namespace vitral {
namespace {

constexpr size_t kFewWarnings = 5;
constexpr float kMostEmission = 1e6f;

// What d, Tr and illum say; the optics follow from all three when the material is complete.
struct Given {
  bool d = false, tr = false;
  float d_value = 1, tr_value = 0;
  int64_t illum = 2;
};

// Options of a map_ statement with the number of words after each; -o, -s and -t take one to three
// numbers.
struct MapOption {
  std::string_view name;
  int words;
};
constexpr int kUpToThreeNumbers = -1;
constexpr std::array<MapOption, 15> kMapOptions = {{{"-blendu", 1},
                                                    {"-blendv", 1},
                                                    {"-boost", 1},
                                                    {"-bm", 1},
                                                    {"-cc", 1},
                                                    {"-clamp", 1},
                                                    {"-colorspace", 1},
                                                    {"-imfchan", 1},
                                                    {"-mm", 2},
                                                    {"-o", kUpToThreeNumbers},
                                                    {"-s", kUpToThreeNumbers},
                                                    {"-t", kUpToThreeNumbers},
                                                    {"-texres", 1},
                                                    {"-type", 1},
                                                    {"-halo", 0}}};

class MtlReader {
 public:
  MtlReader(std::string_view text, const std::string& path, Warnings& warnings)
      : path_(path), warnings_(warnings), buffer_(text) {
    buffer_ += '\n';
    c_ = {buffer_.data(), buffer_.data() + text.size(), 1};
    if (text.substr(0, 3) == "\xef\xbb\xbf") c_.p += 3;  // UTF-8 mark
  }

  std::vector<MtlMaterial> run() {
    while (c_.p < c_.end) {
      skip_blanks(c_);
      line_ = c_.line;
      if (!at_line_end(c_)) read_statement();
      skip_line(c_);
    }
    finish_material();
    if (warned_ > kFewWarnings) {
      warnings_.push_back(path_ + ": " + std::to_string(warned_ - kFewWarnings) + " more such lines");
    }
    return std::move(materials_);
  }

 private:
  void read_statement() {
    const std::string keyword = lower_case(read_word(c_));
    skip_blanks(c_);
    if (keyword == "newmtl") {
      finish_material();
      materials_.emplace_back();
      materials_.back().material.name = read_rest(c_);
      given_ = {};
      return;
    }
    if (materials_.empty()) return;
    MtlMaterial& entry = materials_.back();
    Material& m = entry.material;
    if (keyword == "kd") {
      read_colour(m.diffuse);
    } else if (keyword == "ks") {
      read_colour(m.specular);
    } else if (keyword == "ke") {
      read_colour(m.emission, kMostEmission);
    } else if (keyword == "tf") {
      read_colour(m.transmission);
    } else if (keyword == "ns") {
      read_value(m.shininess, 0, 1e6f);
    } else if (keyword == "ni") {
      read_index(m.index);
    } else if (keyword == "d") {
      given_.d |= read_value(given_.d_value, 0, 1);
    } else if (keyword == "tr") {
      given_.tr |= read_value(given_.tr_value, 0, 1);
    } else if (keyword == "illum") {
      if (!read_integer(c_, given_.illum)) warn("illum needs a number");
    } else if (keyword == "map_kd") {
      entry.diffuse_map = read_map();
      entry.diffuse_line = line_;
    } else if (keyword == "map_d" || keyword == "map_opacity") {
      entry.opacity_map = read_map();
      entry.opacity_line = line_;
    }
  }

  void warn(const std::string& reason) {
    if (++warned_ <= kFewWarnings) warnings_.push_back(path_ + ":" + std::to_string(line_) + ": " + reason);
  }

  // Reads one number into [low, high]. `-halo` before it is an option of d.
  bool read_value(float& value, float low, float high) {
    if (c_.p[0] == '-' && c_.p[1] == 'h') {
      read_word(c_);
      skip_blanks(c_);
    }
    float x;
    if (!read_float(c_, x) || !std::isfinite(x)) {
      warn("a finite number is missing; the default is kept");
      return false;
    }
    value = std::clamp(x, low, high);
    return true;
  }

  // Some exporters write 0 for an index of refraction they do not know.
  void read_index(float& index) {
    float x = 0;
    if (read_value(x, 0, 10) && x > 0) index = std::max(x, 0.1f);
  }

  // One number stands for all three. Spectral curves and CIE values are not supported.
  void read_colour(Vec3& colour, float most = 1) {
    Vec3 c{0, 0, 0};
    if (!read_value(c.x, 0, most)) return;
    c.y = c.z = c.x;
    skip_blanks(c_);
    if (!at_line_end(c_)) {
      if (!read_value(c.y, 0, most)) return;
      skip_blanks(c_);
      if (!at_line_end(c_) && !read_value(c.z, 0, most)) return;
    }
    colour = c;
  }

  // Skips the options; what is left of the line is the name of the file, spaces included.
  std::string read_map() {
    while (*c_.p == '-') {
      Cursor word = c_;
      const std::string_view name = read_word(word);
      const auto option = std::find_if(kMapOptions.begin(), kMapOptions.end(),
                                       [&name](const MapOption& o) { return o.name == name; });
      if (option == kMapOptions.end()) break;
      c_ = word;
      skip_blanks(c_);
      if (option->words == kUpToThreeNumbers) {
        skip_placement(name);
      } else {
        if (name == "-clamp" && std::string_view(c_.p, 2) == "on")
          warn("texture option -clamp on is ignored");
        for (int i = 0; i < option->words && !is_newline(*c_.p); ++i) {
          read_word(c_);
          skip_blanks(c_);
        }
      }
    }
    std::string name = read_rest(c_);
    if (name.size() >= 2 && name.front() == '"' && name.back() == '"') name = name.substr(1, name.size() - 2);
    if (name.empty()) warn("the name of the texture is missing");
    return name;
  }

  // Offset, scale and turbulence: up to three numbers. A file whose name is a number would be
  // mistaken for one, so the last word of the line is always the name.
  void skip_placement(std::string_view option) {
    const float neutral = option == "-s" ? 1.0f : 0.0f;
    bool matters = false;
    for (int i = 0; i < 3; ++i) {
      Cursor next = c_;
      float x;
      if (!read_float(next, x) || !is_blank(*next.p)) break;
      skip_blanks(next);
      if (is_newline(*next.p)) break;
      if (x != neutral && i < 2) matters = true;
      c_ = next;
    }
    if (matters) warn("texture option " + std::string(option) + " is ignored");
  }

  void finish_material() {
    if (materials_.empty()) return;
    MtlMaterial& entry = materials_.back();
    Material& m = entry.material;
    m.opacity = given_.d ? given_.d_value : given_.tr ? 1 - given_.tr_value : 1.0f;
    switch (given_.illum) {
      case 3:
        m.optics = Optics::mirror;
        break;
      case 5:
      case 8:
        m.optics = Optics::polished;
        break;
      case 4:
      case 6:
      case 7:
      case 9:
        m.optics = Optics::solid;
        break;
      default:
        m.optics = m.opacity < 1 && entry.opacity_map.empty() ? Optics::dissolve : Optics::opaque;
    }
    if (!entry.diffuse_map.empty() && m.diffuse == Vec3{0, 0, 0}) m.diffuse = {1, 1, 1};
  }

  const std::string& path_;
  Warnings& warnings_;
  std::string buffer_;
  Cursor c_;
  size_t line_ = 1, warned_ = 0;
  std::vector<MtlMaterial> materials_;
  Given given_;
};

}  // namespace

std::vector<MtlMaterial> parse_mtl(std::string_view text, const std::string& path, Warnings& warnings) {
  return MtlReader(text, path, warnings).run();
}

std::vector<MtlMaterial> load_mtl(const std::string& path, Warnings& warnings) {
  const std::string text = read_file(path, uint64_t{64} << 20);
  if (std::memchr(text.data(), '\0', text.size()) != nullptr)
    fail(path, "not an MTL file: it holds binary data");
  return parse_mtl(text, path, warnings);
}

}  // namespace vitral
