// Stratified random numbers: where they lie, how they are spread, and that orders are random.
#include "math/strata.h"

#include "render/samples.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <vector>

namespace vitral::test {
namespace {

TEST(Strata, EverySquareHoldsOneSample) {
  for (const uint32_t side : {2u, 4u, 8u, 16u}) {
    const uint32_t count = side * side;
    for (uint32_t key = 0; key < 50; ++key) {
      std::set<uint32_t> squares, columns, rows;
      for (uint32_t i = 0; i < count; ++i) {
        const auto p = stratified_pair(i, count, hash32(key));
        ASSERT_TRUE(p.u >= 0 && p.u < 1 && p.v >= 0 && p.v < 1);
        const auto scaled = [](float x, uint32_t n) {
          return static_cast<uint32_t>(x * static_cast<float>(n));
        };
        squares.insert(scaled(p.u, side) * side + scaled(p.v, side));
        columns.insert(scaled(p.u, count));
        rows.insert(scaled(p.v, count));
      }
      EXPECT_EQ(squares.size(), count);
      EXPECT_EQ(columns.size(), count);
      EXPECT_EQ(rows.size(), count);
    }
  }
}

// Each sample is uniform by itself, for every index and count: mean 1/2, variance 1/12, no correlation.
TEST(Strata, EverySetIsUniform) {
  for (const uint32_t count : {1u, 2u, 3u, 5u, 7u, 16u, 100u}) {
    double u = 0, v = 0, uu = 0, vv = 0, uv = 0;
    const uint32_t keys = 200000 / count;
    for (uint32_t key = 0; key < keys; ++key) {
      for (uint32_t i = 0; i < count; ++i) {
        const auto p = stratified_pair(i, count, hash32(key * 7919 + count));
        const double a = static_cast<double>(p.u) - 0.5, b = static_cast<double>(p.v) - 0.5;
        u += a, v += b, uu += a * a, vv += b * b, uv += a * b;
      }
    }
    const double n = static_cast<double>(keys) * count;
    const double sigma = std::sqrt(1 / 12.0 / n);  // of a mean; strata only make it smaller
    EXPECT_LT(std::abs(u / n), 4 * sigma) << count;
    EXPECT_LT(std::abs(v / n), 4 * sigma) << count;
    EXPECT_NEAR(uu / n, 1 / 12.0, 1e-3) << count;
    EXPECT_NEAR(vv / n, 1 / 12.0, 1e-3) << count;
    EXPECT_LT(std::abs(uv / n), 1.5e-3) << count;
  }
}

TEST(Strata, ARandomOrderIsAPermutationThatDependsOnTheKey) {
  for (const uint32_t count : {1u, 2u, 3u, 10u, 16u, 100u, 257u, 4096u}) {
    const std::vector<uint32_t> order = random_order(count, 77);
    const std::set<uint32_t> places(order.begin(), order.end());
    EXPECT_EQ(places.size(), count);
    EXPECT_EQ(*places.rbegin(), count - 1);
  }
  // Those of single indices, too, and every pair of places is equally likely: 12 pairs of 4 places over 12000
  // keys, 11 degrees of freedom.
  std::vector<int> pairs(16);
  for (uint32_t key = 0; key < 12000; ++key)
    ++pairs[shuffled(0, 4, hash32(key)) * 4 + shuffled(1, 4, hash32(key))];
  double chi_of_pairs = 0;
  for (size_t i = 0; i < 16; ++i) {
    if (i % 5 == 0)
      EXPECT_EQ(pairs[i], 0);
    else
      chi_of_pairs += (pairs[i] - 1000.0) * (pairs[i] - 1000.0) / 1000;
  }
  EXPECT_LT(chi_of_pairs, 31.3);  // significance 1/1000
  // Every place is equally likely: chi-squared of 10 places over 20000 keys, 9 degrees of freedom.
  double chi = 0;
  std::vector<int> hits(10);
  for (uint32_t key = 0; key < 20000; ++key) ++hits[random_order(10, hash32(key))[3]];
  for (const int h : hits) chi += (h - 2000.0) * (h - 2000.0) / 2000;
  EXPECT_LT(chi, 27.9);  // significance 1/1000
}

}  // namespace
}  // namespace vitral::test
