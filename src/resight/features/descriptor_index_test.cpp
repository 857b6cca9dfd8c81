// SPDX-License-Identifier: Apache-2.0
#include "resight/features/descriptor_index.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "resight/core/random.hpp"
#include "resight/features/coded_features.hpp"

namespace resight {
namespace {

// Unit vectors around random centres, because real descriptors form clusters, unlike uniform noise.
std::vector<float> make_clustered(int n, int dimension, int num_centers, double spread, std::uint64_t seed,
                                  std::uint64_t centers_seed = 7) {
  std::vector<float> result;
  for (int i = 0; i < n; ++i) {
    Rng rng = Rng::stream(seed, static_cast<std::uint64_t>(i));
    Rng center = Rng::stream(centers_seed, rng.below(static_cast<std::uint32_t>(num_centers)));
    std::vector<double> row(static_cast<std::size_t>(dimension));
    double norm_sq = 0;
    for (double& x : row) {
      x = center.normal() + spread * rng.normal();
      norm_sq += x * x;
    }
    for (const double x : row) result.push_back(static_cast<float>(x / std::sqrt(norm_sq)));
  }
  return result;
}

std::vector<DescriptorMatch> brute_force(std::span<const float> data, std::span<const float> query, int dimension,
                                         int k) {
  std::vector<DescriptorMatch> all;
  for (std::size_t i = 0; i * static_cast<std::size_t>(dimension) < data.size(); ++i) {
    double sum = 0;
    for (int d = 0; d < dimension; ++d) {
      const double difference =
          static_cast<double>(data[i * static_cast<std::size_t>(dimension) + static_cast<std::size_t>(d)]) -
          query[static_cast<std::size_t>(d)];
      sum += difference * difference;
    }
    all.push_back({static_cast<int>(i), static_cast<float>(sum)});
  }
  std::stable_sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.distance_sq < b.distance_sq; });
  all.resize(std::min(all.size(), static_cast<std::size_t>(k)));
  return all;
}

constexpr int kDimension = 32;

TEST(DescriptorIndex, ExactSearchEqualsBruteForce) {
  const auto data = make_clustered(3000, kDimension, 50, 0.5, 1);
  const auto queries = make_clustered(300, kDimension, 50, 0.5, 2);
  const DescriptorIndex index(data, kDimension);
  const auto found = index.search(queries, 3);
  ASSERT_EQ(found.size(), 900U);
  for (std::size_t q = 0; q < 300; ++q) {
    const auto expected = brute_force(data, std::span(queries).subspan(q * kDimension, kDimension), kDimension, 3);
    for (std::size_t j = 0; j < 3; ++j) EXPECT_NEAR(found[q * 3 + j].distance_sq, expected[j].distance_sq, 1e-6);
  }
}

TEST(DescriptorIndex, CellsFindNearlyAllNearestNeighbors) {
  const auto data = make_clustered(20000, kDimension, 400, 0.6, 3);
  const auto queries = make_clustered(500, kDimension, 400, 0.6, 4);
  const DescriptorIndex cells(data, kDimension, {.num_probes = 32, .exact_below = 0});
  const DescriptorIndex exact(data, kDimension, {.search = IndexSearch::kExact});
  const auto found = cells.search(queries, 1);
  const auto truth = exact.search(queries, 1);
  int hits = 0;
  for (std::size_t q = 0; q < 500; ++q) hits += found[q].index == truth[q].index ? 1 : 0;
  EXPECT_GE(hits, 490);
}

// Descriptors that differ in few directions are found by these directions, with their exact distances.
TEST(DescriptorIndex, FewComponentsFindWhatFewTellApart) {
  const auto families = make_clustered(20000, kDimension, 12, 0.05, 3);
  const auto queries = make_clustered(300, kDimension, 12, 0.05, 4);
  const DescriptorIndex few(families, kDimension, {.num_probes = 16, .exact_below = 0, .num_components = 14});
  const DescriptorIndex exact(families, kDimension, {.search = IndexSearch::kExact});
  const auto found = few.search(queries, 2);
  const auto truth = exact.search(queries, 2);
  double sum_found = 0;
  double sum_truth = 0;
  for (std::size_t q = 0; q < 300; ++q) {
    const auto index = static_cast<std::size_t>(found[2 * q].index);
    const auto nearest = brute_force(std::span(families).subspan(index * kDimension, kDimension),
                                     std::span(queries).subspan(q * kDimension, kDimension), kDimension, 1);
    EXPECT_NEAR(found[2 * q].distance_sq, nearest[0].distance_sq, 1e-6);
    EXPECT_LE(found[2 * q].distance_sq, found[2 * q + 1].distance_sq);
    sum_found += std::sqrt(found[2 * q].distance_sq);
    sum_truth += std::sqrt(truth[2 * q].distance_sq);
  }
  EXPECT_LT(sum_found, 1.05 * sum_truth);
}

