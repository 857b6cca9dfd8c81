// SPDX-License-Identifier: Apache-2.0
#include "resight/evaluation/placements.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <numeric>

#include "resight/core/random.hpp"
#include "resight/evaluation/pose_at_test.hpp"

namespace resight {
namespace {

ModelLibrary library_of_placed() {
  ModelLibrary library;
  library.objects.resize(2);
  library.objects[0].name = "mug";
  library.objects[1].name = "tin";
  return library;
}

GroundTruthObject annotate(const std::string& object, int instance, const Rigid3& camera_from_object) {
  GroundTruthObject annotation;
  annotation.object = object;
  annotation.instance = instance;
  annotation.camera_from_object = camera_from_object;
  return annotation;
}

Rigid3 any_pose(Rng& rng) {
  Rigid3 pose = Rigid3::from_axis_angle({rng.normal(), rng.normal(), rng.normal()}, rng.uniform(0, 3));
  pose.translation = {rng.normal(), rng.normal(), rng.normal()};
  return pose;
}

TEST(LocatePlacements, TakesThePosesOfTheFirstAndTheLastAnnotation) {
  std::vector<TruthView> views(4);
  views[1] = {pose_at(1, 0, 0), {annotate("mug", 1, pose_at(0.1)), annotate("mug", 0, pose_at(5))}};
  views[3] = {pose_at(0, 2, 0), {annotate("mug", 0, pose_at(1.2, -2, 1)), annotate("lamp", 0, pose_at(0))}};
  const auto placements =
      locate_placements({{"mug", {{1, 1}, {3, 0}}}, {"lamp", {{3, 0}}}}, views, library_of_placed(), "s.changes");
  ASSERT_TRUE(placements.ok()) << placements.error().message;
  ASSERT_EQ(placements->size(), 1U) << "the lamp is not in the library";
  const AnnotatedPlacement& mug = placements->front();
  EXPECT_EQ(mug.first_view, 1);
  EXPECT_EQ(mug.last_view, 3);
  EXPECT_NEAR(mug.first_world_from_object.translation.x(), 1.1, 1e-12);
  EXPECT_NEAR(mug.last_world_from_object.translation.x(), 1.2, 1e-12);
  EXPECT_EQ(locate_placements({{"mug", {{1, 1}, {2, 0}}}}, views, library_of_placed(), "s.changes").error().message,
            "s.changes: view 2 has no annotation of 'mug' with instance 0");
  EXPECT_THROW((void)locate_placements({{"mug", {{4, 0}}}}, views, library_of_placed(), ""), std::invalid_argument);
}

// Random chains: each annotation of a view continues a chain of its object or begins one.
struct RandomChains {
  explicit RandomChains(std::uint64_t seed) {
    Rng rng(seed);
    for (int v = 0; v < 7; ++v) {
      TruthView& view = views.emplace_back();
      view.world_from_camera = any_pose(rng);
      std::map<std::string, int> instances;
      for (const char* object : {"mug", "mug", "tin"}) {
        if (rng.below(3) == 0) continue;
        const int instance = instances[object]++;
        view.objects.push_back(annotate(object, instance, any_pose(rng)));
        std::vector<std::size_t> open;
        for (std::size_t c = 0; c < chains.size(); ++c)
          if (chains[c].object == object && chains[c].entries.back().view < v) open.push_back(c);
        if (open.empty() || rng.below(3) == 0)
          chains.push_back({object, {{v, instance}}});
        else
          chains[open[rng.below(static_cast<std::uint32_t>(open.size()))]].entries.push_back({v, instance});
      }
    }
  }
  std::vector<TruthView> views;
  std::vector<ObjectPlacement> chains;
};

// What create_penalties writes for view v: inv(P_v) * P_L * T_L for each chain whose last view L is earlier.
std::vector<GroundTruthObject> penalties_of(const RandomChains& random, int v) {
  std::vector<GroundTruthObject> penalties;
  for (const ObjectPlacement& chain : random.chains) {
    const auto [last, instance] = chain.entries.back();
    if (v <= last) continue;
    const TruthView& view = random.views[static_cast<std::size_t>(last)];
    for (const GroundTruthObject& o : view.objects)
      if (o.object == chain.object && o.instance == instance) {
        const Eigen::Matrix4d pose = random.views[static_cast<std::size_t>(v)].world_from_camera.matrix().inverse() *
                                     view.world_from_camera.matrix() * o.camera_from_object.matrix();
        Rigid3 camera_from_object;
        camera_from_object.rotation = pose.topLeftCorner<3, 3>();
        camera_from_object.translation = pose.topRightCorner<3, 1>();
        penalties.push_back(annotate(o.object, 0, camera_from_object));
      }
  }
  return penalties;
}

// The largest number of penalties that can each have a detection of their own: all assignments are tried.
int count_by_force(const std::vector<GroundTruthObject>& penalties, const std::vector<DetectedObject>& detections) {
  std::vector<std::size_t> order(penalties.size());
  std::iota(order.begin(), order.end(), 0);
  const auto fits = [](const GroundTruthObject& p, const DetectedObject& d) {
    return p.object == d.object &&
           (p.camera_from_object.translation - d.camera_from_object.translation).norm() <= 0.05 &&
           rotation_angle_rad(p.camera_from_object.rotation, d.camera_from_object.rotation) <= 0.523599;
  };
  int best = 0;
  do {
    int count = 0;
    for (std::size_t d = 0; d < std::min(order.size(), detections.size()); ++d)
      count += fits(penalties[order[d]], detections[d]) ? 1 : 0;
    best = std::max(best, count);
  } while (std::ranges::next_permutation(order).found);
  return best;
}

TEST(PenalizedPlaces, AreThoseOfThePublishedTool) {
  const ModelLibrary library = library_of_placed();
  int num_detected = 0;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const RandomChains random(seed);
    const int num_views = static_cast<int>(random.views.size());
    const auto placements = locate_placements(random.chains, random.views, library, "");
    ASSERT_TRUE(placements.ok()) << placements.error().message;
    const std::vector<char> has_left(placements->size(), 0);
    const auto places = penalized_places(*placements, has_left, num_views);
    Rng rng(seed + 100);
    for (int v = 0; v < num_views; ++v) {
      std::vector<GroundTruthObject> penalties = penalties_of(random, v);
      std::vector<DetectedObject> detections;
      for (const GroundTruthObject& p : penalties) {
        if (detections.size() == 5) break;
        Rigid3 pose = p.camera_from_object;
        pose.translation.x() += rng.uniform(-0.08, 0.08);
        if (rng.below(4) > 0) detections.push_back({p.object, pose, 1});
      }
      if (penalties.size() > 7)
        penalties.resize(7);  // Bounds the permutations; the detections are near the first ones.
      const int counted = count_detected_former_places(
          places, random.views[static_cast<std::size_t>(v)].world_from_camera, v, detections, library);
      EXPECT_EQ(counted, count_by_force(penalties, detections)) << "seed " << seed << ", view " << v;
      num_detected += counted;
    }
  }
  EXPECT_GT(num_detected, 50);
}

TEST(PenalizedPlaces, WhatMayOnlyHaveLeftTheImageIsNoGhost) {
  const ModelLibrary library = library_of_placed();
  const std::vector<AnnotatedPlacement> placements = {{"mug", 0, 1, pose_at(0), pose_at(0)},
                                                      {"tin", 0, 3, pose_at(0), pose_at(0)}};
  const std::vector<DetectedObject> mug = {{"mug", pose_at(0), 1}};
  for (const bool has_left : {false, true}) {
    const auto places = penalized_places(placements, std::vector<char>{static_cast<char>(has_left), 0}, 4);
    ASSERT_EQ(places.size(), 1U) << "the tin is there in the last view";
    EXPECT_EQ(find_ghosts(places, {}, 2, mug, make_kinect_camera(), library).size(), has_left ? 1U : 0U);
    EXPECT_EQ(count_detected_former_places(places, {}, 2, mug, library), 1);
  }
  EXPECT_THROW((void)penalized_places(placements, std::vector<char>{1}, 4), std::invalid_argument);
}

}  // namespace
}  // namespace resight
