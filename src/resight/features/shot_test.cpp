// SPDX-License-Identifier: Apache-2.0
#include "resight/features/shot.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <numbers>
#include <set>
#include <stdexcept>

#include "resight/core/random.hpp"
#include "resight/features/shot_frame.hpp"
#include "resight/features/support_grid.hpp"

namespace resight {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr double kPi = std::numbers::pi;

/// A bumpy closed surface of about 12 cm with normals. In places it is denser than real surfaces.
PointCloud bumpy_object(int num_points, std::uint64_t seed) {
  const auto radius = [](const Eigen::Vector3d& d) {
    return 0.06 * (1 + 0.25 * std::sin(5 * d.x() + 1) * std::cos(4 * d.y()) + 0.15 * std::sin(9 * d.z() + 3 * d.x()));
  };
  PointCloud cloud;
  Rng rng(seed);
  for (int i = 0; i < num_points; ++i) {
    const Eigen::Vector3d d = Eigen::Vector3d{rng.normal(), rng.normal(), rng.normal()}.normalized();
    const Eigen::Vector3d a = d.unitOrthogonal();
    const Eigen::Vector3d b = d.cross(a);
    const auto at = [&](const Eigen::Vector3d& direction) -> Eigen::Vector3d {
      return direction.normalized() * radius(direction.normalized());
    };
    constexpr double kStep = 1e-4;
    const Eigen::Vector3d normal =
        (at(d + kStep * a) - at(d - kStep * a)).cross(at(d + kStep * b) - at(d - kStep * b)).normalized();
    cloud.points.push_back((at(d) + 0.0005 * rng.normal() * normal).cast<float>());
    cloud.normals.push_back(normal.cast<float>());
  }
  return cloud;
}

PointCloud every_nth(const PointCloud& cloud, int n) {
  std::vector<int> indices;
  for (int i = 0; i < static_cast<int>(cloud.size()); i += n) indices.push_back(i);
  return select(cloud, indices);
}

struct Twin {
  bool exists = false;
  bool is_tie = false;  ///< Equally many points lie on either side of an axis, so another rule decides its sign.
  std::vector<double> descriptor;
};

/// SHOT by its definition: double precision, all points compared, library functions for angles. Does not detect
/// degenerate frames.
Twin shot_by_definition(const PointCloud& support, const Eigen::Vector3d& center, double radius) {
  std::vector<Eigen::Vector3d> offsets;
  std::vector<Eigen::Vector3d> normals;
  for (std::size_t i = 0; i < support.size(); ++i) {
    const Eigen::Vector3d offset = support.points[i].cast<double>() - center;
    if (offset.norm() > radius || offset.norm() < 1e-12) continue;
    offsets.push_back(offset);
    normals.push_back(support.normals[i].cast<double>());
  }
  if (offsets.size() < 10) return {};
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  double weight = 0;
  for (const auto& d : offsets) {
    covariance += (radius - d.norm()) * d * d.transpose();
    weight += radius - d.norm();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance / weight);
  bool is_tie = false;
  const auto disambiguate = [&](const Eigen::Vector3d& axis) -> Eigen::Vector3d {
    const auto num_ahead = std::ranges::count_if(offsets, [&](const auto& d) { return d.dot(axis) >= 0; });
    is_tie = is_tie || 2 * num_ahead == static_cast<long>(offsets.size());
    return 2 * num_ahead > static_cast<long>(offsets.size()) ? axis : Eigen::Vector3d(-axis);
  };
  const Eigen::Vector3d x_axis = disambiguate(solver.eigenvectors().col(2));
  const Eigen::Vector3d z_axis = disambiguate(solver.eigenvectors().col(0));
  const Eigen::Vector3d y_axis = z_axis.cross(x_axis);

  Twin twin{true, is_tie, std::vector<double>(352, 0.0)};
  for (std::size_t i = 0; i < offsets.size(); ++i) {
    const double x = offsets[i].dot(x_axis);
    const double y = offsets[i].dot(y_axis);
    const double z = offsets[i].dot(z_axis);
    const double r = offsets[i].norm();
    const double inclination = std::acos(std::clamp(z / r, -1.0, 1.0));
    const double cosine = std::clamp(normals[i].dot(z_axis), -1.0, 1.0);
    const int octant = std::clamp(static_cast<int>(std::floor((std::atan2(y, x) + kPi) / (kPi / 4))), 0, 7);
    const int outer = r > radius / 2 ? 1 : 0;
    const int above = inclination < kPi / 2 ? 1 : 0;
    const int bin = static_cast<int>(std::lround((1 + cosine) * 5));
    const auto slot = [&](int a, int o, int e, int c) -> double& {
      return twin.descriptor[((a * 2 + o) * 2 + e) * 11 + c];
    };
    // Signed distances to the centre of the own bin, in bins.
    const double d_azimuth = (std::atan2(y, x) + kPi) / (kPi / 4) - octant - 0.5;
    const double d_radius = (r - (outer == 1 ? 0.75 : 0.25) * radius) / (radius / 2);
    const double d_above = ((above == 1 ? kPi / 4 : 3 * kPi / 4) - inclination) / (kPi / 2);
    const double d_cosine = (1 + cosine) * 5 - bin;
    slot(octant, outer, above, bin) +=
        (1 - std::abs(d_azimuth)) + (1 - std::abs(d_radius)) + (1 - std::abs(d_above)) + (1 - std::abs(d_cosine));
    slot((octant + (d_azimuth > 0 ? 1 : 7)) % 8, outer, above, bin) += std::abs(d_azimuth);
    if (outer == 0 && d_radius > 0) slot(octant, 1, above, bin) += d_radius;
    if (outer == 1 && d_radius < 0) slot(octant, 0, above, bin) -= d_radius;
    if (above == 0 && d_above > 0) slot(octant, outer, 1, bin) += d_above;
    if (above == 1 && d_above < 0) slot(octant, outer, 0, bin) -= d_above;
    if (d_cosine > 0 && bin < 10) slot(octant, outer, above, bin + 1) += d_cosine;
    if (d_cosine < 0 && bin > 0) slot(octant, outer, above, bin - 1) -= d_cosine;
  }
  double norm_sq = 0;
  for (const double value : twin.descriptor) norm_sq += value * value;
  for (double& value : twin.descriptor) value /= std::sqrt(norm_sq);
  return twin;
}

double cosine_between(std::span<const float> a, std::span<const double> b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}
double cosine_between(std::span<const float> a, std::span<const float> b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += static_cast<double>(a[i]) * b[i];
  return sum;
}

const ShotOptions kDescribeFlat{.min_surface_variation = 0};

TEST(DescribeShot, AgreesWithTheDefinitionInDoublePrecision) {
  const PointCloud support = bumpy_object(4000, 1);
  const PointCloud keypoints = every_nth(support, 10);
  for (const double radius_m : {0.02, 0.04}) {
    std::vector<int> kept;
    ShotOptions options = kDescribeFlat;
    options.support_radius_m = radius_m;
    const FeatureSet features = describe_shot(support, keypoints, options, &kept);
    ASSERT_EQ(features.dimension, 352);
    ASSERT_EQ(kept.size(), features.size());
    ASSERT_GT(features.size(), keypoints.size() * 95 / 100);
    int num_equal = 0;
    int num_ties = 0;
    for (std::size_t i = 0; i < features.size(); ++i) {
      const Twin twin = shot_by_definition(support, keypoints.points[kept[i]].cast<double>(), radius_m);
      ASSERT_TRUE(twin.exists);
      num_ties += twin.is_tie ? 1 : 0;
      num_equal += !twin.is_tie && cosine_between(features.descriptor(i), twin.descriptor) > 0.999 ? 1 : 0;
    }
    // In the remaining cases, the vote is so close that the rounding of one projection flips an axis.
    EXPECT_GE(num_equal, (static_cast<int>(features.size()) - num_ties) * 99 / 100);
    EXPECT_LT(num_ties, static_cast<int>(features.size()) / 10);
  }
}

TEST(DescribeShot, GivesUnitDescriptorsOfTheKeptKeypoints) {
  const PointCloud support = bumpy_object(3000, 2);
  PointCloud keypoints = every_nth(support, 25);
  keypoints.points[3] = {kNan, 0, 0};
  keypoints.points[7] = {5, 5, 5};
  std::vector<int> kept{99};
  const FeatureSet features = describe_shot(support, keypoints, kDescribeFlat, &kept);
  EXPECT_EQ(features.type, FeatureType::kShot);
  // All that have a frame; on a closed surface, hardly any has none.
  const SupportGrid grid(support, kDescribeFlat.support_radius_m);
  Neighborhood neighborhood;
  std::vector<int> with_frame;
  for (int i = 0; i < static_cast<int>(keypoints.size()); ++i) {
    if (i == 3 || i == 7) continue;
    neighborhood.reserve(grid.max_neighbors(keypoints.points[i]));
    grid.gather(keypoints.points[i], neighborhood);
    if (local_reference_frame(neighborhood, kDescribeFlat.support_radius_m)) with_frame.push_back(i);
  }
  ASSERT_EQ(kept, with_frame);
  ASSERT_GE(kept.size(), keypoints.size() - 3);
  ASSERT_EQ(features.size(), kept.size());
  ASSERT_EQ(features.descriptors.size(), features.size() * 352);
  for (std::size_t i = 0; i < features.size(); ++i) {
    ASSERT_NE(kept[i], 3);
    ASSERT_NE(kept[i], 7);
    ASSERT_EQ(features.points[i], keypoints.points[kept[i]]);
    ASSERT_EQ(features.normals[i], keypoints.normals[kept[i]]);
    ASSERT_NEAR(cosine_between(features.descriptor(i), features.descriptor(i)), 1, 1e-5);
  }
}

TEST(DescribeShot, DoesNotChangeUnderRigidMotion) {
  const PointCloud support = bumpy_object(4000, 3);
  const PointCloud keypoints = every_nth(support, 20);
  const Rigid3 motion{Rigid3::from_axis_angle({3, -1, 2}, 2.1).rotation, {0.4, -0.3, 1.2}};
  std::vector<int> kept_before;
  std::vector<int> kept_after;
  const FeatureSet before = describe_shot(support, keypoints, kDescribeFlat, &kept_before);
  const FeatureSet after =
      describe_shot(transform(motion, support), transform(motion, keypoints), kDescribeFlat, &kept_after);
  ASSERT_GT(before.size(), 150U);
  ASSERT_EQ(kept_before, kept_after);
  int num_equal = 0;
  for (std::size_t i = 0; i < before.size(); ++i)
    num_equal += cosine_between(before.descriptor(i), after.descriptor(i)) > 0.999 ? 1 : 0;
  EXPECT_GE(num_equal, static_cast<int>(before.size()) * 97 / 100);
}

TEST(DescribeShot, DistinguishesPlaces) {
  const PointCloud support = bumpy_object(4000, 3);
  const PointCloud resampled = bumpy_object(4000, 4);
  const PointCloud keypoints = every_nth(support, 20);
  std::vector<int> kept;
  std::vector<int> kept_again;
  const FeatureSet first = describe_shot(support, keypoints, kDescribeFlat, &kept);
  const FeatureSet second = describe_shot(resampled, keypoints, kDescribeFlat, &kept_again);
  ASSERT_GT(first.size(), 150U);
  // Counts descriptors whose nearest one over another sampling of the surface belongs to about the same place.
  int num_right = 0;
  for (std::size_t i = 0; i < first.size(); ++i) {
    std::size_t best = 0;
    for (std::size_t j = 1; j < second.size(); ++j)
      if (cosine_between(first.descriptor(i), second.descriptor(j)) >
          cosine_between(first.descriptor(i), second.descriptor(best)))
        best = j;
    num_right += (first.points[i] - second.points[best]).norm() < 0.02F ? 1 : 0;
  }
  EXPECT_GT(num_right, static_cast<int>(first.size()) / 2);  // 3 % by chance
}

TEST(DescribeShot, LeavesOutWhatHasNoStableFrame) {
  const auto patch = [](double curvature, double bend) {
    PointCloud cloud;
    for (int i = -10; i <= 10; ++i)
      for (int j = -10; j <= 10; ++j) {
        const double x = 0.003 * i;
        const double y = 0.003 * j;
        cloud.points.emplace_back(static_cast<float>(x), static_cast<float>(y),
                                  static_cast<float>(curvature * (x * x + y * y) + bend * x));
        cloud.normals.emplace_back(0.0F, 0.0F, 1.0F);
      }
    return cloud;
  };
  PointCloud center;
  center.points.emplace_back(0.0F, 0.0F, 0.0F);
  center.normals.emplace_back(0.0F, 0.0F, 1.0F);
  EXPECT_EQ(describe_shot(patch(0, 0), center, kDescribeFlat).size(), 0U);  // a symmetric plane: no x axis, no side
  EXPECT_EQ(describe_shot(patch(3, 0), center, kDescribeFlat).size(), 0U);  // a symmetric bowl: no x axis
  PointCloud off_center = center;
  off_center.points[0] = {0.02F, 0.011F, 0.0F};
  EXPECT_EQ(describe_shot(patch(0, 0), off_center, kDescribeFlat).size(), 0U);  // a plane has no side
  off_center.points[0].z() = 3 * off_center.points[0].head<2>().squaredNorm();
  // Beside the middle of a bowl, the frame is defined.
  EXPECT_EQ(describe_shot(patch(3, 0), off_center, kDescribeFlat).size(), 1U);
  PointCloud few = patch(3, 0);
  few.points.resize(12);
  few.normals.resize(12);
  off_center.points[0] = few.points[5];
  // 11 neighbours.
  EXPECT_EQ(describe_shot(few, off_center, {.min_surface_variation = 0, .min_neighbors = 12}).size(), 0U);
  EXPECT_EQ(describe_shot(PointCloud{}, center, kDescribeFlat).size(), 0U);
  EXPECT_EQ(describe_shot(few, PointCloud{}, kDescribeFlat).size(), 0U);
}

TEST(DescribeShot, DropsFlatKeypoints) {
  const PointCloud support = bumpy_object(4000, 5);
  const PointCloud keypoints = every_nth(support, 10);
  std::vector<int> kept;
  constexpr double kThreshold = 0.06;
  ShotOptions options;
  options.min_surface_variation = kThreshold;
  (void)describe_shot(support, keypoints, options, &kept);
  const std::set<int> kept_set(kept.begin(), kept.end());
  int num_flat = 0;
  for (std::size_t k = 0; k < keypoints.size(); ++k) {
    std::vector<Eigen::Vector3d> near;
    for (const Eigen::Vector3f& p : support.points) {
      const float distance = (p - keypoints.points[k]).norm();
      if (distance > 0 && distance <= 0.04F) near.push_back(p.cast<double>());
    }
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (const auto& p : near) mean += p / static_cast<double>(near.size());
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
    for (const auto& p : near) covariance += (p - mean) * (p - mean).transpose();
    const double variation =
        Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance).eigenvalues()[0] / covariance.trace();
    if (std::abs(variation - kThreshold) < 1e-5) continue;
    num_flat += variation < kThreshold ? 1 : 0;
    ASSERT_EQ(kept_set.contains(static_cast<int>(k)), variation > kThreshold) << variation;
  }
  EXPECT_GT(num_flat, 20);
  EXPECT_GT(kept.size(), 20U);
}