// Then whole descriptors are compared.
TEST(DescriptorIndex, MoreComponentsThanHalfTheDimensionAreIgnored) {
  const auto data = make_clustered(400, kDimension, 10, 0.3, 3);
  const auto queries = make_clustered(50, kDimension, 10, 0.3, 4);
  const auto expected = DescriptorIndex(data, kDimension, {.exact_below = 0}).search(queries, 2);
  for (const int components : {kDimension / 2 + 1, std::numeric_limits<int>::max()}) {
    const DescriptorIndex index(data, kDimension, {.exact_below = 0, .num_components = components});
    const auto found = index.search(queries, 2);
    for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_EQ(found[i].index, expected[i].index);
  }
}

// As many descriptors as a single object has, with the options that the recogniser uses for SHOT.
TEST(DescriptorIndex, ASingleObjectsDescriptorsAreFoundWithoutComparingAll) {
  constexpr std::size_t kLong = 352;
  const auto object = make_clustered(3000, kLong, 40, 0.1, 3);
  const auto queries = make_clustered(200, kLong, 40, 0.1, 4);
  const DescriptorIndex cells(object, kLong, {.num_probes = 8, .exact_below = 1024, .num_components = 64});
  const DescriptorIndex exact(object, kLong, {.exact_below = 8192});
  const auto found = cells.search(queries, 1);
  const auto truth = exact.search(queries, 1);
  double sum_found = 0;
  double sum_truth = 0;
  for (std::size_t q = 0; q < found.size(); ++q) {
    sum_found += std::sqrt(found[q].distance_sq);
    sum_truth += std::sqrt(truth[q].distance_sq);
  }
  EXPECT_LT(sum_found, 1.02 * sum_truth);
}

TEST(DescriptorIndex, AllCellsProbedIsExact) {
  const auto data = make_clustered(4000, kDimension, 40, 0.6, 5);
  const auto queries = make_clustered(200, kDimension, 40, 0.6, 6);
  const DescriptorIndex cells(data, kDimension, {.num_cells = 60, .num_probes = 60, .exact_below = 0});
  const DescriptorIndex exact(data, kDimension, {.search = IndexSearch::kExact});
  const auto found = cells.search(queries, 4);
  const auto truth = exact.search(queries, 4);
  for (std::size_t i = 0; i < found.size(); ++i) EXPECT_NEAR(found[i].distance_sq, truth[i].distance_sq, 1e-6);
}

TEST(DescriptorIndex, TiesGoToTheLowerIndex) {
  std::vector<float> data;
  for (int i = 0; i < 10; ++i) data.insert(data.end(), {1.0F, 0.0F});
  const auto found = DescriptorIndex(data, 2).search(std::vector<float>{1.0F, 0.0F}, 3);
  EXPECT_EQ(found[0].index, 0);
  EXPECT_EQ(found[1].index, 1);
  EXPECT_EQ(found[2].index, 2);
}

TEST(DescriptorIndex, TiesGoToTheLowerIndexWhereverTheCopiesStand) {
  constexpr std::size_t kCopies = 15;
  auto data = make_clustered(2000, 128, 100, 0.6, 10);
  const std::vector<float> once = data;
  for (std::size_t copy = 1; copy < kCopies; ++copy) data.insert(data.end(), once.begin(), once.end());
  const auto queries = make_clustered(100, 128, 100, 0.6, 11);
  for (const int exact_below : {0, 1000000}) {
    const auto found =
        DescriptorIndex(data, 128, {.num_cells = 50, .num_probes = 50, .exact_below = exact_below}).search(queries, 3);
    for (std::size_t q = 0; q < 100; ++q) {
      const int first = found[3 * q].index;
      ASSERT_LT(first, 2000);
      ASSERT_EQ(found[3 * q + 1].index, first + 2000);
      ASSERT_EQ(found[3 * q + 2].index, first + 4000);
    }
  }
}

TEST(DescriptorIndex, MoreThanThereAreIsFilledUp) {
  const auto found = DescriptorIndex(std::vector<float>{1, 0, 0, 1}, 2).search(std::vector<float>{1, 0}, 4);
  ASSERT_EQ(found.size(), 4U);
  EXPECT_EQ(found[0].index, 0);
  EXPECT_EQ(found[1].index, 1);
  EXPECT_EQ(found[2].index, -1);
  EXPECT_EQ(found[3].index, -1);
}

