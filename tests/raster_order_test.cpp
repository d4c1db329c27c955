// Equal depths go to the lower number whatever way the triangles go, and no order of triangles, chunks or
// bins can be seen in the picture.
#include "raster_lattice.h"

#include <gtest/gtest.h>

#include <numeric>

namespace vitral {
namespace {

using namespace raster_test;

template <class Item>
void shuffle_lists(Random& random, BinLists<Item>& lists) {
  for (size_t bin = 0; bin + 1 < lists.first.size(); ++bin) {
    const uint64_t first = lists.first[bin], end = lists.first[bin + 1];
    for (uint64_t i = first; i < end; ++i) {
      const uint64_t other = first + random.below(static_cast<uint32_t>(end - first));
      std::swap(lists.items[i], lists.items[other]);
    }
  }
}

// Another order of the triangles within every bin.
void shuffle_bins(Random& random, RasterFrame& frame) {
  shuffle_lists(random, frame.bins.references);
  shuffle_lists(random, frame.bins.runs);
}

// Overlapping triangles from a pixel to beyond the guard band, all in the plane at `depth`.
struct Sheet {
  std::vector<Outline> outlines;
  Mesh mesh;
};
Sheet make_sheet(Random& random, int count, float depth) {
  Sheet sheet;
  for (int i = 0; i < count; ++i) {
    // Many small ones in front, in number, of few large ones, so that all get to be seen.
    const int reach = std::array{200, 400, 700, 700, 3000, 9000, 60000}[std::min(6u, random.below(8))];
    const Point middle{between(random, 0, 70 * 256), between(random, 0, 50 * 256)};
    Outline t;
    for (Point& p : t) {
      p = {middle.x + between(random, -reach, reach), middle.y + between(random, -reach, reach)};
      if (reach == 60000 && random.below(6) == 0) p.x = 65536 * int64_t{between(random, -900, 900)};
    }
    if (i > 0 && random.below(5) == 0) {  // once more, from another corner
      t = sheet.outlines[random.below(static_cast<uint32_t>(i))];
      std::swap(t[0], t[random.below(3)]);
    }
    sheet.outlines.push_back(t);
    Vec3 corner[3];
    for (size_t k = 0; k < 3; ++k)
      corner[k] = at_pixel(static_cast<float>(t[k].x) / 256, static_cast<float>(t[k].y) / 256, depth);
    add_triangle(sheet.mesh, corner[0], corner[1], corner[2]);
  }
  return sheet;
}

TEST(RasterOrder, InAPlaneParallelToTheScreenTheLowestNumberIsSeen) {
  constexpr int width = 70, height = 50;
  Random random(61);
  Paths paths;
  size_t contested = 0;
  for (int round = 0; round < 40; ++round) {
    const float depth = std::array{1.0f, 3.0f, 0.7f}[random.below(3)];
    const Sheet sheet = make_sheet(random, 250, depth);
    for (const Kernels* kernels : available_kernels()) {
      RasterFrame frame;
      setup_frame(kernels->front_end, pixel_camera(), width, height, {}, sheet.mesh, nullptr, in_order,
                  frame);
      add(paths, paths_taken(frame, sheet.mesh));
      const Picture picture = fill_frame(*kernels, pixel_camera(), width, height, frame);
      for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
          const Point p = center_of(x, y);
          uint32_t first = kNoTriangle;
          bool unsure = false;
          size_t layers = 0;
          for (uint32_t i = 0; i < sheet.outlines.size() && layers < 2; ++i) {
            const Where w = where(sheet.outlines[i], p);
            unsure |= w == Where::unsure && layers == 0;
            if (w == Where::inside && ++layers == 1) first = i;
          }
          if (unsure) continue;
          ASSERT_EQ(picture.at(x, y), first) << kernels->isa << " round " << round << " at " << x << "," << y;
          if (first == kNoTriangle) continue;
          ASSERT_EQ(picture.depth_at(x, y), static_cast<float>(1 / static_cast<double>(depth)));
          contested += layers > 1;
        }
      }
    }
  }
  EXPECT_GT(contested, 200000u);
  EXPECT_GT(paths.small, 5000u);
  EXPECT_GT(paths.cells, 5000u);
  EXPECT_GT(paths.large, 500u);
  EXPECT_GT(paths.clipped, 200u);
}

// Triangles of all sizes and depths; half of them small.
Mesh crowd(Random& random, int count) {
  Mesh mesh;
  for (int i = 0; i < count; ++i) {
    const float size = std::array{0.4f, 1.0f, 1.5f, 2.0f, 6.0f, 30.0f, 200.0f, 150000.0f}[random.below(8)];
    const float x = random.between(-5, 105), y = random.between(-5, 75), depth = random.between(1, 90);
    Vec3 p[3];
    for (Vec3& v : p) {
      const float dx = random.between(-size, size), dy = random.between(-size, size);
      v = at_pixel(x + dx, y + dy, depth + random.between(-0.5f, 0.5f) + (size > 5 ? 80.0f : 0.0f));
    }
    add_triangle(mesh, p[0], p[1], p[2]);
  }
  return mesh;
}

