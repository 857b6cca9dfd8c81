// SPDX-License-Identifier: Apache-2.0
#include "resight/geometry/spherical_bins.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <stdexcept>

#include "resight/core/random.hpp"

namespace resight {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

TEST(SphericalBins, TwoDegreesAre90By180) {
  const SphericalBins bins;
  EXPECT_EQ(bins.num_bins(), 90 * 180);
  EXPECT_EQ(SphericalBins(2 * kDegree).num_bins(), 90 * 180);
}

TEST(SphericalBins, SizeIsShrunkToDividePi) {
  const SphericalBins bins(50 * kDegree);  // 180 / 50 = 3.6: 4 rows of 45 deg
  EXPECT_EQ(bins.num_bins(), 4 * 8);
}

TEST(SphericalBins, AgreesWithTheAnglesInDoublePrecision) {
  Rng rng(3);
  const SphericalBins bins;
  const double size = 2 * kDegree;
  int num_checked = 0;
  for (int i = 0; i < 20000; ++i) {
    const Eigen::Vector3d p{rng.uniform(-2, 2), rng.uniform(-2, 2), rng.uniform(-2, 2)};
    const double theta = std::acos(p.y() / p.norm()) / size;
    const double phi = (std::numbers::pi + std::atan2(p.x(), p.z())) / size;
    const auto near_border = [](double x) { return std::abs(x - std::round(x)) < 1e-3; };
    if (near_border(theta) || near_border(phi)) continue;  // single and double precision may differ there
    EXPECT_EQ(bins.bin(p.cast<float>()), static_cast<int>(theta) * 180 + static_cast<int>(phi));
    ++num_checked;
  }
  EXPECT_GT(num_checked, 15000);
}

TEST(SphericalBins, KnowsTheQuadrants) {
  // arctan(y/x), as in the paper, would assign opposite directions to one bin.
  const SphericalBins bins;
  EXPECT_NE(bins.bin({1, 0.3F, 1}), bins.bin({-1, 0.3F, -1}));
  EXPECT_NE(bins.bin({1, 0.3F, -1}), bins.bin({-1, 0.3F, 1}));
}

TEST(SphericalBins, DependsOnTheDirectionOnly) {
  const SphericalBins bins;
  Rng rng(5);
  for (int i = 0; i < 1000; ++i) {
    const Eigen::Vector3f p{static_cast<float>(rng.uniform(-1, 1)), static_cast<float>(rng.uniform(-1, 1)),
                            static_cast<float>(rng.uniform(-1, 1))};
    EXPECT_EQ(bins.bin(p), bins.bin(4 * p));  // multiplying by 4 is exact
  }
}

TEST(SphericalBins, DoNotDegenerateInTheMiddleOfTheImage) {
  // In the view of a Kinect (62 x 49 deg), all inner bins contain about the same number of pixels.
  const SphericalBins bins;
  std::map<int, int> num_pixels;
  for (int v = 0; v < 480; ++v) {
    for (int u = 0; u < 640; ++u)
      ++num_pixels[bins.bin({(static_cast<float>(u) - 319.5F) / 525, (static_cast<float>(v) - 239.5F) / 525, 1})];
  }
  const int center = num_pixels[bins.bin({0.01F, 0.01F, 1})];
  EXPECT_GT(center, 300);  // a square of 18 px
  EXPECT_LT(center, 380);
  EXPECT_GT(num_pixels.size(), 31U * 24U - 1U);
}

TEST(SphericalBins, StaysInRangeEverywhere) {
  for (const double size : {0.001, 2 * kDegree, 1.0, std::numbers::pi / 2}) {
    const SphericalBins bins(size);
    for (const float x : {-1.0F, -0.0F, 0.0F, 1e-20F, 1.0F})
      for (const float y : {-1.0F, -0.0F, 0.0F, 1e-20F, 1.0F})
        for (const float z : {-1.0F, -0.0F, 0.0F, 1e-20F, 1.0F}) {
          const int bin = bins.bin({x, y, z});
          EXPECT_LT(bin, bins.num_bins());
          if (x == 0 && y == 0 && z == 0) {
            EXPECT_EQ(bin, -1);
          } else if (std::abs(x) == 1 || std::abs(y) == 1 || std::abs(z) == 1) {
            EXPECT_GE(bin, 0) << x << " " << y << " " << z;
          }
        }
  }
}

TEST(SphericalBins, NoBinForWhatHasNoDirection) {
  const SphericalBins bins;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float inf = std::numeric_limits<float>::infinity();
  EXPECT_EQ(bins.bin({0, 0, 0}), -1);
  EXPECT_EQ(bins.bin({nan, 0, 1}), -1);
  EXPECT_EQ(bins.bin({0, nan, 1}), -1);
  EXPECT_EQ(bins.bin({0, 0, nan}), -1);
  EXPECT_EQ(bins.bin({inf, 0, 1}), -1);
}

TEST(SphericalBins, RefusesNonsense) {
  EXPECT_THROW(SphericalBins(0), std::invalid_argument);
  EXPECT_THROW(SphericalBins(-0.1), std::invalid_argument);
  EXPECT_THROW(SphericalBins(2), std::invalid_argument);
  EXPECT_THROW(SphericalBins(std::nan("")), std::invalid_argument);
}

}  // namespace
}  // namespace resight
