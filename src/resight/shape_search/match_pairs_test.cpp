// SPDX-License-Identifier: Apache-2.0
#include "resight/shape_search/match_pairs.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "resight/core/random.hpp"
#include "resight/shape_search/testing/box_on_table.hpp"

namespace resight {
namespace {

using namespace analytic;

// Two right matches among many wrong ones.
struct TwoOfMany : BoxOnTable {
  std::vector<Correspondence> matches;

  TwoOfMany() {
    Rng rng(5);
    const auto any = [&] { return rng.below(static_cast<std::uint32_t>(model.surface.size())); };
    for (int i = 0; i < 40; ++i) add(any(), any());
    const std::size_t first = seen_point({});
    matches.insert(matches.begin() + 11, match_of(first, first));
    const std::size_t second = seen_point(model.surface.points[first]);
    matches.insert(matches.begin() + 30, match_of(second, second));
  }
  // A point of the face that looks at the camera most, 4 cm or more from another.
  std::size_t seen_point(std::optional<Eigen::Vector3f> away) const {
    for (std::size_t i = 0; i < model.surface.size(); ++i) {
      const Eigen::Vector3f p = Rigid3f(truth) * model.surface.points[i];
      if ((truth.rotation.cast<float>() * model.surface.normals[i]).dot(p.normalized()) < -0.6F &&
          (!away || (model.surface.points[i] - *away).norm() > 0.04F))
        return i;
    }
    throw std::logic_error("the camera sees no face");
  }
  Correspondence match_of(std::size_t in_model, std::size_t in_scene) const {
    const Rigid3f motion(truth);
    return {.model_point = model.surface.points[in_model],
            .model_normal = model.surface.normals[in_model],
            .scene_point = motion * model.surface.points[in_scene],
            .scene_normal = motion.rotation * model.surface.normals[in_scene],
            .model_feature = static_cast<int>(in_model),
            .scene_feature = static_cast<int>(in_scene)};
  }
  void add(std::size_t in_model, std::size_t in_scene) { matches.push_back(match_of(in_model, in_scene)); }

  bool finds_truth(const std::vector<PoseCandidate>& found) const {
    return std::any_of(found.begin(), found.end(), [&](const PoseCandidate& c) {
      const Rigid3 pose{c.camera_from_object.rotation.cast<double>(), c.camera_from_object.translation.cast<double>()};
      return c.object == 3 && c.score > 0.5F && (pose.translation - truth.translation).norm() < 0.005 &&
             rotation_angle_rad(pose.rotation, truth.rotation) < 0.05;
    });
  }
  std::vector<PoseCandidate> find(const ShapeSearchOptions& options = {}) const {
    return poses_of_match_pairs(matches, 3, samples, scorer, options);
  }
};

TEST(MatchPairs, TwoRightMatchesOfOneFaceAreEnough) {
  const TwoOfMany c;
  EXPECT_TRUE(c.finds_truth(c.find()));
  EXPECT_LT(c.find().size(), 40U);  // Nearly all of the 861 pairs are seen to be wrong.
}

TEST(MatchPairs, OneIsNot) {
  TwoOfMany c;
  c.matches.erase(c.matches.begin() + 30);
  EXPECT_FALSE(c.finds_truth(c.find()));
}

TEST(MatchPairs, NoneWhereThereIsNothingToPair) {
  TwoOfMany c;
  ShapeSearchOptions off;
  off.max_matches = 0;
  EXPECT_TRUE(c.find(off).empty());
  EXPECT_TRUE(poses_of_match_pairs({}, 3, c.samples, c.scorer, {}).empty());
  EXPECT_TRUE(poses_of_match_pairs(c.matches, 3, SampledModel{}, c.scorer, {}).empty());
  const std::vector<Correspondence> same(5, c.matches[11]);
  EXPECT_TRUE(poses_of_match_pairs(same, 3, c.samples, c.scorer, {}).empty());
  for (Correspondence& m : c.matches) m.scene_normal.setConstant(std::numeric_limits<float>::quiet_NaN());
  EXPECT_TRUE(c.find().empty());
}

TEST(AgreeingMatches, EachKeypointWithItsNearestOnly) {
  const TwoOfMany c;
  const std::vector<int> both = agreeing_matches(c.matches, c.truth, 0.002);
  EXPECT_TRUE(std::find(both.begin(), both.end(), 11) != both.end());
  EXPECT_TRUE(std::find(both.begin(), both.end(), 30) != both.end());
  EXPECT_TRUE(std::is_sorted(both.begin(), both.end()));

  std::vector<Correspondence> competitors{c.matches[11], c.matches[11], c.matches[30]};
  competitors[0].scene_point.x() += 0.003F;  // The same keypoint, a little farther: the second is nearer.
  competitors[2].scene_point.x() += 0.02F;
  EXPECT_EQ(agreeing_matches(competitors, c.truth, 0.01), (std::vector{1}));
  competitors[1].type = FeatureType::kShot;
  EXPECT_EQ(agreeing_matches(competitors, c.truth, 0.01), (std::vector{0}));
  EXPECT_TRUE(agreeing_matches({}, c.truth, 0.01).empty());
}

}  // namespace
}  // namespace resight