Picture renumbered(Picture picture, const std::vector<uint32_t>& numbers) {
  for (uint32_t& t : picture.triangle) t = t == kNoTriangle ? t : numbers[t];
  return picture;
}

TEST(RasterOrder, TheOrderOfTheMeshDoesNotMatter) {
  constexpr int width = 100, height = 70;
  Random random(62);
  const Mesh mesh = crowd(random, 9000);
  const Kernels& kernels = *available_kernels().back();
  RasterFrame frame;
  setup_frame(kernels.front_end, pixel_camera(), width, height, {}, mesh, nullptr, in_order, frame);
  ASSERT_GE(frame.chunks.size(), 3u);
  const Picture expected = fill_frame(kernels, pixel_camera(), width, height, frame);
  EXPECT_EQ(expected.covered(), size_t{width * height});
  size_t small_seen = 0;
  std::vector<bool> is_small(mesh.triangles.size());
  for (const SetupChunk& chunk : frame.chunks) {
    for (const Fragment& f : chunk.fragments) is_small[f.triangle] = true;
  }
  for (const uint32_t t : expected.triangle) small_seen += is_small[t];
  EXPECT_GT(small_seen, 1000u);
  EXPECT_LT(small_seen, 6000u);

  for (int shuffle = 0; shuffle < 4; ++shuffle) {
    std::vector<uint32_t> numbers(mesh.triangles.size());
    std::iota(numbers.begin(), numbers.end(), 0u);
    for (size_t i = numbers.size() - 1; i > 0; --i)
      std::swap(numbers[i], numbers[random.below(static_cast<uint32_t>(i + 1))]);
    Mesh other{};
    other.positions = mesh.positions;
    for (const uint32_t n : numbers) other.triangles.push_back(mesh.triangles[n]);
    const Picture p = rasterize(kernels, pixel_camera(), width, height, other);
    ASSERT_TRUE(renumbered(p, numbers) == expected) << shuffle;
  }
}

// The chunks in another order, and so the lists of all bins: references and runs keep their meaning.
TEST(RasterOrder, TheOrderOfTheChunksDoesNotMatter) {
  constexpr int width = 100, height = 70;
  Random random(63);
  Mesh mesh = crowd(random, 5000);
  for (size_t i = 0; i < 5000; ++i) mesh.triangles.push_back(Corners{mesh.triangles[i]});  // ties
  const Kernels& kernels = *available_kernels().back();
  RasterFrame frame;
  setup_frame(kernels.front_end, pixel_camera(), width, height, {}, mesh, nullptr, in_order, frame);
  ASSERT_GE(frame.chunks.size(), 3u);
  const Picture expected = fill_frame(kernels, pixel_camera(), width, height, frame);
  EXPECT_GT(expected.covered(), 5000u);
  for (const uint32_t t : expected.triangle) ASSERT_TRUE(t == kNoTriangle || t < 5000);
  std::reverse(frame.chunks.begin(), frame.chunks.end());
  bin_triangles(in_order, frame);
  EXPECT_TRUE(fill_frame(kernels, pixel_camera(), width, height, frame) == expected);
  for (SetupChunk& chunk : frame.chunks) {
    for (const RunEntry& run : chunk.runs) {
      const auto first = chunk.fragments.begin() + static_cast<std::ptrdiff_t>(run.first);
      std::reverse(first, first + static_cast<std::ptrdiff_t>(run.count));
    }
    std::reverse(chunk.entries.begin(), chunk.entries.end());
  }
  bin_triangles(in_order, frame);
  EXPECT_TRUE(fill_frame(kernels, pixel_camera(), width, height, frame) == expected);
}

TEST(RasterOrder, ACropAlignedToNothingHasTheSameBytes) {
  constexpr int width = 100, height = 70;
  Random random(64);
  const Mesh mesh = crowd(random, 3000);
  size_t inside = 0;
  for (const Kernels* kernels : available_kernels()) {
    const Picture whole = rasterize(*kernels, pixel_camera(), width, height, mesh);
    for (int round = 0; round < 24; ++round) {
      Options options;
      const int x0 = between(random, 0, width - 1), y0 = between(random, 0, height - 1);
      options.crop = {x0, y0, between(random, 1, width - x0), between(random, 1, height - y0)};
      const Picture part = rasterize(*kernels, pixel_camera(), width, height, mesh, options);
      for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
          const bool wanted =
              x >= x0 && x < x0 + options.crop.width && y >= y0 && y < y0 + options.crop.height;
          ASSERT_EQ(part.at(x, y), wanted ? whole.at(x, y) : kNoTriangle) << x << "," << y;
          ASSERT_EQ(part.depth_at(x, y), wanted ? whole.depth_at(x, y) : 0.0f);
          inside += wanted;
        }
      }
    }
  }
  EXPECT_GT(inside, 20000u);
}

