// SPDX-License-Identifier: Apache-2.0
#include "resight/inspection/find_faults.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <iterator>
#include <limits>
#include <stdexcept>

#include "resight/core/random.hpp"
#include "resight/inspection/quick_check.hpp"
#include "resight/inspection/testing/broken_sequence.hpp"
#include "resight/inspection/testing/swinging_camera.hpp"
#include "resight/sensor/testing/ball_scene.hpp"
#include "resight/sensor/testing/enlarge_frame.hpp"
#include "resight/sensor/testing/memory_sequence.hpp"

namespace resight {
namespace {

using test::good_sequence;
using test::names_of;
using test::render_view;
using test::sharpen;
using test::swinging_camera;

std::vector<Finding> check(const Sequence& sequence) {
  return find_faults(measure_sequence(sequence, {.max_views = 24, .num_threads = 1}).value());
}

TEST(FindFaults, AGoodSequenceHasNone) {
  const auto measured = measure_sequence(good_sequence(), {.max_views = 24, .num_threads = 1}).value();
  EXPECT_GE(measured.pairs.size(), 8U);
  EXPECT_EQ(names_of(find_faults(measured)), "");
  EXPECT_TRUE(list_facts(measured).empty());
  EXPECT_TRUE(list_unmeasured(measured).empty());
  EXPECT_EQ(names_of(check_quickly(good_sequence(), true)), "");
}

TEST(FindFaults, FewerThanThreeInspectedViewsAreRefused) {
  EXPECT_THROW(std::ignore = measure_sequence(good_sequence(), {.max_views = 2, .num_threads = 1}),
               std::invalid_argument);
}

TEST(FindFaults, ResultsDoNotDependOnThreads) {
  const test::BrokenSequence broken(good_sequence(), "depth_x1.25");
  const auto one = find_faults(measure_sequence(broken, {.max_views = 24, .num_threads = 1}).value());
  const auto three = find_faults(measure_sequence(broken, {.max_views = 24, .num_threads = 3}).value());
  ASSERT_FALSE(one.empty());
  ASSERT_EQ(names_of(one), names_of(three));
  for (std::size_t i = 0; i < one.size(); ++i) EXPECT_EQ(one[i].value, three[i].value);
}

TEST(FindFaults, ACameraThatStandsIsAFactAndNoFault) {
  std::vector<RgbdFrame> frames;
  for (int v = 0; v < 4; ++v)
    frames.push_back(sharpen(test::render_ball_scene({}, test::look_at_point({0.3, -1, 0.8}, {0, 0.1, 0.1}), 0.0015,
                                                     static_cast<std::uint64_t>(v + 1))));
  const auto measured = measure_sequence(test::MemorySequence(frames), {.max_views = 24, .num_threads = 1}).value();
  EXPECT_EQ(names_of(find_faults(measured)), "");
  ASSERT_EQ(list_facts(measured).size(), 1U);
  EXPECT_NE(list_facts(measured).front().find("does not move"), std::string::npos);
}

// As the calibrations of single views do.
TEST(FindFaults, IntrinsicsMayDifferSlightlyFromViewToView) {
  const auto measure = [](double focal_step) {
    std::vector<RgbdFrame> frames;
    for (int v = 0; v < 8; ++v) {
      frames.push_back(good_sequence().read_view(v).value());
      frames.back().camera.fx *= 1 + focal_step * (v % 3);
    }
    return measure_sequence(test::MemorySequence(std::move(frames)), {.max_views = 24, .num_threads = 1}).value();
  };
  const auto measured = measure(1e-6);
  EXPECT_GE(measured.pairs.size(), 8U);
  EXPECT_TRUE(list_unmeasured(measured).empty());
  const std::vector<std::string> unmeasured = list_unmeasured(measure(0.04), true);
  ASSERT_FALSE(unmeasured.empty());
  EXPECT_THAT(unmeasured.front(), testing::HasSubstr("of 8 inspected views have other intrinsics"));
}

// A camera for close range. Its poses tell the unit of the depth.
TEST(FindFaults, PosesProveThatDepthIsNear) {
  constexpr double kNearer = 0.14;
  std::vector<RgbdFrame> frames;
  for (int v = 0; v < 8; ++v) {
    frames.push_back(good_sequence().read_view(v).value());
    frames.back().world_from_camera.translation *= kNearer;
    for (float& z_m : frames.back().depth_m.data()) z_m *= static_cast<float>(kNearer);
  }
  const test::MemorySequence near(frames);
  EXPECT_EQ(names_of(check(near)), "");
  EXPECT_THAT(names_of(check(test::BrokenSequence(near, "poses_fixed"))), testing::HasSubstr("depth_scale"));
  EXPECT_THAT(names_of(check(test::BrokenSequence(near, "depth_x0.1"))), testing::HasSubstr("depth_scale"));
}

TEST(DepthValues, FewMillimetresAreNotEightBits) {
  Image<float> depth_m(32, 16);
  for (std::size_t i = 0; i < depth_m.size(); ++i) depth_m[i] = 1e-3F * static_cast<float>(150 + i % 100);
  EXPECT_FALSE(measure_depth_values(depth_m).has_eight_bits);
  for (float& z_m : depth_m.data()) z_m *= 16;
  EXPECT_TRUE(measure_depth_values(depth_m).has_eight_bits);
}

TEST(FindViewFaults, MarginsOfTheFocalRatioAreThoseOfBothSides) {
  for (const double fx : {260.0, 520.0}) {
    RgbdFrame frame = good_sequence().read_view(0).value();
    frame.camera.fx = fx;
    frame.camera.fy = 780 - fx;
    const std::vector<Finding> findings = find_view_faults(frame);
    ASSERT_EQ(findings.size(), 1U) << names_of(findings);
    EXPECT_NEAR(findings[0].margin, 1.6, 1e-9) << fx;
  }
}

// All matches are on the ball then.
TEST(FindFaults, ACameraThatStandsMayShowMotionBeforeAPlainBackground) {
  const Rigid3 pose = test::look_at_point({0.3, -1, 0.8}, {0, 0.1, 0.1});
  const RgbdFrame background = test::render_ball_scene({.has_ball = false}, pose);
  std::vector<RgbdFrame> frames;
  for (int v = 0; v < 5; ++v) {
    const test::BallScene scene{.ball_m = {-0.2 + 0.1 * v, 0.05, 0.15}, .ball_radius_m = 0.15, .ball_print = true};
    RgbdFrame frame = sharpen(test::render_ball_scene(scene, pose));
    for (std::size_t i = 0; i < frame.color.size(); ++i)
      if (frame.depth_m[i] == background.depth_m[i]) frame.color[i] = {128, 128, 128};
    frames.push_back(std::move(frame));
  }
  const auto measured = measure_sequence(test::MemorySequence(frames), {.max_views = 24, .num_threads = 1}).value();
  EXPECT_GE(measured.pairs.size(), 3U);
  EXPECT_GT(measured.pair_shift_px, 10);
  EXPECT_EQ(names_of(find_faults(measured)), "");
}

TEST(FindFaults, ASlowSwingIsNoStandingCamera) {
  std::vector<RgbdFrame> frames;
  for (int v = 0; v < 5; ++v) {
    const double angle = 0.05 * v;
    frames.push_back(render_view(
        test::look_at_point({1.1 * std::sin(angle), -1.1 * std::cos(angle), 0.75}, {0, 0.1, 0.15}), 0.0015, v));
    frames.back().world_from_camera = Rigid3();
  }
  const auto measured = measure_sequence(test::MemorySequence(frames), {.max_views = 24, .num_threads = 1}).value();
  EXPECT_LT(measured.pair_shift_px, 8);  // Of an image 320 px wide.
  const std::vector<Finding> findings = find_faults(measured);
  ASSERT_EQ(findings.size(), 1U) << names_of(findings) << measured.pair_shift_px;
  EXPECT_EQ(findings[0].fault, "fixed_poses");
}

// Their standard errors come from few pairs, and are uncertain themselves. The poses are called what they are: coarse.
TEST(FindFaults, FewNoisyViewsAreNoWrongUnit) {
  int num_compared = 0;
  for (int sequence = 0; sequence < 12; ++sequence) {
    Rng rng(static_cast<std::uint64_t>(sequence));
    std::vector<RgbdFrame> frames;
    for (int v = 0; v < 4; ++v) {
      frames.push_back(render_view(swinging_camera(v), 0.012, 100 * sequence + v));
      const Eigen::Vector3d axis(rng.normal(), rng.normal(), rng.normal());
      const Eigen::Vector3d off_m(0.015 * rng.normal(), 0.015 * rng.normal(), 0.015 * rng.normal());
      Rigid3& pose = frames.back().world_from_camera;
      pose = pose * Rigid3{Rigid3::from_axis_angle(axis, 0.015 * rng.normal()).rotation, off_m};
    }
    const auto measured = measure_sequence(test::MemorySequence(frames), {.max_views = 24, .num_threads = 1}).value();
    num_compared += static_cast<int>(measured.pairs.size());
    for (const Finding& f : find_faults(measured)) EXPECT_EQ(f.fault, "pose_error") << sequence << " " << f.message;
  }
  EXPECT_GE(num_compared, 12 * 3);
}

TEST(FindFaults, WithoutPairsMuchIsNotMeasured) {
  const test::MemorySequence two({good_sequence().read_view(0).value(), good_sequence().read_view(7).value()});
  const auto measured = measure_sequence(two, {.max_views = 24, .num_threads = 1}).value();
  EXPECT_EQ(names_of(find_faults(measured)), "");
  ASSERT_EQ(list_unmeasured(measured, true).size(), 1U);
  EXPECT_NE(list_unmeasured(measured, true).front().find("intrinsics, poses and the time"), std::string::npos);
}

TEST(FindFaults, OnlyPosesOrKnownObjectsTellTheUnitOfDepth) {
  const test::BrokenSequence fixed(good_sequence(), "poses_fixed");
  std::vector<RgbdFrame> standing(4, good_sequence().read_view(0).value());
  const test::MemorySequence still(standing);
  for (const Sequence* sequence : {static_cast<const Sequence*>(&fixed), static_cast<const Sequence*>(&still)}) {
    const auto measured = measure_sequence(*sequence, {.max_views = 24, .num_threads = 1}).value();
    const std::size_t num_others = sequence == &still ? 1 : 0;  // Intrinsics.
    ASSERT_EQ(list_unmeasured(measured, false).size(), 1 + num_others);
    EXPECT_NE(list_unmeasured(measured, false).front().find("unit of the depth"), std::string::npos);
    EXPECT_EQ(list_unmeasured(measured, true).size(), num_others);
  }
}

// The jitter of a tracker is no motion that tells a scale.
TEST(FindFaults, JitteringPosesOfAStandingCameraTellNoUnit) {
  Rng rng(3);
  std::vector<RgbdFrame> standing;
  for (int v = 0; v < 5; ++v) {
    standing.push_back(render_view(swinging_camera(0), 0.0015, v + 1));
    for (double& coordinate : standing.back().world_from_camera.translation) coordinate += 0.0002 * rng.normal();
  }
  const auto measured = measure_sequence(test::MemorySequence(standing), {.max_views = 24, .num_threads = 1}).value();
  const std::vector<std::string> unmeasured = list_unmeasured(measured, false);
  ASSERT_EQ(unmeasured.size(), 2U);
  EXPECT_NE(unmeasured[0].find("unit of the depth"), std::string::npos);
  EXPECT_NE(unmeasured[1].find("intrinsics"), std::string::npos);
}

TEST(FindFaults, WhatTheMotionDoesNotTellIsNotMeasured) {
  const auto good = measure_sequence(good_sequence(), {.max_views = 24, .num_threads = 1}).value();
  const auto unmeasured = [&](const std::function<void(SequenceMeasurements&)>& change) {
    SequenceMeasurements measured = good;
    change(measured);
    const std::vector<std::string> list = list_unmeasured(measured);
    return list.size() == 1 ? list.front() : std::to_string(list.size()) + " lines";
  };
  const auto scale = [](SequenceMeasurements& m) -> std::optional<Estimate>& {
    return m.poses->readings.front().fit.log_scale;
  };
  EXPECT_THAT(unmeasured([](auto& m) { m.intrinsics.reset(); }), testing::HasSubstr("intrinsics (12 of 12 pairs"));
  EXPECT_THAT(unmeasured([](auto& m) { m.intrinsics->log_focal.standard_error = 0.1; }),
              testing::HasSubstr("intrinsics (the views tell the focal length"));
  EXPECT_THAT(unmeasured([](auto& m) { m.pair_shift_px = 4; }), testing::HasSubstr("intrinsics (views differ by 4.0"));
  EXPECT_THAT(unmeasured([&](auto& m) { scale(m).reset(); }), testing::HasSubstr("unit of the depth"));
  EXPECT_THAT(unmeasured([&](auto& m) { scale(m)->standard_error = 0.1; }), testing::HasSubstr("unit of the depth"));
  EXPECT_THAT(unmeasured([](auto& m) {
                for (std::size_t i = 2; i < m.pairs.size(); ++i) m.pairs[i].shows_change = true;
              }),
              testing::AnyOf(testing::HasSubstr("poses"), "2 lines"));
}

/// Most of the texture is on a thing that moves in the middle of the sequence; little is on the wall.
test::MemorySequence sequence_with_move(int num_views) {
  std::vector<RgbdFrame> frames;
  for (int v = 0; v < num_views; ++v) {
    const test::BallScene scene{
        .ball_m = {v < num_views / 2 ? 0.0 : 0.12, 0.1, 0.2}, .ball_radius_m = 0.2, .ball_print = true};
    const Rigid3 pose = swinging_camera(v);
    RgbdFrame frame = sharpen(test::render_ball_scene(scene, pose, 0.0015, static_cast<std::uint64_t>(v + 1)));
    for (int y = 0; y < frame.color.height(); ++y)
      for (int x = 0; x < frame.color.width(); ++x) {
        const Eigen::Vector3d p = pose * frame.camera.unproject(x, y, frame.depth_m(x, y));
        const bool is_ball = (p - scene.ball_m).norm() < scene.ball_radius_m + 0.01;
        if (!is_ball && std::abs(p.x() + 0.5) > 0.2) frame.color(x, y) = {128, 128, 128};
      }
    frame.name = std::to_string(v);
    frames.push_back(std::move(frame));
  }
  return test::MemorySequence(std::move(frames));
}

// Of five views, most pairs are of the thing before and after the move; of eight, all that are far apart.
TEST(FindFaults, AThingThatHasMovedIsNoPoseError) {
  for (const int num_views : {5, 8}) {
    const auto measured = measure_sequence(sequence_with_move(num_views), {.max_views = 24, .num_threads = 1}).value();
    EXPECT_GE(std::ranges::count(measured.pairs, true, &ViewPair::shows_change), 3) << "the matches are on what stays";
    EXPECT_EQ(std::ranges::count(measured.far_pairs, false, &ViewPair::shows_change), 0);
    EXPECT_EQ(names_of(find_faults(measured)), "");
    EXPECT_EQ(list_unmeasured(measured).size(), num_views == 5 ? 1U : 0U);
  }
}

TEST(FindFaults, PoseErrorsAreFoundWhereAThingHasMoved) {
  const test::MemorySequence moved = sequence_with_move(8);
  for (const char* name : {"poses_noisy", "poses_drift", "poses_inverted", "poses_1_view_late"})
    EXPECT_NE(names_of(check(test::BrokenSequence(moved, name))), "") << name;
}

TEST(FindFaults, OneBlurredViewOfSeveralIsNoFault) {
  const test::BrokenSequence blurred(good_sequence(), "motion_blur");
  std::vector<RgbdFrame> frames;
  for (int v = 0; v < 5; ++v) frames.push_back(good_sequence().read_view(v).value());
  frames[2] = blurred.read_view(2).value();
  const auto faults_of = [](std::vector<RgbdFrame> views) {
    return find_faults(
        measure_sequence(test::MemorySequence(std::move(views)), {.max_views = 24, .num_threads = 1}).value());
  };
  EXPECT_EQ(names_of(faults_of(frames)), "");
  frames[3] = blurred.read_view(3).value();
  EXPECT_NE(names_of(faults_of(frames)).find("motion_blur"), std::string::npos);
  EXPECT_NE(names_of(faults_of({frames[2]})).find("motion_blur"), std::string::npos);
}

TEST(FindFaults, AShiftThatTheViewsDoNotAgreeOnIsNone) {
  const auto shifts = [](int first_px, int second_px) {
    std::array<ShiftScores, 2> halves;
    for (int v = 0; v < 8; ++v) {
      RgbdFrame frame = good_sequence().read_view(v).value();
      align_colors({.shift_px = {v % 2 == 0 ? first_px : second_px, 0}}, frame);
      halves[static_cast<std::size_t>(v % 2)].add(prepare_view(std::move(frame)));
    }
    return find_unregistered_shift(halves);
  };
  EXPECT_TRUE(shifts(-9, -9).has_value());
  EXPECT_NEAR(shifts(-9, -9)->shift_px.x(), 9, 1);
  EXPECT_FALSE(shifts(-5, -7).has_value());
  EXPECT_FALSE(shifts(-9, 9).has_value());
}

/// The good sequence with colours that lie beside the depth.
std::string faults_of_shifted(const ColorDepthShift& shift) {
  std::vector<RgbdFrame> frames;
  for (int v = 0; v < 8; ++v) {
    frames.push_back(good_sequence().read_view(v).value());
    align_colors(shift, frames.back());
  }
  return names_of(check(test::MemorySequence(std::move(frames))));
}

// The fine search ends where the wide one begins.
TEST(FindFaults, ShiftsBetweenTheTwoSearchesAreFound) {
  for (const Eigen::Vector2d& shift_px : {Eigen::Vector2d(4, 0), Eigen::Vector2d(-5, 0), Eigen::Vector2d(0, 5)})
    EXPECT_NE(faults_of_shifted({.shift_px = shift_px}), "") << shift_px.transpose();
  for (const double scale : {0.95, 1.05})
    EXPECT_THAT(faults_of_shifted({.scale = scale}), testing::StartsWith("unregistered_depth")) << scale;
}

TEST(FindFaults, LimitsInPixelsGrowWithTheImages) {
  SequenceMeasurements measured;
  measured.camera = {1600, 1200, 1300, 1300, 800, 600};
  EXPECT_EQ(measured.pixel_scale(), 2.5);
  measured.camera = {480, 640, 520, 520, 240, 320};
  EXPECT_EQ(measured.pixel_scale(), 1);
  const auto findings_of_shifted = [](int shift_px) {  // Of images 1280 px wide.
    std::vector<RgbdFrame> frames;
    for (int v = 0; v < 3; ++v) {
      frames.push_back(test::enlarge(good_sequence().read_view(v).value()));
      align_colors({.shift_px = {-shift_px, 0}}, frames.back());
    }
    return check(test::MemorySequence(std::move(frames)));
  };
  EXPECT_THAT(names_of(findings_of_shifted(6)), testing::Not(testing::HasSubstr("unregistered_depth")));
  const std::vector<Finding> findings = findings_of_shifted(24);
  ASSERT_EQ(findings.size(), 1U) << names_of(findings);
  EXPECT_EQ(findings[0].fault, "unregistered_depth");
  EXPECT_NEAR(findings[0].value, 24, 2);
  EXPECT_EQ(findings[0].threshold, 10);
}

TEST(ColorValues, EdgesOfAPortraitAreAsWideAsThoseOfALandscape) {
  const Image<Rgb8> landscape = test::enlarge(good_sequence().read_view(0).value()).color;
  Image<Rgb8> portrait(landscape.height(), landscape.width());
  for (int v = 0; v < portrait.height(); ++v)
    for (int u = 0; u < portrait.width(); ++u) portrait(u, v) = landscape(v, u);
  EXPECT_NEAR(measure_color_values(portrait).edge_width_px, measure_color_values(landscape).edge_width_px, 1e-3);
}

/// Views whose depth was measured `late` views after their colours.
test::MemorySequence sequence_with_late_depth(double late) {
  std::vector<RgbdFrame> frames;
  for (int v = 0; v < 8; ++v) {
    const auto camera_at = [](double view) {  // To and fro, by up to 0.1 rad a view.
      const double angle = 0.3 * std::sin(0.35 * view);
      return test::look_at_point({1.1 * std::sin(angle), -1.1 * std::cos(angle), 0.75}, {0.3 * angle, 0.1, 0.15});
    };
    frames.push_back(render_view(camera_at(v), 0.0015, v));
    frames.back().depth_m = render_view(camera_at(v + late), 0.0015, v).depth_m;
  }
  return test::MemorySequence(std::move(frames));
}

TEST(FindFaults, DepthOfAnotherTimeIsFoundWithItsSign) {
  for (const double late : {-0.75, 0.5, 1.0}) {
    const auto findings = check(sequence_with_late_depth(late));
    ASSERT_EQ(findings.size(), 1U) << late << " " << names_of(findings);
    EXPECT_EQ(findings[0].fault, "depth_time") << late << " " << findings[0].message;
    EXPECT_NEAR(findings[0].value, late, 0.26);
  }
  EXPECT_EQ(names_of(check(sequence_with_late_depth(0))), "");
}

// Neighbours at video rate hardly differ, but that does not mean that the camera stands still, or that its poses are
// right.
TEST(FindFaults, ASlowCameraIsCheckedByViewsFarApart) {
  std::vector<RgbdFrame> frames;
  for (int v = 0; v < 60; ++v) {
    const double angle = -0.3 + 0.01 * v;
    const Rigid3 pose = test::look_at_point({1.1 * std::sin(angle), -1.1 * std::cos(angle), 0.75}, {0, 0.1, 0.15});
    frames.push_back(render_view(pose, 0.0015, v));
  }
  const test::MemorySequence slow(std::move(frames));
  const auto measured = measure_sequence(slow, {.max_views = 12, .num_threads = 1}).value();
  EXPECT_GT(measured.pair_shift_px, 5);
  EXPECT_EQ(names_of(find_faults(measured)), "");
  EXPECT_TRUE(list_facts(measured).empty());
  const auto findings = find_faults(
      measure_sequence(test::BrokenSequence(slow, "focal_x1.3"), {.max_views = 12, .num_threads = 1}).value());
  ASSERT_EQ(findings.size(), 1U) << names_of(findings);
  EXPECT_EQ(findings[0].fault, "intrinsics");
}

TEST(EvaluatePoses, PosesThatReachNoPairExplainNothing) {
  const auto measured = measure_sequence(good_sequence(), {.max_views = 24, .num_threads = 1}).value();
  const auto nowhere = [](const ViewPair&) { return std::optional<Rigid3>(); };
  EXPECT_TRUE(std::isinf(evaluate_poses(measured.pairs, measured.camera, nowhere).error_px));
}

// Shifted by four views, the poses of a short sequence reach few of its pairs. Those tell nothing of their time.
TEST(MeasurePoses, ShiftsMustReachHalfOfThePairs) {
  const auto measured = measure_sequence(good_sequence(), {.max_views = 24, .num_threads = 1}).value();
  ASSERT_TRUE(measured.poses);
  EXPECT_FALSE(measured.poses->shifted.empty());
  for (const TriedReading& shifted : measured.poses->shifted)
    EXPECT_GE(2 * shifted.fit.pair_errors_px.size(), measured.pairs.size()) << shifted.reading.views_late;
}

TEST(PictureNames, EachFindingHasItsOwn) {
  std::vector<Finding> findings(3);
  findings[0].fault = findings[2].fault = "model_size";
  findings[1].fault = "depth_scale";
  EXPECT_THAT(picture_names(findings), testing::ElementsAre("model_size.png", "depth_scale.png", "model_size_2.png"));
}

class BreakageTest : public ::testing::TestWithParam<test::Breakage> {};

TEST_P(BreakageTest, IsFound) {
  const test::BrokenSequence broken(good_sequence(), GetParam().name);
  const std::vector<Finding> findings = check(broken);
  EXPECT_TRUE(std::ranges::any_of(findings, [&](const Finding& f) {
    return std::ranges::find(GetParam().expected, f.fault) != GetParam().expected.end();
  })) << names_of(findings);
  for (const Finding& f : findings) {
    EXPECT_GE(f.margin, 1) << f.message;
    EXPECT_FALSE(f.remedy.empty());
  }
}

std::string breakage_name(const ::testing::TestParamInfo<test::Breakage>& info) {
  std::string name = info.param.name;
  std::ranges::replace_if(
      name, [](char c) { return c == '.' || c == '-'; }, '_');
  return name;
}

INSTANTIATE_TEST_SUITE_P(All, BreakageTest, ::testing::ValuesIn(test::breakages()), breakage_name);

}  // namespace
}  // namespace resight
