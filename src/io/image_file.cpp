#include "io/image_file.h"

#include "io/decode_texture.h"
#include "io/file.h"
#include "io/jpeg_check.h"
#include "io/png.h"
#include "io/stb.h"

#include <bit>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <string_view>

namespace vitral {
namespace {

constexpr uint64_t kMaxFileBytes = uint64_t{256} << 20;
constexpr const char* kBroken = "the picture is broken, or of a kind that is not supported";
constexpr uint64_t kMaxTexelBytes = uint64_t{256} << 20;

struct Free {
  void operator()(uint8_t* block) const { std::free(block); }
};
using Decoded = std::unique_ptr<uint8_t, Free>;

bool is_png(std::string_view bytes) {
  return bytes.substr(0, 8) == "\x89PNG\r\n\x1a\n";
}
bool is_jpeg(std::string_view bytes) {
  return bytes.substr(0, 2) == "\xff\xd8";
}
bool is_bmp(std::string_view bytes) {
  return bytes.substr(0, 2) == "BM";
}

// The most pixels that one byte of a file can unpack to: deflate's ratio at one bit a pixel, a bit a
// block of 8x8, runs of 128, one bit a pixel.
uint64_t pixels_per_byte(std::string_view bytes) {
  return is_png(bytes) ? 8 * 1032 : is_jpeg(bytes) ? 512 : is_bmp(bytes) ? 8 : 128;
}

// Decodes to `channels` bytes a pixel after checking that the size is believable.
Decoded decode(const std::string& path, std::string_view bytes, int channels, int& width, int& height,
               int& stored) {
  if (bytes.empty()) fail(path, "the file is empty");
  const auto* const data = reinterpret_cast<const uint8_t*>(bytes.data());
  const int length = static_cast<int>(bytes.size());
  if (is_jpeg(bytes)) check_jpeg(path, bytes);
  {
    const StbAllocationLimit limit(size_t{1} << 20);
    if (stbi_info_from_memory(data, length, &width, &height, &stored) == 0) {
      fail(path, is_png(bytes) || is_jpeg(bytes) || is_bmp(bytes)
                     ? kBroken
                     : "not a picture in PNG, JPEG, TGA or BMP format");
    }
  }
  if (is_bmp(bytes) && height < 0 && height >= -kMaxImageSide) height = -height;  // its rows run from the top
  if (width <= 0 || height <= 0) fail(path, "the picture is empty");
  const uint64_t pixels = static_cast<uint64_t>(width) * static_cast<uint64_t>(height);
  if (width > kMaxImageSide || height > kMaxImageSide || pixels * 4 > kMaxTexelBytes) {
    fail(path,
         "a picture of " + std::to_string(width) + " x " + std::to_string(height) + " pixels is too large");
  }
  if (pixels > 65536 + bytes.size() * pixels_per_byte(bytes)) {
    fail(path,
         "too short for a picture of " + std::to_string(width) + " x " + std::to_string(height) + " pixels");
  }

  // The largest block is one of 4 channels of 16 bits, or unpacked data with room to double.
  const StbAllocationLimit limit(
      static_cast<size_t>(16 * pixels + 64 * static_cast<uint64_t>(height) + 2 * bytes.size()) +
      (size_t{1} << 20));
  Decoded texels(stbi_load_from_memory(data, length, &width, &height, &stored, channels));
  if (!texels) fail(path, kBroken);
  return texels;
}

void put_little_endian(std::string& bytes, float value) {
  auto bits = std::bit_cast<uint32_t>(value);
  for (int i = 0; i < 4; ++i, bits >>= 8) bytes += static_cast<char>(bits & 0xff);
}

}  // namespace

DecodedTexture decode_texture(const std::string& path) {
  const std::string bytes = read_file(path, kMaxFileBytes);
  DecodedTexture result;
  int stored = 0;
  const Decoded texels = decode(path, bytes, 4, result.texture.width, result.texture.height, stored);
  result.texture.name = path;
  const size_t size =
      4 * static_cast<size_t>(result.texture.width) * static_cast<size_t>(result.texture.height);
  result.texture.texels.assign(texels.get(), texels.get() + size);
  result.alpha = stored == 2 || stored == 4 ? Alpha::stored : Alpha::none;
  return result;
}

Texture load_texture(const std::string& path) {
  return decode_texture(path).texture;
}

Image<Rgb8> read_png(const std::string& path) {
  const std::string bytes = read_file(path, kMaxFileBytes);
  if (!is_png(bytes)) fail(path, "not a PNG file");
  int width = 0, height = 0, stored = 0;
  const Decoded texels = decode(path, bytes, 3, width, height, stored);
  Image<Rgb8> image(width, height);
  std::memcpy(image.pixels.data(), texels.get(), 3 * image.pixels.size());
  return image;
}

void write_png(const std::string& path, const Image<Rgb8>& image) {
  write_file(path, encode_png(image));
}

// Portable float map: rows from the bottom up, a negative scale for little-endian numbers.
void write_pfm(const std::string& path, const Aov& aov) {
  const Image<Vec3>& pixels = aov.pixels;
  std::string bytes = (aov.channels == 1 ? "Pf\n" : "PF\n") + std::to_string(pixels.width) + " " +
                      std::to_string(pixels.height) + "\n-1.0\n";
  bytes.reserve(bytes.size() + pixels.pixels.size() * 4 * static_cast<size_t>(aov.channels));
  for (int y = pixels.height - 1; y >= 0; --y) {
    for (int x = 0; x < pixels.width; ++x) {
      const Vec3& value = pixels.row(y)[x];
      put_little_endian(bytes, value.x);
      if (aov.channels == 1) continue;
      put_little_endian(bytes, value.y);
      put_little_endian(bytes, value.z);
    }
  }
  write_file(path, bytes);
}

}  // namespace vitral