TEST(DescribeShot, IgnoresSupportThatIsNotFinite) {
  PointCloud support = bumpy_object(3000, 6);
  const PointCloud keypoints = every_nth(support, 30);
  const FeatureSet clean = describe_shot(support, keypoints, kDescribeFlat);
  ASSERT_GT(clean.size(), 80U);
  support.points.push_back(keypoints.points[0] + Eigen::Vector3f(0.001F, 0, 0));
  support.normals.emplace_back(kNan, kNan, kNan);
  support.points.emplace_back(kNan, kNan, kNan);
  support.normals.emplace_back(0.0F, 0.0F, 1.0F);
  EXPECT_EQ(describe_shot(support, keypoints, kDescribeFlat).descriptors, clean.descriptors);
}

TEST(DescribeShot, IsTheSameForAnyNumberOfThreads) {
  const PointCloud support = bumpy_object(5000, 7);
  const PointCloud keypoints = every_nth(support, 10);
  ShotOptions options = kDescribeFlat;
  const FeatureSet serial = describe_shot(support, keypoints, options);
  options.num_threads = 3;
  const FeatureSet parallel = describe_shot(support, keypoints, options);
  ASSERT_GT(serial.size(), 400U);
  EXPECT_EQ(serial.points, parallel.points);
  EXPECT_EQ(serial.descriptors, parallel.descriptors);
}

TEST(DescribeShot, RefusesBadInput) {
  const PointCloud support = bumpy_object(100, 8);
  PointCloud bare = support;
  bare.normals.clear();
  EXPECT_THROW((void)describe_shot(bare, support), std::invalid_argument);
  EXPECT_THROW((void)describe_shot(support, bare), std::invalid_argument);
  EXPECT_THROW((void)describe_shot(support, support, {.keypoint_spacing_m = 0}), std::invalid_argument);
  EXPECT_THROW((void)describe_shot(support, support, {.support_radius_m = -1}), std::invalid_argument);
  EXPECT_THROW((void)describe_shot(support, support, {.support_voxel_m = kNan}), std::invalid_argument);
  EXPECT_THROW((void)describe_shot(support, support, {.min_surface_variation = 0.5}), std::invalid_argument);
  EXPECT_THROW((void)describe_shot(support, support, {.min_neighbors = 0}), std::invalid_argument);
  EXPECT_THROW((void)describe_shot(support, support, {.num_threads = 0}), std::invalid_argument);
}

}  // namespace
}  // namespace resight