TEST(DescriptorIndex, AnEmptySetFindsNothing) {
  const DescriptorIndex index({}, 4);
  EXPECT_EQ(index.size(), 0U);
  const auto found = index.search(std::vector<float>{1, 0, 0, 0}, 2);
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0].index, -1);
  EXPECT_TRUE(index.search({}, 2).empty());
}

TEST(DescriptorIndex, SameBytesOnAnyNumberOfThreads) {
  const auto data = make_clustered(12000, kDimension, 100, 0.6, 8);
  const auto queries = make_clustered(700, kDimension, 100, 0.6, 9);
  for (const std::optional<int> num_components : {std::optional<int>(), std::optional(12)}) {
    const auto run = [&](int num_threads) {
      return DescriptorIndex(data, kDimension,
                             {.exact_below = 0, .num_components = num_components, .num_threads = num_threads})
          .search(queries, 2);
    };
    const auto serial = run(1);
    const auto parallel = run(2);
    ASSERT_EQ(serial.size(), parallel.size());
    for (std::size_t i = 0; i < serial.size(); ++i) {
      EXPECT_EQ(serial[i].index, parallel[i].index);
      EXPECT_EQ(serial[i].distance_sq, parallel[i].distance_sq);
    }
  }
}

TEST(DescriptorIndex, RefusesNonsense) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW(DescriptorIndex(std::vector<float>{1, 2, 3}, 2), std::invalid_argument);
  EXPECT_THROW(DescriptorIndex(std::vector<float>{nan, 2}, 2), std::invalid_argument);
  EXPECT_THROW(DescriptorIndex({}, 0), std::invalid_argument);
  EXPECT_THROW(DescriptorIndex{DescriptorRows{}}, std::invalid_argument);
  const DescriptorIndex index(std::vector<float>{1, 0}, 2);
  EXPECT_THROW((void)index.search(std::vector<float>{nan, 0}, 1), std::invalid_argument);
  EXPECT_THROW((void)index.search(std::vector<float>{1, 0}, 0), std::invalid_argument);
  EXPECT_THROW((void)index.search(std::vector<float>{1, 0, 0}, 1), std::invalid_argument);
}

TEST(DescriptorIndex, CodesAreFoundLikeTheFloatsTheyStandFor) {
  constexpr int kRows = 3000;
  std::vector<float> data = make_clustered(kRows, kDimension, 60, 0.3, 1);
  for (float& value : data) value = std::abs(value);
  const std::vector<std::uint8_t> codes = encode_descriptors(data, kDimension);
  const std::vector<float> decoded = decode_descriptors(codes, kDimension);
  std::vector<const std::uint8_t*> rows;
  for (int i = 0; i < kRows; ++i) rows.push_back(codes.data() + i * kDimension);
  const std::vector<float> queries = make_clustered(200, kDimension, 60, 0.3, 2);
  for (const int exact_below : {100, 10000})
    for (const std::optional<int> components : {std::optional<int>(), std::optional(8)}) {
      const DescriptorIndexOptions options{.exact_below = exact_below, .num_components = components};
      const auto expected = DescriptorIndex(decoded, kDimension, options).search(queries, 3);
      const DescriptorIndex index(DescriptorRows(rows, kDimension), options);
      EXPECT_EQ(index.size(), static_cast<std::size_t>(kRows));
      const auto found = index.search(queries, 3);
      for (std::size_t i = 0; i < expected.size(); ++i) {
        ASSERT_EQ(found[i].index, expected[i].index);
        ASSERT_EQ(found[i].distance_sq, expected[i].distance_sq);
      }
    }
}

// Whole descriptors decide among the candidates found by components, whatever their order.
TEST(DescriptorIndex, CandidatesAreSettledByWholeDescriptors) {
  constexpr int kRows = 15;  // At most the number of candidates that are compared exactly, so that all of them are.
  const auto data = make_clustered(kRows, kDimension, kRows, 0.6, 21);
  const auto queries = make_clustered(200, kDimension, kRows, 0.9, 22);
  const DescriptorIndex few(data, kDimension, {.num_cells = 2, .num_probes = 2, .exact_below = 0, .num_components = 2});
  const auto found = few.search(queries, 2);
  for (std::size_t q = 0; q < 200; ++q) {
    const auto expected = brute_force(data, std::span(queries).subspan(q * kDimension, kDimension), kDimension, 2);
    for (std::size_t j = 0; j < 2; ++j) {
      ASSERT_EQ(found[2 * q + j].index, expected[j].index);
      ASSERT_NEAR(found[2 * q + j].distance_sq, expected[j].distance_sq, 1e-5);
    }
  }
}

}  // namespace
}  // namespace resight
