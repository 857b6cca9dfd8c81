// SPDX-License-Identifier: Apache-2.0
#include "resight/geometry/lens.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <vector>

namespace resight {
namespace {

using testing::HasSubstr;

LensDistortion lens(std::string_view model, std::vector<double> coefficients) {
  const auto made = LensDistortion::make(model, coefficients);
  EXPECT_TRUE(made.ok()) << made.error().message;
  return made.ok() ? *made : LensDistortion();
}

TEST(LensDistortion, ZeroCoefficientsAreNone) {
  EXPECT_TRUE(lens("plumb_bob", {0, 0, 0, 0, 0}).is_none());
  EXPECT_TRUE(lens("anything", {}).is_none());
  EXPECT_EQ(*LensDistortion().distort({0.3, -0.2}), Eigen::Vector2d(0.3, -0.2));
}

// By the formulas of OpenCV's documentation, worked out by hand at (0.3, -0.2): r^2 = 0.13.
TEST(LensDistortion, PlumbBob) {
  const double r2 = 0.13;
  const double radial = 1 + 0.2 * r2 - 0.5 * r2 * r2 + 0.7 * r2 * r2 * r2;
  const double x = 0.3 * radial + 2 * 0.01 * 0.3 * -0.2 - 0.02 * (r2 + 2 * 0.09);
  const double y = -0.2 * radial + 0.01 * (r2 + 2 * 0.04) + 2 * -0.02 * 0.3 * -0.2;
  EXPECT_LT((*lens("plumb_bob", {0.2, -0.5, 0.01, -0.02, 0.7}).distort({0.3, -0.2}) - Eigen::Vector2d(x, y)).norm(),
            1e-12);
}

// librealsense writes the models of its recordings with these names.
// In two of them, tangential terms act on the place that the radial ones give.
TEST(LensDistortion, NamesOfLibrealsense) {
  const std::vector<double> k = {0.2, -0.5, 0.01, -0.02, 0.7};
  const Eigen::Vector2d ideal(0.3, -0.2);
  EXPECT_EQ(*lens("Brown Conrady", k).distort(ideal), *lens("plumb_bob", k).distort(ideal));
  EXPECT_EQ(*lens("Kannala Brandt4", {0.1, 0, 0, 0}).distort(ideal),
            *lens("equidistant", {0.1, 0, 0, 0}).distort(ideal));
  const double r2 = 0.13;
  const double radial = 1 + 0.2 * r2 - 0.5 * r2 * r2 + 0.7 * r2 * r2 * r2;
  const Eigen::Vector2d bent = radial * ideal;
  const double x = bent.x() + 2 * 0.01 * bent.x() * bent.y() - 0.02 * (r2 + 2 * bent.x() * bent.x());
  const double y = bent.y() + 2 * -0.02 * bent.x() * bent.y() + 0.01 * (r2 + 2 * bent.y() * bent.y());
  for (const char* name : {"Modified Brown Conrady", "Inverse Brown Conrady"})
    EXPECT_LT((*lens(name, k).distort(ideal) - Eigen::Vector2d(x, y)).norm(), 1e-12) << name;
}

TEST(LensDistortion, RationalIsARatioOfPolynomials) {
  const std::vector<double> k = {0.2, -0.5, 0, 0, 0.7};
  std::vector<double> rational = k;
  rational.insert(rational.end(), k.begin(), k.begin() + 2);
  rational.push_back(0.7);
  EXPECT_LT((*lens("rational_polynomial", rational).distort({0.3, -0.2}) - Eigen::Vector2d(0.3, -0.2)).norm(), 1e-12)
      << "equal numerator and denominator cancel";
}

TEST(LensDistortion, EquidistantMapsAngles) {
  const double theta = std::atan(std::sqrt(0.13));
  const double bent = theta * (1 + 0.1 * theta * theta);
  const Eigen::Vector2d expected = Eigen::Vector2d(0.3, -0.2).normalized() * bent;
  EXPECT_LT((*lens("equidistant", {0.1, 0, 0, 0}).distort({0.3, -0.2}) - expected).norm(), 1e-12);
  EXPECT_LT(lens("equidistant", {0.1, 0, 0, 0}).distort({0, 0})->norm(), 1e-12);
}

TEST(LensDistortion, FoldedRaysHaveNoPixel) {
  EXPECT_TRUE(lens("plumb_bob", {-0.5, 0, 0, 0}).distort({0.2, 0}).has_value());
  EXPECT_FALSE(lens("plumb_bob", {-0.5, 0, 0, 0}).distort({1.5, 0}).has_value());
}

TEST(LensDistortion, RefusesWhatItDoesNotKnow) {
  EXPECT_THAT(LensDistortion::make("fov", std::vector<double>{0.9}).error().message,
              HasSubstr("'fov' is not supported"));
  EXPECT_THAT(LensDistortion::make("plumb_bob", std::vector<double>{0.9}).error().message, HasSubstr("not supported"));
  EXPECT_THAT(LensDistortion::make("", std::vector<double>{0, 0, 0, std::nan("")}).error().message, HasSubstr("NaN"));
}

}  // namespace
}  // namespace resight
