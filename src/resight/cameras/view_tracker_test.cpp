// SPDX-License-Identifier: Apache-2.0
#include "resight/cameras/view_tracker.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "resight/cameras/trajectory_error.hpp"
#include "resight/sensor/testing/ball_scene.hpp"

namespace resight {
namespace {

using test::BallScene;

Rigid3 walk(int step, int num_steps) {
  const double angle = -0.8 + 1.6 * step / (num_steps - 1);
  return test::look_at_point({1.0 * std::sin(angle), 0.3 - 1.1 * std::cos(angle), 0.75}, {0, 0.3, 0.05});
}

PreparedView see(const BallScene& scene, const Rigid3& pose, int number) {
  return prepare_view(test::render_ball_scene(scene, pose, 0.0015, static_cast<std::uint64_t>(number)));
}

std::vector<Rigid3> poses_of(const CameraTrack& track) {
  std::vector<Rigid3> poses;
  for (const TrackedView& view : track.views) poses.push_back(view.world_from_camera);
  return poses;
}

TEST(MatchViews, FindsTheRelativePose) {
  const Rigid3 a = walk(2, 8), b = walk(3, 8);
  const ViewFeatures in_a(extract_sift(see({}, a, 1))), in_b(extract_sift(see({}, b, 2)));
  const std::optional<ViewMatch> match = match_views(in_a, in_b);
  ASSERT_TRUE(match.has_value());
  EXPECT_GE(match->num_inliers, 10);
  EXPECT_LT(test::shift_m(match->a_from_b, a.inverse() * b), 0.01);
  EXPECT_LT(test::turn_rad(match->a_from_b, a.inverse() * b), 0.01);
}

TEST(MatchViews, NothingInCommonIsNoMatch) {
  BallScene plain;
  plain.textured = false;
  const ViewFeatures in_a(extract_sift(see({}, walk(0, 8), 1))), none(extract_sift(see(plain, walk(1, 8), 2)));
  EXPECT_FALSE(match_views(in_a, none).has_value());
  EXPECT_FALSE(match_views(none, in_a).has_value());
}

TEST(ViewTracker, FollowsAWalkWhileThingsMove) {
  constexpr int kSteps = 9;
  ViewTracker tracker;
  std::vector<Rigid3> truth;
  for (int v = 0; v < kSteps; ++v) {
    BallScene scene;
    if (v >= 3) scene.ball_m += Eigen::Vector3d(-0.25, 0.1, 0);
    scene.has_ball = v < 6;
    truth.push_back(walk(v, kSteps));
    const TrackedView tracked = tracker.add_view(see(scene, truth.back(), v));
    EXPECT_EQ(tracked.component, 0) << v;
  }
  const CameraTrack track = tracker.finish();
  ASSERT_EQ(track.num_components, 1);
  const TrajectoryError error = find_trajectory_error(truth, poses_of(track));
  EXPECT_LT(error.max_m, 0.005);
  EXPECT_LT(error.max_rad, 0.006);
  EXPECT_GT(track.num_long_edges, 0);
  EXPECT_EQ(track.views[0].world_from_camera.matrix(), Eigen::Matrix4d::Identity());
}

TEST(ViewTracker, ManyFeaturesNeedNoSimilarBrightness) {
  TrackViewsOptions options;
  options.plausible.min_correlation = options.few_matches.min_correlation = options.follow.min_correlation = 1;
  ViewTracker tracker(options);
  const Rigid3 a = walk(4, 9);
  const Rigid3 b = walk(5, 9);
  tracker.add_view(see({}, a, 1));
  const TrackedView second = tracker.add_view(see({}, b, 2));
  EXPECT_EQ(second.component, 0);
  EXPECT_GT(second.num_matches, 0);
  EXPECT_LT(test::shift_m(second.world_from_camera, a.inverse() * b), 0.01);
  EXPECT_EQ(tracker.finish().num_components, 1);
}

// However many features they have in common: their surroundings differ.
TEST(ViewTracker, TwoOfAKindAreNotOnePlace) {
  ViewTracker tracker;
  for (int v = 0; v < 4; ++v) {
    const Eigen::Vector3d place_m(v < 2 ? 0 : 1.6, 0, 0);
    const BallScene scene{.ball_m = place_m + Eigen::Vector3d(0, 0.05, 0.2), .ball_radius_m = 0.2, .ball_print = true};
    const Eigen::Vector3d eye_m(v % 2 == 0 ? -0.05 : 0.05, -0.8, 0.7);
    tracker.add_view(see(scene, test::look_at_point(place_m + eye_m, place_m + Eigen::Vector3d(0, 0.05, 0.15)), v));
  }
  const CameraTrack track = tracker.finish();
  ASSERT_EQ(track.num_components, 2);
  EXPECT_EQ(track.views[1].component, track.views[0].component);
  EXPECT_EQ(track.views[3].component, track.views[2].component);
}

TEST(ViewTracker, FewFeaturesNeedSimilarBrightness) {
  TrackViewsOptions options;
  options.few_matches.max_matches = 10000;  // All are few.
  const auto num_components = [&](double min_correlation) {
    options.few_matches.min_correlation = min_correlation;
    ViewTracker tracker(options);
    tracker.add_view(see({}, walk(4, 9), 1));
    tracker.add_view(see({}, walk(5, 9), 2));
    return tracker.finish().num_components;
  };
  EXPECT_EQ(num_components(0.65), 1);
  EXPECT_EQ(num_components(1), 2);
}

TEST(ViewTracker, AFollowedViewNeedsSimilarBrightness) {
  const auto num_matches = [&](double min_correlation) {
    TrackViewsOptions options;
    options.follow.min_correlation = min_correlation;
    ViewTracker tracker(options);
    tracker.add_view(see({}, walk(4, 9), 1));
    return tracker.add_view(see({}, walk(4, 9), 2)).num_matches;
  };
  EXPECT_EQ(num_matches(0.65), -1) << "followed";
  EXPECT_GT(num_matches(1), 0) << "found by its features";
}

TEST(ViewTracker, WhatCannotBeJoinedIsAPartOfItsOwn) {
  BallScene other;
  other.textured = false;
  other.has_ball = false;
  ViewTracker tracker;
  for (int v = 0; v < 3; ++v) tracker.add_view(see({}, walk(v, 9), v));
  RgbdFrame blind = test::render_ball_scene({}, walk(3, 9));
  std::ranges::fill(blind.depth_m.data(), std::numeric_limits<float>::quiet_NaN());
  tracker.add_view(prepare_view(blind));
  for (int v = 3; v < 5; ++v) tracker.add_view(see({}, walk(v, 9), v));
  const CameraTrack track = tracker.finish();
  std::vector<int> components;
  for (const TrackedView& view : track.views) components.push_back(view.component);
  EXPECT_EQ(components, (std::vector<int>{0, 0, 0, 1, 0, 0}));
  EXPECT_EQ(track.num_components, 2);
}

TEST(ViewTracker, AnUntexturedFloorIsNoPlace) {
  // An untextured floor does not determine a position: two views from different places are not joined.
  BallScene bare;
  bare.textured = false;
  bare.has_ball = false;
  ViewTracker tracker;
  tracker.add_view(see(bare, test::look_at_point({0, -0.5, 0.9}, {0, -0.2, 0}), 1));
  const TrackedView second = tracker.add_view(see(bare, test::look_at_point({0.3, -0.5, 0.9}, {0.3, -0.2, 0}), 2));
  EXPECT_EQ(second.component, 1);
}

// The normals of an active stereo camera are off by 0.4 rad. Their noise must not pass for a sign that the camera
// stands still.
TEST(ViewTracker, AnUntexturedFloorOfNoisyDepthIsNotFollowed) {
  BallScene bare;
  bare.has_ball = bare.textured = false;
  ViewTracker tracker;
  for (int v = 0; v < 6; ++v) {
    const double x_m = -0.2 + 0.015 * v;
    RgbdFrame frame = test::render_ball_scene(bare, test::look_at_point({x_m, -2, 0.7}, {x_m, -1.72, 0}));
    frame.camera.noise = {.constant_m = 0.001, .quadratic_per_m = 0.004, .nearest_m = 0};
    Rng rng(static_cast<std::uint64_t>(100 + v));
    for (float& z_m : frame.depth_m.data())
      z_m += static_cast<float>(axial_noise_m(frame.camera.noise, static_cast<double>(z_m)) * rng.normal());
    tracker.add_view(prepare_view(std::move(frame)));
  }
  EXPECT_EQ(tracker.finish().num_components, 6);
}

TEST(ViewTracker, NoiseOfTheImageIsNoTexture) {
  BallScene plain;
  plain.textured = false;
  ViewTracker tracker;
  Rng rng(5);
  for (int v = 0; v < 5; ++v) {
    const double angle = -2.3 + 0.012 * v;
    const Rigid3 pose = test::look_at_point({1.2 * std::cos(angle), 1.2 * std::sin(angle), 0.75}, {0.1, 0.25, 0.1});
    RgbdFrame frame = test::render_ball_scene(plain, pose, 0.001, static_cast<std::uint64_t>(v + 1));
    for (Rgb8& color : frame.color.data())
      for (auto channel : {&Rgb8::r, &Rgb8::g, &Rgb8::b})
        color.*channel =
            static_cast<std::uint8_t>(std::clamp(std::lround(color.*channel + 2 * rng.normal()), 0L, 255L));
    tracker.add_view(prepare_view(std::move(frame)));
  }
  EXPECT_EQ(tracker.finish().num_components, 1);
}

TEST(ViewTracker, WithAMaskItIsTheThingThatIsFollowed) {
  // The ball does not rotate, but moves in front of a static background; poses relative to it move the opposite way.
  ViewTracker tracker;
  std::vector<Rigid3> truth;
  const Rigid3 pose = test::look_at_point({0, -0.6, 0.5}, {0.1, 0.05, 0.1});
  for (int v = 0; v < 4; ++v) {
    BallScene scene;
    scene.ball_m += Eigen::Vector3d(0.012 * v, 0, 0);
    scene.ball_print = true;
    const PreparedView view = see(scene, pose, v);
    Image<std::uint8_t> mask(view.cloud.width(), view.cloud.height());
    for (std::size_t i = 0; i < mask.size(); ++i) {
      if (!view.cloud.has_point(i)) continue;
      const Eigen::Vector3d p = pose * view.cloud.point(i).cast<double>();
      mask[i] = (p - scene.ball_m).norm() < scene.ball_radius_m + 0.01 ? 1 : 0;
    }
    truth.push_back(Rigid3::from_translation(-scene.ball_m) * pose);
    tracker.add_view(view, &mask);
  }
  const CameraTrack track = tracker.finish();
  ASSERT_EQ(track.num_components, 1);
  EXPECT_LT(find_trajectory_error(truth, poses_of(track)).max_m, 0.004);
}

PreparedView see_from(const Rigid3& truth, const Rigid3& given, int name) {
  PreparedView view = see({}, truth, name);
  view.frame.world_from_camera = given;
  return view;
}

// Of six pairs three may be matched: those of neighbours connect all views.
TEST(ViewTracker, OfManyPairsTheNearestAreMatched) {
  TrackViewsOptions options;
  options.max_feature_pairs = 3;
  options.given_sigma_m = 1;
  ViewTracker tracker(options);
  std::vector<Rigid3> truth;
  for (int v = 0; v < 4; ++v) {
    truth.push_back(walk(v, 9));
    const Rigid3 shift{Eigen::Matrix3d::Identity(), {1.5 * v, 0, 0}};  // No two views overlap.
    tracker.add_posed_view(see_from(truth.back(), shift * truth.back(), v));
  }
  EXPECT_LT(find_trajectory_error(truth, poses_of(tracker.finish())).rms_m, 0.001);
}

TEST(ViewTracker, GivenPosesKeepTheirWorld) {
  ViewTracker tracker;
  tracker.add_view(see({}, walk(0, 9), 0));
  const Rigid3 given = Rigid3{Eigen::Matrix3d::Identity(), {5, 0, 0}} * walk(1, 9);
  tracker.add_posed_view(see_from(walk(1, 9), given, 1));
  const CameraTrack track = tracker.finish();
  ASSERT_EQ(track.num_components, 1);
  EXPECT_LT(test::shift_m(track.views[1].world_from_camera, given), 0.01);
}

TEST(ViewTracker, RefinesGivenPosesInTheirWorld) {
  Rng rng(4);
  ViewTracker tracker;
  std::vector<Rigid3> truth, given;
  for (int v = 0; v < 6; ++v) {
    truth.push_back(walk(v, 9));
    const Eigen::Vector3d noise{rng.normal(), rng.normal(), rng.normal()};
    given.push_back(v == 0 ? truth[0]
                           : truth[static_cast<std::size_t>(v)] *
                                 Rigid3{Rigid3::from_axis_angle({noise.y(), 1, 0}, 0.01).rotation, 0.007 * noise});
    tracker.add_posed_view(see_from(truth.back(), given.back(), v));
  }
  const std::vector<Rigid3> refined = poses_of(tracker.finish());
  EXPECT_GT(find_trajectory_error(truth, given).rms_m, 0.007);
  EXPECT_LT(find_trajectory_error(truth, refined).rms_m, 0.003);
  EXPECT_LT(test::shift_m(refined[0], truth[0]), 1e-9) << "the first view defines the world frame";
}

// Keyframes take memory, and the time of their pairs.
TEST(ViewTracker, OfGivenPosesFewAreKeyframes) {
  constexpr int kSteps = 25;
  Rng rng(4);
  ViewTracker tracker;
  std::vector<Rigid3> truth;
  for (int v = 0; v < kSteps; ++v) {
    truth.push_back(walk(v, 3 * kSteps));
    const Eigen::Vector3d noise{rng.normal(), rng.normal(), rng.normal()};
    const Rigid3 off{Rigid3::from_axis_angle({noise.y(), 1, 0}, 0.01).rotation, 0.007 * noise};
    tracker.add_posed_view(see_from(truth.back(), v == 0 ? truth[0] : truth.back() * off, v));
  }
  const CameraTrack track = tracker.finish();
  EXPECT_EQ(track.num_components, 1);
  EXPECT_LT(std::ranges::count(track.views, true, &TrackedView::is_keyframe), 8);
  EXPECT_LT(find_trajectory_error(truth, poses_of(track)).rms_m, 0.003);
}

TEST(ViewTracker, GivenPosesAreRelatedToEachOther) {
  ViewTracker tracker;
  const auto add_given = [&](int v) { tracker.add_posed_view(see_from(walk(v, 9), walk(v, 9), v)); };
  add_given(0);
  RgbdFrame blind = test::render_ball_scene({}, walk(1, 9));
  std::ranges::fill(blind.depth_m.data(), std::numeric_limits<float>::quiet_NaN());
  tracker.add_view(prepare_view(blind));
  add_given(2);
  const TrackerStep step = tracker.last_step();
  ASSERT_EQ(step.edges.size(), 1U);
  EXPECT_EQ(step.edges[0].a, 0);
  EXPECT_LT(test::shift_m(step.edges[0].a_from_b, walk(0, 9).inverse() * walk(2, 9)), 1e-9);
}

TEST(ViewTracker, SameForAnyNumberOfThreads) {
  std::vector<CameraTrack> tracks;
  for (const int num_threads : {1, 4}) {
    TrackViewsOptions options;
    options.num_threads = num_threads;
    ViewTracker tracker(options);
    for (int v = 0; v < 4; ++v) tracker.add_view(see({}, walk(2 * v, 9), v));
    tracks.push_back(tracker.finish());
  }
  for (std::size_t v = 0; v < 4; ++v)
    EXPECT_EQ(tracks[0].views[v].world_from_camera.matrix(), tracks[1].views[v].world_from_camera.matrix());
}

TEST(ViewTracker, ImagesOfOtherSizesStandAlone) {
  RgbdFrame tiny;
  tiny.name = "tiny";
  tiny.camera = {40, 30, 40, 40, 19.5, 14.5};
  tiny.color = Image<Rgb8>(40, 30);
  tiny.depth_m = Image<float>(40, 30, 1.0F);
  ViewTracker tracker;
  tracker.add_view(prepare_view(tiny));
  tracker.add_view(see({}, walk(0, 9), 0));
  tracker.add_view(prepare_view(tiny));
  tracker.add_view(see({}, walk(1, 9), 1));
  const CameraTrack track = tracker.finish();
  ASSERT_EQ(track.num_components, 3);
  EXPECT_EQ(track.views[1].component, 0);
  EXPECT_EQ(track.views[3].component, 0);
}

TEST(ViewTracker, BadOptionsAreRefused) {
  TrackViewsOptions options;
  options.plausible.min_overlap = -1;
  EXPECT_THROW(ViewTracker{options}, std::invalid_argument);
  EXPECT_EQ(ViewTracker().finish().num_components, 0);
}

}  // namespace
}  // namespace resight