TEST(RasterOrder, EqualDepthGoesToTheLowerNumberInAnyOrder) {
  constexpr int size = 64;
  Random random(33);
  // Every triangle several times, some rotated, among others; the copies have higher numbers.
  Mesh mesh = soup(random, 60, 2, 30);
  const size_t originals = mesh.triangles.size();
  for (int copy = 0; copy < 3; ++copy) {
    for (size_t i = 0; i < originals; ++i) mesh.triangles.push_back(mesh.triangles[i]);
  }
  const Pinhole camera = pixel_camera();
  RasterFrame frame;
  const Kernels& kernels = *available_kernels().back();
  setup_frame(kernels.front_end, camera, size, size, {}, mesh, nullptr, in_order, frame);
  const Picture expected = fill_frame(kernels, camera, size, size, frame);
  size_t covered = 0;
  for (const uint32_t t : expected.triangle) {
    if (t == kNoTriangle) continue;
    ASSERT_LT(t, originals);
    ++covered;
  }
  EXPECT_GT(covered, 3000u);
  for (int shuffle = 0; shuffle < 8; ++shuffle) {
    shuffle_bins(random, frame);
    ASSERT_TRUE(fill_frame(kernels, camera, size, size, frame) == expected) << shuffle;
  }
}

// Many walls across the whole picture, close behind each other and some in the same place: skipping
// what is hidden must neither lose the nearest nor the lower number.
TEST(RasterOrder, CloseLayersInAnyOrder) {
  constexpr int size = 64, layers = 300;
  Random random(38);
  for (int round = 0; round < 4; ++round) {
    const float slope = round % 2 == 0 ? 0.0f : 0.01f;
    std::vector<int> depth(layers);
    for (int i = 0; i < layers; ++i) depth[static_cast<size_t>(i)] = i / 3;
    for (size_t i = depth.size() - 1; i > 0; --i)
      std::swap(depth[i], depth[random.below(static_cast<uint32_t>(i + 1))]);
    Mesh mesh;
    for (const int d : depth) {
      const float w = 10 * (1 + static_cast<float>(d) * 1e-5f);
      add_triangle(mesh, at_pixel(-9, -9, w), at_pixel(200, -9, w * (1 + slope)), at_pixel(-9, 200, w));
    }
    const uint32_t expected = static_cast<uint32_t>(std::find(depth.begin(), depth.end(), 0) - depth.begin());
    const Pinhole camera = pixel_camera();
    RasterFrame frame;
    setup_frame(available_kernels().back()->front_end, camera, size, size, {}, mesh, nullptr, in_order,
                frame);
    for (int shuffle = 0; shuffle < 6; ++shuffle) {
      for (const Kernels* kernels : available_kernels()) {
        for (const uint32_t t : fill_frame(*kernels, camera, size, size, frame).triangle)
          ASSERT_EQ(t, expected);
      }
      shuffle_bins(random, frame);
    }
  }
}

TEST(RasterOrder, TheOrderOfTheWorkDoesNotMatter) {
  Random random(36);
  Mesh mesh = soup(random, 500, 0.5f, 40);
  while (mesh.triangles.size() < 5 * kChunkTriangles) {
    mesh.triangles.insert(mesh.triangles.end(), mesh.triangles.begin(), mesh.triangles.begin() + 500);
  }
  RasterFrame expected, backwards, threaded;
  const auto set_up = [&](const ForEach& for_each, RasterFrame& frame) {
    const FrontEnd& kernel = available_kernels().back()->front_end;
    setup_frame(kernel, pixel_camera(), 200, 200, {}, mesh, nullptr, for_each, frame);
  };
  set_up(in_order, expected);
  set_up(
      [](size_t count, const std::function<void(size_t)>& body) {
        while (count-- > 0) body(count);
      },
      backwards);
  ThreadPool pool(3);
  set_up(
      [&](size_t count, const std::function<void(size_t)>& body) {
        pool.parallel_for(count, [&](size_t i, size_t) { body(i); });
      },
      threaded);
  EXPECT_GT(expected.bins.references.items.size(), 20000u);
  EXPECT_GT(expected.bins.runs.items.size(), 50u);
  for (const RasterFrame* frame : {&backwards, &threaded}) {
    EXPECT_EQ(frame->bins.references.first, expected.bins.references.first);
    EXPECT_EQ(frame->bins.references.items, expected.bins.references.items);
    EXPECT_EQ(frame->bins.runs.first, expected.bins.runs.first);
    for (size_t i = 0; i < expected.bins.runs.items.size(); ++i) {
      const FragmentRun &a = expected.bins.runs.items[i], &b = frame->bins.runs.items[i];
      ASSERT_EQ(a.count, b.count);
      for (uint32_t f = 0; f < a.count; ++f) ASSERT_EQ(a.first[f].triangle, b.first[f].triangle);
    }
  }
  EXPECT_TRUE(std::is_sorted(expected.bins.references.items.begin(),
                             expected.bins.references.items.begin() +
                                 static_cast<std::ptrdiff_t>(expected.bins.references.first[1])));
}

}  // namespace
}  // namespace vitral
