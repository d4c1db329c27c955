// Building a tree: the same bytes on any number of threads, bounds kept on hostile input, progress told,
// and an end when it is told to stop.
#include "kdtree/build.h"
#include "kdtree_support.h"
#include "parallel/parallel_for.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <stdexcept>

namespace vitral::test {
namespace {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__) || !defined(__OPTIMIZE__)
constexpr int kMany = 20000;
#else
constexpr int kMany = 100000;
#endif

void expect_same_bytes(const KdTree& a, const KdTree& b) {
  ASSERT_EQ(a.nodes.size(), b.nodes.size());
  ASSERT_EQ(a.references, b.references);
  EXPECT_EQ(std::memcmp(a.nodes.data(), b.nodes.data(), a.nodes.size() * sizeof(KdNode)), 0);
}

TEST(KdTreeBuild, IsTheSameOnAnyNumberOfThreads) {
  Random random(21);
  const Triangles meshes[] = {soup(random, kMany / 3, 0.02f), sphere({0, 0, 0}, 1, kMany / 1000),
                              city(random, kMany / 10), needles(random, 600)};
  for (const Triangles& mesh : meshes) {
    const KdTree expected = build_kdtree(mesh, all_of(mesh), {}, one_by_one);
    if (&mesh != &meshes[3]) {  // the needles stay one leaf
      ASSERT_GT(expected.nodes.size(), 500u);
    }
    for (const int threads : {1, 2, 3, 5, 8}) {
      ThreadPool pool(threads);
      const Executor executor = [&](size_t n, const std::function<void(size_t)>& body) {
        pool.parallel_for(n, [&](size_t i, size_t) { body(i); });
      };
      expect_same_bytes(expected, build_kdtree(mesh, all_of(mesh), {}, executor));
    }
  }
}

TEST(KdTreeBuild, EndsSoonAndWithinItsBoundsOnHostileInput) {
  Random random(23);
  std::vector<Triangles> hostile(8);
  for (int i = 0; i < kMany; ++i) add_triangle(hostile[0], {0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  for (int i = 0; i < kMany; ++i) {  // all in one plane
    const Vec3 p = random.in_box(-1, 1) * Vec3{1, 0, 1};
    add_triangle(hostile[1], p, p + Vec3{0.01f, 0, 0}, p + Vec3{0, 0, 0.01f});
  }
  for (int i = 0; i < kMany; ++i) {  // all in two planes that cross, and all through one point
    const Vec3 p = random.in_box(-1, 1), q = random.in_box(-1, 1);
    add_triangle(hostile[2], {0, 0, 0}, i % 2 ? Vec3{p.x, 0, p.z} : Vec3{0, p.y, p.z},
                 i % 2 ? Vec3{q.x, 0, q.z} : Vec3{0, q.y, q.z});
  }
  hostile[3] = needles(random, kMany / 10);
  hostile[4] = soup(random, kMany / 20, 1.0f);  // all overlap
  hostile[5] = scaled(soup(random, kMany / 4, 0.01f), 9e17f, {0, 0, 0});
  hostile[6] = scaled(soup(random, kMany / 4, 0.01f), 1e-38f, {0, 0, 0});
  hostile[7] = scaled(soup(random, kMany / 4, 0.01f), 1e-4f, {1000, 1000, 1000});  // a few ulps across
  for (size_t which = 0; which < hostile.size(); ++which) {
    const Triangles& list = hostile[which];
    const auto start = std::chrono::steady_clock::now();
    const KdTree tree = build_kdtree(list, all_of(list), {}, one_by_one);
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    EXPECT_LT(seconds.count(), 10) << which;
    std::vector<bool> found(list.size());
    size_t references = 0;
    for_each_leaf(tree, 0, tree.bounds, 0, [&](const KdNode& leaf, const Box&, int depth) {
      references += count(leaf);
      EXPECT_LT(depth, kMaxTreeDepth);
      for (uint32_t i = 0; i < count(leaf); ++i) found[tree.references.at(first_reference(leaf) + i)] = true;
    });
    EXPECT_EQ(references, tree.references.size()) << which;
    EXPECT_LE(references, 4 * list.size()) << which;
    EXPECT_EQ(std::count(found.begin(), found.end(), false), 0) << which;
  }
}

TEST(KdTreeBuild, HandlesNoneAndOne) {
  const KdTree none = build_kdtree({}, {}, {}, one_by_one);
  ASSERT_TRUE(is_leaf(none.nodes.at(0)));
  EXPECT_EQ(count(none.nodes[0]), 0u);
  EXPECT_TRUE(is_empty(none.bounds));

  Triangles list;
  for (int i = 0; i < 3; ++i) add_triangle(list, {0, 0, 0}, {1, 0, 0}, {0, 1, 1});
  const KdTree one = build_kdtree(list, {1}, {}, one_by_one);
  ASSERT_TRUE(is_leaf(one.nodes.at(0)));
  EXPECT_EQ(one.references, std::vector<uint32_t>{1});
}

TEST(KdTreeBuild, TellsHowFarItIs) {
  Random random(25);
  const Triangles list = soup(random, 20000, 0.02f);
  std::vector<double> shares;
  ThreadPool pool(3);
  build_kdtree(
      list, all_of(list), {},
      [&](size_t n, const std::function<void(size_t)>& body) {
        pool.parallel_for(n, [&](size_t i, size_t) { body(i); });
      },
      [&](double share) { shares.push_back(share); });
  ASSERT_GT(shares.size(), 5u);
  EXPECT_TRUE(std::is_sorted(shares.begin(), shares.end()));
  EXPECT_LT(shares.front(), 0.5);
  EXPECT_EQ(shares.back(), 1.0);
}

TEST(KdTreeBuild, EndsWhenItsExecutorThrows) {
  Random random(26);
  const Triangles list = soup(random, 20000, 0.02f);
  const std::vector<uint32_t> members = all_of(list);
  size_t all = 0;
  build_kdtree(list, members, {}, [&](size_t n, const std::function<void(size_t)>& body) {
    all += n;
    one_by_one(n, body);
  });
  ASSERT_GT(all, 10u);
  for (size_t stop_at = 0; stop_at < all; stop_at += all / 10) {
    size_t done = 0;
    const Executor executor = [&](size_t n, const std::function<void(size_t)>& body) {
      for (size_t i = 0; i < n; ++i) {
        if (done++ == stop_at) throw std::runtime_error("stop");
        body(i);
      }
    };
    EXPECT_THROW(build_kdtree(list, members, {}, executor), std::runtime_error) << stop_at;
  }
}

}  // namespace
}  // namespace vitral::test
