#include "io/image_file.h"

#include "io/deflate.h"
#include "io/file.h"
#include "scratch.h"

#include <gtest/gtest.h>

#include <algorithm>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <cstring>
#include <thread>

namespace vitral {
namespace {

uint32_t next_random(uint32_t& state) {
  state = state * 1664525u + 1013904223u;
  return state >> 8;
}

// Pictures with flat parts, gradients and noise, each of which another part of the encoder likes.
Image<Rgb8> picture(int width, int height, uint32_t noise) {
  Image<Rgb8> image(width, height);
  uint32_t state = noise + 1;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      Rgb8& p = image.row(y)[x];
      p.r = static_cast<uint8_t>(x * 3 + y);
      p.g = static_cast<uint8_t>(y / 16 * 40);
      p.b = static_cast<uint8_t>(noise > 0 ? next_random(state) % (noise + 1) : 7);
    }
  }
  return image;
}

bool same(const Image<Rgb8>& a, const Image<Rgb8>& b) {
  return a.width == b.width && a.height == b.height &&
         std::memcmp(a.pixels.data(), b.pixels.data(), 3 * a.pixels.size()) == 0;
}

TEST(ImageFile, PngComesBackExactly) {
  const test::ScratchFolder folder;
  const std::string path = (folder / "a.png");
  const int sizes[][2] = {{1, 1}, {1, 40}, {40, 1}, {3, 2}, {257, 131}, {640, 333}};
  for (const auto& size : sizes) {
    for (const uint32_t noise : {0u, 3u, 255u}) {
      const Image<Rgb8> image = picture(size[0], size[1], noise);
      write_png(path, image);
      EXPECT_TRUE(same(read_png(path), image)) << size[0] << " x " << size[1] << " noise " << noise;
    }
  }
}

TEST(ImageFile, PngIsSmallWhereThePictureIsSimpleAndHoldsNoDate) {
  const test::ScratchFolder folder;
  write_png((folder / "a.png"), Image<Rgb8>(1024, 1024, {10, 20, 30}));
  const std::string bytes = test::read_text(folder / "a.png");
  EXPECT_LT(bytes.size(), 20000u);
  EXPECT_EQ(bytes.find("tIME"), std::string::npos);
  write_png((folder / "b.png"), Image<Rgb8>(1024, 1024, {10, 20, 30}));
  EXPECT_EQ(test::read_text(folder / "b.png"), bytes);
}

TEST(ImageFile, PfmHoldsTheFloatsFromTheBottomUp) {
  const test::ScratchFolder folder;
  Aov aov{"depth", 1, Image<Vec3>(2, 2)};
  for (int i = 0; i < 4; ++i) aov.pixels.pixels[static_cast<size_t>(i)] = {static_cast<float>(i), 10, 20};
  write_pfm((folder / "a.pfm"), aov);
  std::string bytes = test::read_text(folder / "a.pfm");
  ASSERT_EQ(bytes.substr(0, 12), "Pf\n2 2\n-1.0\n");
  float values[4];
  ASSERT_EQ(bytes.size(), 12 + sizeof values);
  std::memcpy(values, bytes.data() + 12, sizeof values);
  EXPECT_EQ(values[0], 2);
  EXPECT_EQ(values[3], 1);
  aov.channels = 3;
  write_pfm((folder / "a.pfm"), aov);
  bytes = test::read_text(folder / "a.pfm");
  EXPECT_EQ(bytes.substr(0, 3), "PF\n");
  EXPECT_EQ(bytes.size(), 12u + 48u);
}

