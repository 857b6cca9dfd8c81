// SPDX-License-Identifier: Apache-2.0
#include "resight/hypotheses/generation.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "resight/core/random.hpp"
#include "resight/hypotheses/testing/synthetic_correspondences.hpp"

namespace resight {
namespace {

FeatureSet random_features(Rng& rng, FeatureType type, int dimension, int n) {
  FeatureSet set;
  set.type = type;
  set.dimension = dimension;
  for (int i = 0; i < n; ++i) {
    const testing::SurfacePoint p = testing::random_surface_point(rng, true);
    set.points.push_back(p.point.cast<float>());
    set.normals.push_back(p.normal.cast<float>());
    Eigen::VectorXf d(dimension);
    for (auto& value : d) value = static_cast<float>(std::abs(rng.normal()));
    d.normalize();
    set.descriptors.insert(set.descriptors.end(), d.data(), d.data() + dimension);
  }
  return set;
}

constexpr int kSiftDimension = 16;  // Any dimension works; small ones keep the brute force fast.
constexpr int kShotDimension = 24;

ModelLibrary random_library(Rng& rng) {
  ModelLibrary library;
  library.objects.resize(4);
  for (std::size_t o = 0; o < 4; ++o) {
    const int n = o == 2 ? 0 : 30 + 5 * static_cast<int>(o);  // One object has no features.
    library.objects[o].sift = encode(random_features(rng, FeatureType::kSift, kSiftDimension, n));
    library.objects[o].shot = encode(random_features(rng, FeatureType::kShot, kShotDimension, n / 2));
  }
  return library;
}

struct Neighbor {
  double distance_sq;
  int object;
  int feature;
};

// The k nearest descriptors among all objects, by brute force.
std::vector<Neighbor> nearest(const ModelLibrary& library, CodedFeatures ObjectModel::*type,
                              std::span<const float> query, int k) {
  std::vector<Neighbor> all;
  for (std::size_t o = 0; o < library.objects.size(); ++o) {
    const FeatureSet set = decode(library.objects[o].*type);
    for (std::size_t f = 0; f < set.size(); ++f) {
      double sum = 0;
      for (std::size_t d = 0; d < query.size(); ++d) {
        const double difference = static_cast<double>(set.descriptor(f)[d]) - static_cast<double>(query[d]);
        sum += difference * difference;
      }
      all.push_back({sum, static_cast<int>(o), static_cast<int>(f)});
    }
  }
  std::sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.distance_sq < b.distance_sq; });
  all.resize(std::min(all.size(), static_cast<std::size_t>(k)));
  return all;
}

int count_expected(const ModelLibrary& library, CodedFeatures ObjectModel::*type, const FeatureSet& scene, int k,
                   const std::vector<std::vector<Correspondence>>& found) {
  int checked = 0;
  for (std::size_t i = 0; i < scene.size(); ++i)
    for (const Neighbor& n : nearest(library, type, scene.descriptor(i), k)) {
      const CodedFeatures& model = library.objects[static_cast<std::size_t>(n.object)].*type;
      const auto& candidates = found[static_cast<std::size_t>(n.object)];
      const auto match = std::find_if(candidates.begin(), candidates.end(), [&](const Correspondence& c) {
        return c.type == scene.type && c.model_feature == n.feature && c.scene_feature == static_cast<int>(i);
      });
      if (match == candidates.end()) {
        ADD_FAILURE() << "scene feature " << i << " lacks object " << n.object << " feature " << n.feature;
        continue;
      }
      EXPECT_NEAR(match->distance_sq, n.distance_sq, 1e-4);
      EXPECT_EQ(match->model_point, model.points[static_cast<std::size_t>(n.feature)]);
      EXPECT_EQ(match->model_normal, model.normals[static_cast<std::size_t>(n.feature)]);
      EXPECT_EQ(match->scene_point, scene.points[i]);
      EXPECT_EQ(match->scene_normal, scene.normals[i]);
      ++checked;
    }
  return checked;
}

std::size_t total(const std::vector<std::vector<Correspondence>>& correspondences) {
  std::size_t sum = 0;
  for (const auto& of_object : correspondences) sum += of_object.size();
  return sum;
}

TEST(ModelFeatureIndex, EqualsTheBruteForce) {
  Rng rng(61);
  const ModelLibrary library = random_library(rng);
  const FeatureSet sift = random_features(rng, FeatureType::kSift, kSiftDimension, 50);
  const FeatureSet shot = random_features(rng, FeatureType::kShot, kShotDimension, 40);
  ModelFeatureIndex built(library, {.sift_neighbors = 3, .shot_neighbors = 2});
  const ModelFeatureIndex index = std::move(built);
  const auto found = index.match(sift, shot);
  ASSERT_EQ(found.size(), 4U);
  EXPECT_TRUE(found[2].empty());
  EXPECT_EQ(total(found), 50U * 3 + 40 * 2);
  EXPECT_EQ(count_expected(library, &ObjectModel::sift, sift, 3, found), 150);
  EXPECT_EQ(count_expected(library, &ObjectModel::shot, shot, 2, found), 80);
}

TEST(ModelFeatureIndex, ScenePointsThatAreNotFiniteAreLeftOut) {
  Rng rng(62);
  const ModelLibrary library = random_library(rng);
  FeatureSet sift = random_features(rng, FeatureType::kSift, kSiftDimension, 60);
  sift.points[7].x() = std::numeric_limits<float>::quiet_NaN();
  const auto found = ModelFeatureIndex(library, {.sift_neighbors = 1}).match(sift, {});
  EXPECT_EQ(total(found), 59U);
}

