// SPDX-License-Identifier: Apache-2.0
#include "resight/segmentation/noisy_planes.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <stdexcept>

#include "resight/core/random.hpp"

namespace resight {
namespace {

constexpr float kNoise_m = 0.005F;  // As the noise model has it.

// A cloud seen from above, with noise along z.
struct NoisyCloud {
  std::vector<Eigen::Vector3f> points;
  std::vector<Eigen::Vector3f> normals;
  Rng rng{7};

  // `noise_scale`: true noise over that of the model. Normals are off by 25 deg in the mean.
  void add_square(float width_m, float height_m, int count, double noise_scale) {
    for (int i = 0; i < count; ++i) {
      const double z = height_m + noise_scale * static_cast<double>(kNoise_m) * rng.normal();
      const auto half = static_cast<double>(width_m) / 2;
      points.emplace_back(Eigen::Vector3d(rng.uniform(-half, half), rng.uniform(-half, half), z).cast<float>());
      normals.emplace_back(Eigen::Vector3d(0.35 * rng.normal(), 0.35 * rng.normal(), 1).normalized().cast<float>());
    }
  }
  void add_clutter(float width_m, float height_m, int count) {
    for (int i = 0; i < count; ++i) {
      const auto half = static_cast<double>(width_m) / 2;
      points.emplace_back(
          Eigen::Vector3d(rng.uniform(-half, half), rng.uniform(-half, half), rng.uniform(0, height_m)).cast<float>());
      normals.emplace_back(Eigen::Vector3d(rng.normal(), rng.normal(), rng.normal()).normalized().cast<float>());
    }
  }
  [[nodiscard]] std::vector<ScenePlane> find() const {
    std::vector<int> all(points.size());
    std::iota(all.begin(), all.end(), 0);
    return find_noisy_planes(points, normals, std::vector<float>(points.size(), kNoise_m), all);
  }
  [[nodiscard]] double share_on(const ScenePlane& plane, std::size_t begin, std::size_t end) const {
    int on = 0;
    for (std::size_t i = begin; i < end; ++i)
      on += plane.holds(points[i], normals[i], plane.tolerance_m(kNoise_m), ScenePlane::kMinNoisyDot) ? 1 : 0;
    return on / static_cast<double>(end - begin);
  }
};

TEST(FindNoisyPlanes, FindsAFloorTwiceAsNoisyAsTheModelAndLeavesWhatStandsOnIt) {
  NoisyCloud cloud;
  cloud.add_square(1.5F, 0, 4000, 2);
  cloud.add_square(0.15F, 0.12F, 250, 1);  // The top of a box.
  const auto planes = cloud.find();
  ASSERT_EQ(planes.size(), 1U);
  EXPECT_GT(planes[0].normal.z(), 0.999F);
  EXPECT_NEAR(planes[0].offset, 0, 0.001);
  EXPECT_NEAR(planes[0].noise_scale, 2, 0.2);
  EXPECT_NEAR(planes[0].extent_m, 1.5 * std::sqrt(2.0), 0.1);
  EXPECT_GT(cloud.share_on(planes[0], 0, 4000), 0.9);
  EXPECT_EQ(cloud.share_on(planes[0], 4000, 4250), 0);
}

TEST(FindNoisyPlanes, FindsNoPlaneThroughClutter) {
  NoisyCloud cloud;
  cloud.add_clutter(1.5F, 0.5F, 5000);
  EXPECT_TRUE(cloud.find().empty());
}

TEST(FindNoisyPlanes, LeavesSmallPlanesAlone) {
  NoisyCloud cloud;
  cloud.add_square(0.25F, 0, 2000, 1);
  EXPECT_TRUE(cloud.find().empty());
}

TEST(FindNoisyPlanes, FindsFloorAndShelf) {
  NoisyCloud cloud;
  cloud.add_square(1.5F, 0, 3000, 1.5);
  cloud.add_square(0.8F, 0.6F, 1500, 1);
  EXPECT_EQ(cloud.find().size(), 2U);
}

TEST(FindNoisyPlanes, IsRepeatable) {
  NoisyCloud cloud;
  cloud.add_square(1.5F, 0, 3000, 2);
  cloud.add_clutter(1.0F, 0.3F, 200);
  const auto first = cloud.find();
  const auto second = cloud.find();
  ASSERT_EQ(first.size(), second.size());
  for (std::size_t i = 0; i < first.size(); ++i) {
    EXPECT_EQ(first[i].normal, second[i].normal);
    EXPECT_EQ(first[i].offset, second[i].offset);
  }
}

TEST(FindNoisyPlanes, TakesAnEmptyCloudAndRefusesOtherNoise) {
  EXPECT_TRUE(find_noisy_planes({}, {}, {}, {}).empty());
  const std::vector<Eigen::Vector3f> one(1, Eigen::Vector3f::UnitZ());
  EXPECT_THROW((void)find_noisy_planes(one, one, {}, {0}), std::invalid_argument);
}

}  // namespace
}  // namespace resight