TEST(ImageFile, OutputIsWholeOrNotThere) {
  const test::ScratchFolder folder;
  const Image<Rgb8> image = picture(8, 8, 0);
  const auto error = [&](const std::string& path) {
    const std::string checked = test::error_of<InputError>([&] { check_writable(path); });
    const std::string written = test::error_of<InputError>([&] { write_png(path, image); });
    EXPECT_EQ(checked, written) << "what is checked before is what happens after";
    return written;
  };
  EXPECT_EQ(error((folder / "none/a.png")), (folder / "none/a.png") + ": No such file or directory");
  std::filesystem::create_directory((folder / "folder"));
  EXPECT_EQ(error((folder / "folder")), (folder / "folder") + ": Is a directory");
  EXPECT_EQ(error((folder / "")), (folder / "") + ": Is a directory");
  folder.write("file", "x");
  EXPECT_NE(error((folder / "file/a.png")), "");
  EXPECT_NE(error(""), "");
  EXPECT_EQ(folder.files(), 2u) << "no temporary file is left";

  folder.write("a.png", "what stood here before");
  check_writable((folder / "a.png"));
  EXPECT_EQ(test::read_text(folder / "a.png"), "what stood here before");
  write_png((folder / "a.png"), image);
  EXPECT_TRUE(same(read_png((folder / "a.png")), image));
  EXPECT_EQ(folder.files(), 3u);
}

TEST(ImageFile, AFullDeviceIsAnError) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP();
  EXPECT_EQ(test::error_of<InputError>([] { write_file("/dev/full", "x"); }),
            "/dev/full: No space left on device");
  EXPECT_TRUE(std::filesystem::exists("/dev/full"));
}

TEST(ImageFile, PipesAndLinksKeepTheirIdentity) {
  const test::ScratchFolder folder;
  folder.write("target", "old");
  std::filesystem::create_symlink("target", (folder / "link"));
  write_file((folder / "link"), "new");
  EXPECT_TRUE(std::filesystem::is_symlink((folder / "link")));
  EXPECT_EQ(test::read_text(folder / "target"), "new");

  ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
  std::string received;
  std::thread reader([&] { received = test::read_text(folder / "pipe"); });
  write_file((folder / "pipe"), "through the pipe");
  reader.join();
  EXPECT_EQ(received, "through the pipe");
  EXPECT_EQ(test::error_of<InputError>([&] { read_file((folder / "pipe"), 100); }),
            (folder / "pipe") + ": not a regular file");
}

TEST(ImageFile, ANewFileObeysTheUmask) {
  const test::ScratchFolder folder;
  const mode_t before = ::umask(027);
  write_file((folder / "a"), "x");
  ::umask(before);
  struct stat info;
  ASSERT_EQ(::stat((folder / "a").c_str(), &info), 0);
  EXPECT_EQ(info.st_mode & 0777, 0640u);
}

// An uncompressed 24-bit bottom-up BMP: two rows of one pixel.
std::string small_bmp() {
  std::string b = "BM";
  const auto put = [&b](uint32_t value, int bytes) {
    for (int i = 0; i < bytes; ++i, value >>= 8) b += static_cast<char>(value & 0xff);
  };
  put(62, 4), put(0, 4), put(54, 4);
  put(40, 4), put(1, 4), put(2, 4), put(1, 2), put(24, 2);
  for (int i = 0; i < 6; ++i) put(0, 4);
  b += std::string("\x01\x02\x03\0\x04\x05\x06\0", 8);
  return b;
}

TEST(ImageFile, TextureRowsRunFromTheTop) {
  const test::ScratchFolder folder;
  const Texture t = load_texture(folder.write("a.bmp", small_bmp()));
  EXPECT_EQ(t.width, 1);
  EXPECT_EQ(t.height, 2);
  EXPECT_EQ(t.texels, (std::vector<uint8_t>{6, 5, 4, 255, 3, 2, 1, 255}));

  // A negative height turns the order round.
  std::string top_down = small_bmp();
  top_down.replace(22, 4, "\xfe\xff\xff\xff");
  EXPECT_EQ(load_texture(folder.write("b.bmp", top_down)).texels,
            (std::vector<uint8_t>{3, 2, 1, 255, 6, 5, 4, 255}));
}

