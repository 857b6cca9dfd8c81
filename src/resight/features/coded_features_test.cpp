// SPDX-License-Identifier: Apache-2.0
#include "resight/features/coded_features.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "resight/core/random.hpp"

namespace resight {
namespace {

std::vector<float> random_unit_rows(int rows, int dimension, std::uint64_t seed) {
  Rng rng(seed);
  std::vector<float> all;
  for (int r = 0; r < rows; ++r) {
    std::vector<double> row;
    double norm_sq = 0;
    for (int i = 0; i < dimension; ++i) {
      row.push_back(rng.below(3) == 0 ? 0.0 : rng.uniform() * rng.uniform());
      norm_sq += row.back() * row.back();
    }
    for (const double x : row) all.push_back(static_cast<float>(x / std::sqrt(norm_sq)));
  }
  return all;
}

TEST(DescriptorCode, KeepsUnitRowsWithinHalfAStep) {
  for (const int dimension : {128, 352}) {
    const std::vector<float> rows = random_unit_rows(50, dimension, 1);
    const std::vector<float> decoded = decode_descriptors(encode_descriptors(rows, dimension), dimension);
    ASSERT_EQ(decoded.size(), rows.size());
    for (int r = 0; r < 50; ++r) {
      double norm_sq = 0;
      double error_sq = 0;
      for (int i = 0; i < dimension; ++i) {
        const float value = decoded[r * dimension + i];
        norm_sq += value * value;
        error_sq += std::pow(value - rows[r * dimension + i], 2);
      }
      ASSERT_NEAR(norm_sq, 1, 1e-5);
      ASSERT_LT(std::sqrt(error_sq), 0.01);  // matching distinguishes distances of 0.1 and more
      ASSERT_GT(error_sq, 0);
    }
  }
}

TEST(DescriptorCode, IsExactForWhatItDecoded) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const std::vector<float> rows = random_unit_rows(30, 128, seed);
    const std::vector<std::uint8_t> codes = encode_descriptors(rows, 128);
    const std::vector<float> decoded = decode_descriptors(codes, 128);
    ASSERT_EQ(encode_descriptors(decoded, 128), codes);
    ASSERT_EQ(decode_descriptors(encode_descriptors(decoded, 128), 128), decoded);
  }
}

TEST(DescriptorCode, HandComputedRow) {
  const std::array<float, 3> row{0.6F, 0.0F, 0.8F};
  EXPECT_EQ(encode_descriptors(row, 3), (std::vector<std::uint8_t>{191, 0, 255}));
  const std::array<std::uint8_t, 2> code{3, 4};
  const std::vector<float> decoded = decode_descriptors(code, 2);
  EXPECT_FLOAT_EQ(decoded[0], 0.6F);
  EXPECT_FLOAT_EQ(decoded[1], 0.8F);
}

TEST(DescriptorCode, RefusesWhatHasNoCode) {
  const auto encode = [](std::vector<float> row) { (void)encode_descriptors(row, static_cast<int>(row.size())); };
  EXPECT_THROW(encode({0, 0}), std::invalid_argument);
  EXPECT_THROW(encode({-0.1F, 1}), std::invalid_argument);
  EXPECT_THROW(encode({1, std::numeric_limits<float>::infinity()}), std::invalid_argument);
  EXPECT_THROW(encode({std::numeric_limits<float>::quiet_NaN(), 1}), std::invalid_argument);
  EXPECT_THROW(encode({1, std::numeric_limits<float>::quiet_NaN()}), std::invalid_argument);
  EXPECT_THROW(encode({0.5F, std::numeric_limits<float>::quiet_NaN(), 0.3F, 0.2F}), std::invalid_argument);
  EXPECT_THROW((void)encode_descriptors(std::vector<float>{1, 0, 0}, 2), std::invalid_argument);
  EXPECT_TRUE(encode_descriptors({}, 128).empty());
  EXPECT_TRUE(encode_descriptors({}, 0).empty());
}

TEST(DescriptorCode, RecognisesRowsOfZeros) {
  EXPECT_FALSE(has_zero_row(std::vector<std::uint8_t>{0, 1, 255, 0}, 2));
  EXPECT_TRUE(has_zero_row(std::vector<std::uint8_t>{0, 1, 0, 0}, 2));
  EXPECT_FALSE(has_zero_row({}, 128));
}

TEST(CodedFeatures, KeepTheRestOfTheSet) {
  FeatureSet set{
      .type = FeatureType::kShot, .dimension = 352, .points = {{1, 2, 3}}, .normals = {{0, 0, 1}}, .descriptors = {}};
  set.descriptors = random_unit_rows(1, 352, 7);
  const CodedFeatures coded = encode(set);
  EXPECT_EQ(coded.type, set.type);
  EXPECT_EQ(coded.dimension, 352);
  EXPECT_EQ(coded.points, set.points);
  EXPECT_EQ(coded.normals, set.normals);
  EXPECT_EQ(coded.code(0).size(), 352U);
  const FeatureSet decoded = decode(coded);
  EXPECT_EQ(decoded.type, set.type);
  EXPECT_EQ(decoded.dimension, 352);
  EXPECT_EQ(decoded.points, set.points);
  EXPECT_EQ(decoded.normals, set.normals);
  EXPECT_NE(decoded.descriptors, set.descriptors);
  EXPECT_EQ(encode(decoded).codes, coded.codes);
}

}  // namespace
}  // namespace resight
