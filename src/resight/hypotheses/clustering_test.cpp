// SPDX-License-Identifier: Apache-2.0
#include "resight/hypotheses/clustering.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <set>
#include <stdexcept>

#include "resight/core/random.hpp"
#include "resight/hypotheses/testing/synthetic_correspondences.hpp"

namespace resight {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

// Object 0 has no symmetry, 1 a two-fold symmetry about z, 2 a continuous one about z. Their centres lie off the origin
// (for 1 and 2, on the axis).
ModelLibrary make_library() {
  ModelLibrary library;
  library.objects.resize(3);
  library.objects[0].center = Eigen::Vector3f(0.1F, -0.05F, 0.02F);
  library.objects[1].center = library.objects[2].center = Eigen::Vector3f(0, 0, 0.08F);
  library.objects[1].symmetries.discrete = {Rigid3::from_axis_angle(Eigen::Vector3d::UnitZ(), std::numbers::pi)};
  library.objects[2].symmetries.continuous = {{}};
  return library;
}

// Exact correspondences for the pose, plus noise on the scene side.
Hypothesis make_hypothesis(Rng& rng, std::uint64_t id, int object, const Rigid3& pose, int view, int num_points,
                           double noise_m = 0) {
  Hypothesis h;
  h.id = id;
  h.object = object;
  h.world_from_object = pose;
  h.origin_view = view;
  h.origin_views = {view};
  for (int i = 0; i < num_points; ++i) {
    const testing::SurfacePoint m = testing::random_surface_point(rng, true);
    Correspondence c;
    c.model_point = m.point.cast<float>();
    c.model_normal = m.normal.cast<float>();
    c.scene_point =
        (pose * m.point + noise_m * Eigen::Vector3d{rng.normal(), rng.normal(), rng.normal()}).cast<float>();
    c.scene_normal = (pose.rotation * m.normal).cast<float>();
    c.model_feature = c.scene_feature = static_cast<int>(id) * 100 + i;
    h.correspondences.push_back(c);
  }
  return h;
}

Rigid3 offset(const Rigid3& pose, const Eigen::Vector3d& translation) {
  return Rigid3::from_translation(translation) * pose;
}

// A few distant places, with several perturbed hypotheses of random objects at each.
std::vector<Hypothesis> crowded_scene(Rng& rng, int num_places, int per_place) {
  std::vector<Hypothesis> hypotheses;
  for (int place = 0; place < num_places; ++place) {
    Rigid3 pose = testing::random_pose(rng, 0.05);
    pose.translation += Eigen::Vector3d(place, 0, 0);
    for (int i = 0; i < per_place; ++i) {
      const auto object = static_cast<int>(rng.below(3));
      const double angle_rad = rng.uniform(0, 0.15);
      Rigid3 near = pose * Rigid3::from_axis_angle(testing::random_direction(rng), angle_rad);
      near.translation += 0.012 * testing::random_direction(rng);
      const auto view = static_cast<int>(rng.below(5));
      const int num_points = 5 + static_cast<int>(rng.below(20));
      hypotheses.push_back(make_hypothesis(rng, hypotheses.size(), object, near, view, num_points, 0.002));
    }
  }
  return hypotheses;
}

// All values of a hypothesis that count, for bitwise comparison.
std::vector<double> bytes(const Hypothesis& h) {
  std::vector<double> values{static_cast<double>(h.id), static_cast<double>(h.object),
                             static_cast<double>(h.origin_view)};
  for (const int view : h.origin_views) values.push_back(view);
  const Eigen::Matrix4d m = h.world_from_object.matrix();
  values.insert(values.end(), m.data(), m.data() + 16);
  for (const Correspondence& c : h.correspondences)
    for (const Eigen::Vector3f* v : {&c.model_point, &c.model_normal, &c.scene_point, &c.scene_normal})
      values.insert(values.end(), v->data(), v->data() + 3);
  return values;
}

std::vector<std::vector<double>> bytes(const ClusterResult& result) {
  std::vector<std::vector<double>> all;
  for (const Hypothesis& h : result.hypotheses) all.push_back(bytes(h));
  return all;
}

double center_distance(const Rigid3& a, const Rigid3& b, const ObjectModel& object) {
  const Eigen::Vector3d center = object.center.cast<double>();
  return (a * center - b * center).norm();
}

TEST(ClusterHypotheses, NearOnesMergeAndFarOnesDoNot) {
  Rng rng(41);
  const ModelLibrary library = make_library();
  const Rigid3 pose = testing::random_pose(rng);
  std::vector<Hypothesis> h;
  h.push_back(make_hypothesis(rng, 10, 0, pose, 1, 8));
  h.push_back(make_hypothesis(rng, 11, 0, offset(pose, {0.015, 0, 0}), 3, 6));
  h.push_back(make_hypothesis(rng, 12, 0, offset(pose, {0.025, 0, 0}), 2, 6));
  h.push_back(make_hypothesis(rng, 13, 1, pose, 2, 6));
  const ClusterResult result = cluster_hypotheses(h, library);
  ASSERT_EQ(result.hypotheses.size(), 3U);
  EXPECT_EQ(result.members, (std::vector<std::vector<int>>{{0, 1}, {2}, {3}}));
  EXPECT_EQ(result.hypotheses[0].id, 10U);
  EXPECT_EQ(result.hypotheses[0].origin_view, 3);
  EXPECT_EQ(result.hypotheses[0].origin_views, (std::vector<int>{1, 3}));
  EXPECT_EQ(result.hypotheses[0].correspondences.size(), 14U);
}

TEST(ClusterHypotheses, LimitsAreExclusive) {
  Rng rng(42);
  ModelLibrary library = make_library();
  library.objects[0].center.setZero();
  const auto num_clusters = [&](const Rigid3& other, double max_rotation_rad) {
    const std::vector<Hypothesis> h{make_hypothesis(rng, 1, 0, Rigid3::identity(), 0, 5),
                                    make_hypothesis(rng, 2, 0, other, 0, 5)};
    return cluster_hypotheses(h, library, {.max_rotation_rad = max_rotation_rad}).hypotheses.size();
  };
  EXPECT_EQ(num_clusters(Rigid3::from_translation({0.02, 0, 0}), 0.1), 2U);
  EXPECT_EQ(num_clusters(Rigid3::from_translation({std::nextafter(0.02, 0), 0, 0}), 0.1), 1U);
  const Rigid3 turned = Rigid3::from_axis_angle(Eigen::Vector3d::UnitX(), 0.1);
  const double angle = rotation_angle_rad(Eigen::Matrix3d::Identity(), turned.rotation);
  EXPECT_EQ(num_clusters(turned, angle), 2U);
  EXPECT_EQ(num_clusters(turned, std::nextafter(angle, 1)), 1U);
}

TEST(ClusterHypotheses, TranslationIsThatOfTheCentre) {
  // The origin moves by 5 cm, but the centre stays. The paper's text would split the two.
  Rng rng(43);
  ModelLibrary library = make_library();
  library.objects[0].center = Eigen::Vector3f(0.5F, 0, 0);
  const Eigen::Vector3d center(0.5, 0, 0);
  const Rigid3 turned = Rigid3::from_translation(center) * Rigid3::from_axis_angle(Eigen::Vector3d::UnitZ(), 0.1) *
                        Rigid3::from_translation(-center);
  ASSERT_GT(turned.translation.norm(), 0.04);
  const std::vector<Hypothesis> h{make_hypothesis(rng, 1, 0, Rigid3::identity(), 0, 6),
                                  make_hypothesis(rng, 2, 0, turned, 0, 5)};
  EXPECT_EQ(cluster_hypotheses(h, library).hypotheses.size(), 1U);
}

TEST(ClusterHypotheses, Laws) {
  Rng rng(44);
  const ModelLibrary library = make_library();
  const ClusterHypothesesOptions options;
  int num_merged = 0;
  for (int trial = 0; trial < 10; ++trial) {
    const std::vector<Hypothesis> h = crowded_scene(rng, 4, 12);
    const ClusterResult result = cluster_hypotheses(h, library, options);
    ASSERT_EQ(result.hypotheses.size(), result.members.size());
    std::multiset<int> assigned;
    for (std::size_t i = 0; i < result.members.size(); ++i) {
      const Hypothesis& seed = h[static_cast<std::size_t>(result.members[i].front())];
      EXPECT_EQ(result.hypotheses[i].id, seed.id);
      const ObjectModel& object = library.objects[static_cast<std::size_t>(seed.object)];
      for (const int m : result.members[i]) {
        assigned.insert(m);
        const Hypothesis& member = h[static_cast<std::size_t>(m)];
        EXPECT_EQ(member.object, seed.object);
        EXPECT_LE(member.correspondences.size(), seed.correspondences.size());
        EXPECT_LT(center_distance(member.world_from_object, seed.world_from_object, object), options.max_translation_m);
        EXPECT_LT(symmetric_rotation_distance_rad(member.world_from_object, seed.world_from_object, object.symmetries),
                  options.max_rotation_rad);
      }
      EXPECT_LT(center_distance(result.hypotheses[i].world_from_object, seed.world_from_object, object),
                options.max_translation_m);
      num_merged += static_cast<int>(result.members[i].size()) - 1;
    }
    EXPECT_EQ(assigned.size(), h.size());  // Each belongs to exactly one cluster.
    EXPECT_EQ(std::set<int>(assigned.begin(), assigned.end()).size(), h.size());
  }
  EXPECT_GT(num_merged, 100);
}

TEST(ClusterHypotheses, OrderOfTheInputDoesNotMatter) {
  Rng rng(45);
  const ModelLibrary library = make_library();
  std::vector<Hypothesis> h = crowded_scene(rng, 3, 20);
  const auto expected = bytes(cluster_hypotheses(h, library));
  ASSERT_LT(expected.size(), h.size());
  for (int i = 0; i < 5; ++i) {
    rng.shuffle(h);
    EXPECT_EQ(bytes(cluster_hypotheses(h, library)), expected);
  }
}

TEST(ClusterHypotheses, ClustersApartStayAsTheyAre) {
  // One object per place, and seeds that no later estimate moves closer together: clustering again changes nothing.
  Rng rng(46);
  const ModelLibrary library = make_library();
  std::vector<Hypothesis> h;
  for (int place = 0; place < 6; ++place) {
    Rigid3 pose = testing::random_pose(rng, 0.05);
    pose.translation.x() += place;
    for (int i = 0; i < 5; ++i)
      h.push_back(
          make_hypothesis(rng, h.size(), 0, offset(pose, 0.005 * testing::random_direction(rng)), i, 10, 0.002));
  }
  const ClusterResult once = cluster_hypotheses(h, library);
  ASSERT_EQ(once.hypotheses.size(), 6U);
  const ClusterResult twice = cluster_hypotheses(once.hypotheses, library);
  std::map<double, std::vector<double>> a;
  std::map<double, std::vector<double>> b;
  for (const Hypothesis& c : once.hypotheses) a[static_cast<double>(c.id)] = bytes(c);
  for (const Hypothesis& c : twice.hypotheses) b[static_cast<double>(c.id)] = bytes(c);
  EXPECT_EQ(a, b);
}

TEST(ClusterHypotheses, SerialEqualsParallel) {
  Rng rng(47);
  const ModelLibrary library = make_library();
  const std::vector<Hypothesis> h = crowded_scene(rng, 8, 10);
  const auto serial = bytes(cluster_hypotheses(h, library, {.num_threads = 1}));
  ASSERT_GT(serial.size(), 8U);
  EXPECT_EQ(bytes(cluster_hypotheses(h, library, {.num_threads = 4})), serial);
}

TEST(ClusterHypotheses, EulerAndGeodesicDiffer) {
  // 8 deg about each of three axes: every Euler angle is below 10 deg, but the rotation angle is not.
  Rng rng(48);
  const ModelLibrary library = make_library();
  const Eigen::Matrix3d turn = (Eigen::AngleAxisd(8 * kDegree, Eigen::Vector3d::UnitZ()) *
                                Eigen::AngleAxisd(8 * kDegree, Eigen::Vector3d::UnitY()) *
                                Eigen::AngleAxisd(8 * kDegree, Eigen::Vector3d::UnitX()))
                                   .toRotationMatrix();
  EXPECT_GT(rotation_angle_rad(Eigen::Matrix3d::Identity(), turn), 13 * kDegree);
  const Eigen::Vector3d center = library.objects[0].center.cast<double>();
  const Rigid3 turned =
      Rigid3::from_translation(center) * Rigid3::from_rotation(turn) * Rigid3::from_translation(-center);
  const std::vector<Hypothesis> h{make_hypothesis(rng, 1, 0, Rigid3::identity(), 0, 6),
                                  make_hypothesis(rng, 2, 0, turned, 0, 5)};
  EXPECT_EQ(cluster_hypotheses(h, library, {.rotation_test = RotationTest::kGeodesic}).hypotheses.size(), 2U);
  EXPECT_EQ(cluster_hypotheses(h, library, {.rotation_test = RotationTest::kAbsoluteEuler}).hypotheses.size(), 1U);
  // Without absolute values, as printed in the paper, any negative angle would pass.
  const Eigen::Matrix3d back = Eigen::AngleAxisd(-30 * kDegree, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  EXPECT_FALSE(rotations_are_near(Eigen::Matrix3d::Identity(), back, 10 * kDegree, RotationTest::kAbsoluteEuler));
  EXPECT_FALSE(rotations_are_near(back, Eigen::Matrix3d::Identity(), 10 * kDegree, RotationTest::kAbsoluteEuler));
}

TEST(ClusterHypotheses, SymmetricFlipsMergeAndTheirCorrespondencesFitTheSeed) {
  Rng rng(49);
  const ModelLibrary library = make_library();
  for (const int object : {1, 2}) {
    const double turn = object == 1 ? std::numbers::pi : 2.0;
    const Rigid3 pose = testing::random_pose(rng);
    const Rigid3 flipped = pose * Rigid3::from_axis_angle(Eigen::Vector3d::UnitZ(), turn + 0.02);
    const std::vector<Hypothesis> h{make_hypothesis(rng, 1, object, pose, 0, 8),
                                    make_hypothesis(rng, 2, object, flipped, 1, 7)};
    const ClusterResult result = cluster_hypotheses(h, library);
    ASSERT_EQ(result.hypotheses.size(), 1U) << object;
    const Hypothesis& merged = result.hypotheses[0];
    ASSERT_EQ(merged.correspondences.size(), 15U);
    for (const Correspondence& c : merged.correspondences) {
      const Eigen::Vector3d p = merged.world_from_object * c.model_point.cast<double>().eval();
      EXPECT_LT((p - c.scene_point.cast<double>()).norm(), 0.006);
      EXPECT_GT((merged.world_from_object.rotation * c.model_normal.cast<double>()).dot(c.scene_normal.cast<double>()),
                0.99);
    }
    std::vector<Hypothesis> plain = h;
    for (Hypothesis& p : plain) p.object = 0;
    EXPECT_EQ(cluster_hypotheses(plain, library).hypotheses.size(), 2U);
  }
}

TEST(ClusterHypotheses, PoolHasNoRepeatsAndItsPoseIsEstimatedAnew) {
  Rng rng(50);
  const ModelLibrary library = make_library();
  const Rigid3 truth = testing::random_pose(rng);
  std::vector<Hypothesis> h;
  for (std::uint64_t i = 0; i < 5; ++i) {
    h.push_back(make_hypothesis(rng, i, 0, truth, static_cast<int>(i), 12, 0.003));
    h.back().world_from_object = offset(truth, 0.008 * testing::random_direction(rng));
  }
  h[3].correspondences[4] = h[0].correspondences[2];  // From two groups of one view.
  h[2].correspondences[1].scene_point.x() += 0.3F;    // An outlier that the seed does not have.
  const ClusterResult result = cluster_hypotheses(h, library);
  ASSERT_EQ(result.hypotheses.size(), 1U);
  EXPECT_EQ(result.hypotheses[0].correspondences.size(), 59U);
  EXPECT_LT(center_distance(result.hypotheses[0].world_from_object, truth, library.objects[0]), 0.004);
}

TEST(ClusterHypotheses, KeepsTheSeedsPoseWhereTheEstimateFails) {
  Rng rng(51);
  const ModelLibrary library = make_library();
  const Rigid3 pose = testing::random_pose(rng);
  std::vector<Hypothesis> h{make_hypothesis(rng, 1, 0, pose, 0, 3), make_hypothesis(rng, 2, 0, pose, 0, 0)};
  h[1].world_from_object = offset(pose, {0.01, 0, 0});
  ClusterResult result = cluster_hypotheses(h, library);
  ASSERT_EQ(result.hypotheses.size(), 1U);
  EXPECT_EQ(result.hypotheses[0].world_from_object.matrix(), pose.matrix());
  // Correspondences that support another place do not move the cluster there.
  h = {make_hypothesis(rng, 1, 0, offset(pose, {0.5, 0, 0}), 0, 10), make_hypothesis(rng, 2, 0, pose, 0, 5)};
  h[0].world_from_object = pose;
  result = cluster_hypotheses(h, library);
  ASSERT_EQ(result.hypotheses.size(), 1U);
  EXPECT_EQ(result.hypotheses[0].world_from_object.matrix(), pose.matrix());
}

TEST(ClusterHypotheses, EmptyInputAndBadInput) {
  const ModelLibrary library = make_library();
  EXPECT_TRUE(cluster_hypotheses({}, library).hypotheses.empty());
  std::vector<Hypothesis> h(1);
  h[0].object = 3;
  EXPECT_THROW((void)cluster_hypotheses(h, library), std::invalid_argument);
  EXPECT_THROW((ClusterHypothesesOptions{.max_translation_m = 0}).check(), std::invalid_argument);
  EXPECT_THROW((ClusterHypothesesOptions{.max_rotation_rad = std::nan("")}).check(), std::invalid_argument);
  EXPECT_THROW((ClusterHypothesesOptions{.num_threads = 0}).check(), std::invalid_argument);
  // A NaN pose is near to no other.
  Rng rng(52);
  h = {make_hypothesis(rng, 1, 0, Rigid3::identity(), 0, 5), make_hypothesis(rng, 2, 0, Rigid3::identity(), 0, 5)};
  h[1].world_from_object.translation.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(cluster_hypotheses(h, library).hypotheses.size(), 2U);
}

}  // namespace
}  // namespace resight