TEST(ImageFile, RefusesPicturesThatAreBrokenOrTooLarge) {
  const test::ScratchFolder folder;
  const auto error = [&](const std::string& bytes) {
    const std::string text = test::error_of<InputError>([&] { load_texture(folder.write("a", bytes)); });
    EXPECT_EQ(text.find('\n'), std::string::npos);
    return text;
  };
  EXPECT_EQ(error(""), (folder / "a") + ": the file is empty");
  EXPECT_NE(error("GIF89a............................").find("not a picture in PNG"), std::string::npos);
  EXPECT_NE(error("not a picture at all, but text").find("not a picture in PNG"), std::string::npos);

  // 16000 x 16000 in 18 bytes.
  std::string tga(18, '\0');
  tga[2] = 2;
  tga[12] = tga[14] = static_cast<char>(0x80);
  tga[13] = tga[15] = 0x3e;
  tga[16] = 24;
  EXPECT_NE(error(tga).find("16000 x 16000 pixels is too large"), std::string::npos);
  tga[15] = 0x01;
  EXPECT_NE(error(tga).find("too short for a picture of 16000 x 384 pixels"), std::string::npos);

  write_png((folder / "b"), picture(64, 64, 255));
  const std::string png = test::read_text(folder / "b");
  EXPECT_NE(error(png.substr(0, png.size() / 2)), "");
  std::string critical = png;
  critical.insert(33, std::string("\0\0\0\0\n\nAB\0\0\0\0", 12));  // a chunk called "\n\nAB"
  EXPECT_NE(error(critical), "");
  EXPECT_NE(
      test::error_of<InputError>([&] { read_png(folder.write("c", small_bmp())); }).find("not a PNG file"),
      std::string::npos);
}

// stb_image writes the symbols of a Huffman table to room for 256, however many the file counts; and
// it goes over the whole picture once for every scan that the file has.
TEST(ImageFile, RefusesJpegsThatItsDecoderCannotBear) {
  const test::ScratchFolder folder;
  const auto error = [&](const std::string& segments) {
    const std::string path = folder.write("a.jpg", "\xff\xd8" + segments + "\xff\xd9");
    return test::error_of<InputError>([&] { load_texture(path); });
  };
  const auto huffman_table = [](size_t symbols) {
    std::string counts(16, '\0');
    for (size_t i = 0, left = symbols; left > 0; ++i) {
      const size_t n = std::min<size_t>(left, 200);
      counts[15 - i] = static_cast<char>(n);
      left -= n;
    }
    const size_t length = 2 + 17 + symbols;
    return std::string("\xff\xc4") + static_cast<char>(length >> 8) + static_cast<char>(length & 0xff) +
           std::string(1, '\0') + counts + std::string(symbols, '\1');
  };
  EXPECT_NE(error(huffman_table(257)).find("Huffman table of more than 256"), std::string::npos);
  EXPECT_EQ(error(huffman_table(256)).find("Huffman table of more than 256"), std::string::npos);

  const std::string scan("\xff\xda\0\x08\1\1\0\0\x3f\0", 10);
  std::string scans;
  for (int i = 0; i < 1000; ++i) scans += scan;
  EXPECT_EQ(error(scans).find("scans"), std::string::npos);
  EXPECT_NE(error(scans + scan).find("more than 1000 JPEG scans"), std::string::npos);
}

TEST(ImageFile, ABrokenPictureDecodesTheSameEveryTime) {
  const test::ScratchFolder folder;
  write_png((folder / "a"), picture(40, 40, 255));
  std::string bytes = test::read_text(folder / "a");
  uint32_t state = 1;
  for (int i = 0; i < 60; ++i) {
    std::string damaged = bytes;
    damaged[next_random(state) % damaged.size()] ^= static_cast<char>(1 << (next_random(state) % 8));
    const std::string path = folder.write("b", damaged);
    const auto attempt = [&] {
      try {
        return std::string(reinterpret_cast<const char*>(load_texture(path).texels.data()), 6400);
      } catch (const InputError& error) {
        return std::string(error.what());
      }
    };
    EXPECT_EQ(attempt(), attempt());
  }
}

}  // namespace
}  // namespace vitral