TEST(ModelFeatureIndex, EmptyLibraryAndEmptySceneMatchNothing) {
  Rng rng(63);
  const FeatureSet sift = random_features(rng, FeatureType::kSift, kSiftDimension, 5);
  const ModelLibrary none;
  EXPECT_TRUE(ModelFeatureIndex(none).match(sift, {}).empty());
  const ModelLibrary library = random_library(rng);
  const auto found = ModelFeatureIndex(library).match({}, {});
  EXPECT_EQ(found.size(), 4U);
  EXPECT_EQ(total(found), 0U);
}

TEST(ModelFeatureIndex, RejectsBadInput) {
  Rng rng(64);
  ModelLibrary library = random_library(rng);
  const ModelFeatureIndex index(library);
  EXPECT_THROW((void)index.match(random_features(rng, FeatureType::kSift, 8, 5), {}), std::invalid_argument);
  EXPECT_THROW((void)index.match(random_features(rng, FeatureType::kShot, kSiftDimension, 5), {}),
               std::invalid_argument);
  EXPECT_THROW(ModelFeatureIndex(library, {.sift_neighbors = 0}), std::invalid_argument);
  EXPECT_THROW(ModelFeatureIndex(library, {.shot_neighbors = -1}), std::invalid_argument);
  library.objects[0].shot.codes.pop_back();
  EXPECT_THROW(ModelFeatureIndex{library}, std::invalid_argument);
  library = random_library(rng);
  library.objects[1].sift = encode(random_features(rng, FeatureType::kSift, 8, 5));
  EXPECT_THROW(ModelFeatureIndex{library}, std::invalid_argument);
}

std::vector<std::vector<Correspondence>> correspondences_of_objects(std::vector<Rigid3>& camera_from_object) {
  std::vector<std::vector<Correspondence>> all;
  for (std::uint64_t o = 0; o < 6; ++o) {
    const testing::Problem problem = testing::make_problem(
        {.num_correspondences = 80, .inliers_per_instance = o == 3 ? 0 : 25, .noise_m = 0.001, .seed = 70 + o});
    all.push_back(problem.correspondences);
    camera_from_object.push_back(problem.scene_from_object[0]);
  }
  return all;
}

TEST(GenerateHypotheses, AreInTheWorldFrameInTheOrderOfTheirIds) {
  Rng rng(65);
  std::vector<Rigid3> camera_from_object;
  const auto correspondences = correspondences_of_objects(camera_from_object);
  const Rigid3 world_from_camera = testing::random_pose(rng);
  const auto hypotheses = generate_hypotheses(correspondences, world_from_camera, 7, 100);
  ASSERT_GE(hypotheses.size(), 5U);
  std::vector<bool> found(6, false);
  for (std::size_t i = 0; i < hypotheses.size(); ++i) {
    const Hypothesis& h = hypotheses[i];
    EXPECT_EQ(h.id, 100 + i);
    EXPECT_EQ(h.origin_view, 7);
    EXPECT_EQ(h.origin_views, std::vector<int>{7});
    ASSERT_GE(h.correspondences.size(), 5U);
    if (i > 0) {
      const Hypothesis& before = hypotheses[i - 1];
      EXPECT_TRUE(before.object < h.object ||
                  (before.object == h.object && before.correspondences.size() >= h.correspondences.size()));
    }
    for (const Correspondence& c : h.correspondences) {
      const Eigen::Vector3d p = h.world_from_object * c.model_point.cast<double>().eval();
      EXPECT_LT((p - c.scene_point.cast<double>()).norm(), 0.016);
      EXPECT_GT((h.world_from_object.rotation * c.model_normal.cast<double>()).dot(c.scene_normal.cast<double>()),
                0.79);
    }
    const auto o = static_cast<std::size_t>(h.object);
    if (testing::is_near(h.world_from_object, world_from_camera * camera_from_object[o])) found[o] = true;
  }
  for (std::size_t o = 0; o < 6; ++o) EXPECT_EQ(found[o], o != 3) << o;
}

TEST(GenerateHypotheses, SerialEqualsParallel) {
  std::vector<Rigid3> camera_from_object;
  const auto correspondences = correspondences_of_objects(camera_from_object);
  const auto serial = generate_hypotheses(correspondences, Rigid3::identity(), 0, 1, {.num_threads = 1});
  const auto parallel = generate_hypotheses(correspondences, Rigid3::identity(), 0, 1, {.num_threads = 4});
  ASSERT_GE(serial.size(), 5U);
  ASSERT_EQ(serial.size(), parallel.size());
  for (std::size_t i = 0; i < serial.size(); ++i) {
    EXPECT_EQ(serial[i].id, parallel[i].id);
    EXPECT_EQ(serial[i].object, parallel[i].object);
    EXPECT_EQ(serial[i].world_from_object.matrix(), parallel[i].world_from_object.matrix());
    ASSERT_EQ(serial[i].correspondences.size(), parallel[i].correspondences.size());
    for (std::size_t k = 0; k < serial[i].correspondences.size(); ++k)
      EXPECT_EQ(serial[i].correspondences[k].scene_point, parallel[i].correspondences[k].scene_point);
  }
}

TEST(GenerateHypotheses, NothingInNothingOut) {
  EXPECT_TRUE(generate_hypotheses({}, Rigid3::identity(), 0, 0).empty());
  const std::vector<std::vector<Correspondence>> empty(5);
  EXPECT_TRUE(generate_hypotheses(empty, Rigid3::identity(), 0, 0).empty());
  Rigid3 bad;
  bad.rotation.setZero();
  EXPECT_THROW((void)generate_hypotheses(empty, bad, 0, 0), std::invalid_argument);
  EXPECT_THROW((void)generate_hypotheses(empty, Rigid3::identity(), 0, 0, {.num_threads = 0}), std::invalid_argument);
}

}  // namespace
}  // namespace resight
