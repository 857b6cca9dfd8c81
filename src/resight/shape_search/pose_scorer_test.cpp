// SPDX-License-Identifier: Apache-2.0
#include "resight/shape_search/pose_scorer.hpp"

#include <gtest/gtest.h>

#include <array>

#include "resight/core/random.hpp"
#include "resight/shape_search/scene_samples.hpp"
#include "resight/shape_search/testing/box_on_table.hpp"

namespace resight {
namespace {

using namespace analytic;

constexpr DepthMargin kMargin{.base_m = 0.008, .noise_sigmas = 3};

TEST(SampleSurface, PointsAreApartAndNoMoreThanAllowed) {
  const BoxOnTable c;
  const PointCloud samples = sample_surface(c.model.surface, 0.01, 10000);
  ASSERT_GT(samples.size(), 200U);
  for (std::size_t i = 0; i < samples.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const bool alike = samples.normals[i].dot(samples.normals[j]) > 0.9F;
      EXPECT_TRUE(!alike || (samples.points[i] - samples.points[j]).norm() >= 0.0099F);
    }
  EXPECT_LE(sample_surface(c.model.surface, 0.01, 50).size(), 50U);
  EXPECT_GE(sample_surface(c.model.surface, 0.01, 50).size(), 25U);
  // Faces that look six ways never cover each other, nor do normals that are none.
  EXPECT_EQ(sample_surface(c.model.surface, 0.01, 1).size(), 1U);
  PointCloud broken = c.model.surface;
  for (Eigen::Vector3f& n : broken.normals) n.setConstant(std::numeric_limits<float>::quiet_NaN());
  EXPECT_TRUE(sample_surface(broken, 0.01, 50).empty());
  PointCloud bare = c.model.surface;
  bare.normals.clear();
  EXPECT_TRUE(sample_surface(bare, 0.01, 50).empty());
}

TEST(SampleScene, LeavesTheTableOutAndKeepsWhatStandsOnIt) {
  const BoxOnTable c;
  const PointCloud scene = sample_scene(c.view).points;
  ASSERT_GT(scene.size(), 100U);
  const Rigid3f world_from_camera(c.view.frame.world_from_camera);
  int on_table = 0;
  for (const Eigen::Vector3f& p : scene.points) on_table += (world_from_camera * p).z() < 0.005F ? 1 : 0;
  EXPECT_LT(on_table, static_cast<int>(scene.size() / 10));
}

TEST(SampleScene, NothingSeenNothingSampled) {
  BoxOnTable c;
  RgbdFrame frame = c.view.frame;
  for (float& depth : frame.depth_m.data()) depth = std::numeric_limits<float>::quiet_NaN();
  EXPECT_TRUE(sample_scene(prepare_view(frame)).points.empty());
}

TEST(PoseScorer, CountsWhatIsThereHiddenAndSeenThrough) {
  const BoxOnTable c;
  CountSamplesOptions options;
  options.max_wrong = 1000;
  const SampleCounts right = c.scorer.score_coarse(c.samples, Rigid3f(c.truth), options);
  EXPECT_GE(right.facing, options.max_samples);
  EXPECT_LT(right.facing, options.max_samples + SampleBlock::kSize);
  EXPECT_GT(right.confirmed, 0.9 * right.facing);
  EXPECT_LT(right.wrong_color, 0.25 * right.facing);

  const auto along_view = [&](double shift_m) {
    Rigid3 pose = c.truth;
    pose.translation += shift_m * pose.translation.normalized();
    return c.scorer.score_coarse(c.samples, Rigid3f(pose), options);
  };
  EXPECT_GT(along_view(-0.1).seen_through, 0.9 * options.max_samples);
  EXPECT_GT(along_view(0.1).occluded, 0.9 * options.max_samples);

  Rigid3 outside = c.truth;
  outside.translation.x() += 5;
  const SampleCounts none = c.scorer.score_coarse(c.samples, Rigid3f(outside), options);
  EXPECT_GT(none.facing, 0);
  EXPECT_EQ(none.occluded, none.facing);

  // Behind the camera, at whatever distance: nothing is known there.
  for (const double z : {-0.2, -1.0, -3.0}) {
    Rigid3 behind = c.truth;
    behind.translation.z() = z;
    const SampleCounts counts = c.scorer.score_coarse(c.samples, Rigid3f(behind), options);
    EXPECT_GT(counts.facing, 0);
    EXPECT_EQ(counts.occluded, counts.facing) << z;
    EXPECT_EQ(c.scorer.score_fine(c.samples, behind, kMargin, {}).num_explained, 0) << z;
  }

  options.max_wrong = 3;
  Rigid3 near = c.truth;
  near.translation *= 0.8;
  const SampleCounts stopped = c.scorer.score_coarse(c.samples, Rigid3f(near), options);
  EXPECT_TRUE(stopped.gave_up);
  EXPECT_LT(stopped.facing, 10);
}

TEST(PoseScorer, CountsLikeClassifySurface) {
  const BoxOnTable c;
  CountSamplesOptions options;
  options.max_samples = options.max_wrong = 1000000;  // Counts all samples.
  Rng rng(5);
  const auto random = [&](double limit) {
    return Eigen::Vector3d{rng.uniform(-limit, limit), rng.uniform(-limit, limit), rng.uniform(-limit, limit)};
  };
  std::array<int, 4> sum{};
  for (int trial = 0; trial < 60; ++trial) {
    const Rigid3 pose = disturb(c.truth, random(0.06), random(1), rng.uniform(-0.6, 0.6));
    const SampleCounts counts = c.scorer.score_coarse(c.samples, Rigid3f(pose), options);
    const float center_z_m = (Rigid3f(pose) * c.samples.center).z();
    const SurfaceEvidence evidence = classify_surface(
        {c.samples.points, c.samples.normals}, pose, {c.view.frame.camera, c.view.cloud.z},
        {.margin = {.base_m = options.margin.at(center_z_m, c.view.frame.camera.noise), .noise_sigmas = 0},
         .min_viewing_cosine = 0.25});
    // One sample may round to another pixel in single precision.
    EXPECT_NEAR(counts.facing, evidence.count[0] + evidence.count[1] + evidence.count[2] + evidence.count[3], 1);
    EXPECT_NEAR(counts.confirmed, evidence.num(Evidence::kPresent), 1) << trial;
    EXPECT_NEAR(counts.seen_through, evidence.num(Evidence::kSeenThrough), 1) << trial;
    EXPECT_NEAR(counts.occluded, evidence.num(Evidence::kOccluded), 1) << trial;
    for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += evidence.count[k];
  }
  EXPECT_GT(sum[static_cast<std::size_t>(Evidence::kOccluded)], 500);
  EXPECT_GT(sum[static_cast<std::size_t>(Evidence::kPresent)], 500);
  EXPECT_GT(sum[static_cast<std::size_t>(Evidence::kSeenThrough)], 500);
}

TEST(PoseScorer, RefinesARoughPose) {
  const BoxOnTable c;
  const Rigid3 rough = disturb(c.truth, {0.006, -0.005, 0.007}, {1, 2, 0.5}, 0.1);
  const Rigid3 refined = c.scorer.refine(c.samples, rough, 20, 0.02);
  const auto error_m = [&](const Rigid3& pose) {
    double worst = 0;
    for (const Eigen::Vector3f& p : c.samples.points)
      worst = std::max(worst, ((pose * p.cast<double>().eval()) - (c.truth * p.cast<double>().eval())).norm());
    return worst;
  };
  EXPECT_GT(error_m(rough), 0.008);
  EXPECT_LT(error_m(refined), 0.003);
  EXPECT_EQ(c.scorer.refine(c.samples, rough, 0, 0.02).translation, rough.translation);
}

TEST(PoseScorer, ScoresDepthAndColour) {
  const BoxOnTable c;
  const MatchCriteria colors;
  const PoseFit right = c.scorer.score_fine(c.samples, c.truth, kMargin, colors);
  EXPECT_GT(right.explained_share, 0.85);
  EXPECT_GT(right.visible_share, 0.95);
  EXPECT_GT(right.pattern_similarity, 0.7);

  Solid other = c.box;
  other.paint = checks({50, 200, 50}, {220, 220, 220}, 0.017);
  const PoseFit wrong_print =
      c.scorer.score_fine(make_sampled_model(make_model("other", other), 300), c.truth, kMargin, colors);
  EXPECT_LT(wrong_print.explained_share, right.explained_share - 0.2);

  Rigid3 seen_through = c.truth;
  seen_through.translation *= 0.85;
  EXPECT_LT(c.scorer.score_fine(c.samples, seen_through, kMargin, colors).explained_share, 0.3);
}

TEST(PoseScorer, GivesUpOnPosesThatWillHardlyReachTheLeastScore) {
  const BoxOnTable c;
  CountSamplesOptions options;
  options.max_wrong = 1000;
  Rigid3 occluded = c.truth;
  occluded.translation *= 1.2;
  EXPECT_FALSE(c.scorer.score_coarse(c.samples, Rigid3f(occluded), options).gave_up);
  const SampleCounts stopped = c.scorer.score_coarse(c.samples, Rigid3f(occluded), options, 0.6);
  EXPECT_TRUE(stopped.gave_up);
  EXPECT_LT(stopped.facing, options.max_samples);
  EXPECT_FALSE(c.scorer.score_coarse(c.samples, Rigid3f(c.truth), options, 0.6).gave_up);
}

TEST(PoseScorer, ScoresInFullWhatReachesTheLeastFit) {
  const BoxOnTable c;
  const PoseFit whole = c.scorer.score_fine(c.samples, c.truth, kMargin, {});
  const PoseFit scored = c.scorer.score_fine(c.samples, c.truth, kMargin, {}, {.explained_share = 0.5});
  EXPECT_EQ(scored.explained_share, whole.explained_share);
  EXPECT_EQ(scored.pattern_similarity, whole.pattern_similarity);
  Rigid3 off = c.truth;
  off.translation *= 0.85;
  const PoseFit cut = c.scorer.score_fine(c.samples, off, kMargin, {}, {.explained_share = 0.5});
  EXPECT_FALSE(cut.reaches({.explained_share = 0.5}));
  EXPECT_GE(cut.explained_share, c.scorer.score_fine(c.samples, off, kMargin, {}).explained_share);
}

TEST(PoseScorer, WhatLiesOnALargerPlaneIsNotTheObjects) {
  // A card of the table's colour, in the table.
  const Solid card{Shape::kBox, {0.12, 0.08, 0.01}, plain({150, 140, 130}), on_table(0, 0, -0.005)};
  const World table{.solids = {}};
  const PreparedView view = prepare_view(render(table, circle_of_cameras(3)[0]).frame);
  const SceneSamples scene = sample_scene(view);
  ASSERT_FALSE(scene.planes.empty());
  const SampledModel samples = make_sampled_model(make_model("card", card), 300);
  const Rigid3 pose = view.frame.world_from_camera.inverse() * card.world_from_object;
  const PoseScorer blind(view, {}, 1);
  const PoseScorer scorer(view, scene.planes, 1);
  EXPECT_GT(blind.score_coarse(samples, Rigid3f(pose), {}).confirmed, 20);
  const SampleCounts counts = scorer.score_coarse(samples, Rigid3f(pose), {});
  EXPECT_TRUE(counts.gave_up);
  EXPECT_EQ(counts.confirmed, 0);
  EXPECT_EQ(scorer.score_fine(samples, pose, kMargin, {}).explained_share, 0);
  // A plane no larger than the object may be its own face.
  std::vector<ScenePlane> small = scene.planes;
  for (ScenePlane& plane : small) plane.extent_m = 0.15F;
  EXPECT_GT(PoseScorer(view, small, 1).score_coarse(samples, Rigid3f(pose), {}).confirmed, 20);
}

TEST(PoseScorer, SharedTextureTellsAFaceInARowFromALargerPlane) {
  const Solid box{Shape::kBox, {0.14, 0.08, 0.18}, checks({200, 60, 50}, {60, 70, 200}, 0.03), on_table(0, 0, 0.09)};
  Solid other = box;
  other.paint = checks({50, 200, 50}, {220, 220, 220}, 0.017);
  World row;
  for (const double x : {-0.142, 0.0, 0.142}) {
    row.solids.push_back(box);
    row.solids.back().world_from_object = on_table(x, 0, 0.09);
  }
  const PreparedView view = prepare_view(render(row, look_at({0, -0.7, 0.2}, {0, 0, 0.09})).frame);
  const SceneSamples scene = sample_scene(view);
  const PoseScorer scorer(view, scene.planes, 1);
  const Rigid3 pose = view.frame.world_from_camera.inverse() * box.world_from_object;
  const auto explained = [&](const Solid& solid, std::optional<double> texture_contrast) {
    const SampledModel samples = make_sampled_model(make_model("box", solid), 300);
    return scorer.score_fine(samples, pose, kMargin, {.texture_contrast = texture_contrast}).explained_share;
  };
  EXPECT_LT(explained(box, std::nullopt), 0.2) << "The faces must be one plane.";
  EXPECT_GT(explained(box, 2), 0.6);
  EXPECT_LT(explained(other, 2), 0.2);
}

TEST(PoseScorer, WhatGoesOnBeyondTheObjectSpeaksAgainstIt) {
  // A small box in a corner of a crate of the same colour; the same box alone, and beside one of another colour.
  const Solid small{Shape::kBox, {0.08, 0.08, 0.08}, plain({180, 170, 60}), on_table(0, 0, 0.04, 0.2)};
  const Solid crate{Shape::kBox, {0.2, 0.2, 0.08}, plain({180, 170, 60}), on_table(0, 0, 0.04, 0.2)};
  Solid beside = small;
  beside.paint = plain({60, 80, 190});
  beside.world_from_object = small.world_from_object * Rigid3::from_translation({0.08, 0, 0});
  const SampledModel samples = make_sampled_model(make_model("small", small), 300);
  const auto explained = [&](const World& world) {
    const PreparedView view = prepare_view(render(world, circle_of_cameras(3)[0]).frame);
    const Rigid3 pose = view.frame.world_from_camera.inverse() * small.world_from_object;
    return PoseScorer(view, {}, 1).score_fine(samples, pose, kMargin, {}).explained_share;
  };
  EXPECT_GT(explained({.solids = {small}}), 0.85);
  EXPECT_GT(explained({.solids = {small, beside}}), 0.75);
  EXPECT_LT(explained({.solids = {crate}}), 0.6);
}

TEST(PoseScorer, PixelsOutsideAndBehindAreNone) {
  const BoxOnTable c;
  EXPECT_EQ(c.scorer.pixel_of({0, 0, -1}), -1);
  EXPECT_EQ(c.scorer.pixel_of({10, 0, 1}), -1);
  EXPECT_EQ(c.scorer.pixel_of({std::numeric_limits<float>::quiet_NaN(), 0, 1}), -1);
  const Camera& camera = c.view.frame.camera;
  const Eigen::Vector3d corner = camera.unproject(camera.width - 0.51, camera.height - 0.51, 1);
  EXPECT_EQ(c.scorer.pixel_of(corner.cast<float>()), camera.width * camera.height - 1);
}

}  // namespace
}  // namespace resight
