// SPDX-License-Identifier: Apache-2.0
#include "resight/inspection/find_faults.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <malloc.h>

#include <algorithm>
#include <functional>
#include <iterator>
#include <limits>
#include <stdexcept>
#include <tuple>

#include "resight/core/random.hpp"
#include "resight/inspection/quick_check.hpp"
#include "resight/inspection/testing/broken_sequence.hpp"
#include "resight/sensor/testing/ball_scene.hpp"
#include "resight/sensor/testing/memory_sequence.hpp"

namespace resight {
namespace {

/// Gives the smooth texture sharp edges, as printed things have.
RgbdFrame sharpen(RgbdFrame frame) {
  for (Rgb8& c : frame.color.data()) c.r = c.g = c.b = c.r > 160 ? 220 : c.r > 110 ? 130 : 50;
  return frame;
}

/// Pose of a camera that swings around a ball before a wall, with changing speed.
Rigid3 swinging_camera(int view) {
  const double angle = -0.5 + 0.13 * view + 0.05 * (view % 3);
  const Eigen::Vector3d eye(1.1 * std::sin(angle), -1.1 * std::cos(angle), 0.75 + 0.06 * (view % 2));
  return test::look_at_point(eye, {0.05 * (view % 2), 0.1, 0.15});
}

RgbdFrame render_view(const Rigid3& pose, double noise_m, int seed) {
  RgbdFrame frame = sharpen(test::render_ball_scene({}, pose, noise_m, static_cast<std::uint64_t>(seed)));
  frame.name = std::to_string(seed);
  return frame;
}

const test::MemorySequence& good_sequence() {
  static const test::MemorySequence sequence = [] {
    std::vector<RgbdFrame> frames;
    for (int v = 0; v < 8; ++v) frames.push_back(render_view(swinging_camera(v), 0.0015, v + 1));
    return test::MemorySequence(std::move(frames));
  }();
  return sequence;
}

std::vector<Finding> check(const Sequence& sequence) {
  return find_faults(measure_sequence(sequence, {.max_views = 24, .num_threads = 1}).value());
}

std::string names_of(const std::vector<Finding>& findings) {
  std::string names;
  for (const Finding& f : findings) names += f.fault + ": " + f.message + "; ";
  return names;
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

TEST(CheckQuickly, SeesWhatTheFirstViewsShow) {
  for (const char* name :
       {"depth_x0.1", "depth_x1000", "no_depth", "eight_bits", "black", "intrinsics_of_double_size", "focal_1e-6",
        "focal_1e300", "poses_in_mm", "poses_inverted", "poses_opengl", "poses_100_km_away"}) {
    const test::BrokenSequence broken(good_sequence(), name);
    EXPECT_EQ(check_quickly(broken, true).size(), 1U) << name << " " << names_of(check_quickly(broken, true));
  }
}

TEST(CheckQuickly, SeesWhatLaterViewsShow) {
  for (const int faulty : {3, 5}) {
    std::vector<RgbdFrame> frames;
    for (int v = 0; v < 6; ++v) frames.push_back(good_sequence().read_view(v).value());
    std::ranges::fill(frames[static_cast<std::size_t>(faulty)].depth_m.data(), std::numeric_limits<float>::quiet_NaN());
    const std::vector<Finding> findings = check_quickly(test::MemorySequence(std::move(frames)), true);
    ASSERT_EQ(findings.size(), 1U) << names_of(findings);
    EXPECT_EQ(findings.front().view, faulty);
  }
}

// As views come one by one from a camera.
TEST(PoseCheck, SaysOnceThatPosesAreInverted) {
  const test::BrokenSequence broken(good_sequence(), "poses_inverted");
  PoseCheck check;
  std::vector<Finding> findings;
  for (int v = 0; v < broken.num_views(); ++v)
    std::ranges::move(check.add(broken.read_view(v).value(), v), std::back_inserter(findings));
  ASSERT_EQ(findings.size(), 1U) << names_of(findings);
  EXPECT_EQ(findings.front().fault, "pose_convention");
  EXPECT_TRUE(check.is_done());
}

/// Bytes that are allocated now; always the same with sanitizers, which bring their own heap.
std::size_t allocated_bytes() {
  const struct mallinfo2 info = mallinfo2();
  return info.uordblks + info.hblkhd;
}

TEST(PoseCheck, KeepsNoViewWhenItIsDone) {
  constexpr std::size_t kDepthBytes = std::size_t{4} * 640 * 480;
  RgbdFrame first = render_view(test::look_at_point({0.1, -1.3, 0.8}, {0, 0.1, 0.15}), 0.0015, 1);
  first.color = Image<Rgb8>(640, 480);
  first.depth_m = Image<float>(640, 480, 1.0F);
  RgbdFrame later = first;
  later.world_from_camera.translation.x() += 0.5;
  const std::size_t before = allocated_bytes();
  PoseCheck check;
  std::ignore = check.add(first, 0);
  std::ignore = check.add(later, 1);
  std::ignore = check.add(first, 2);
  EXPECT_TRUE(check.is_done());
  EXPECT_LT(allocated_bytes(), before + kDepthBytes);
}

TEST(CheckQuickly, SaysWhichUnitIsWrong) {
  const auto found = [](double pose_factor, float depth_factor) {
    std::vector<RgbdFrame> frames;
    for (int v = 0; v < 6; ++v) {
      frames.push_back(good_sequence().read_view(v).value());
      // A small scene, so that no depth is too far by itself.
      frames.back().world_from_camera.translation *= 0.2 * pose_factor;
      for (float& z_m : frames.back().depth_m.data()) z_m *= 0.2F * depth_factor;
    }
    const std::vector<Finding> findings = check_quickly(test::MemorySequence(std::move(frames)), true);
    return findings.size() == 1 ? findings.front().message : std::to_string(findings.size()) + " findings";
  };
  EXPECT_EQ(found(1, 1), "0 findings");
  EXPECT_NE(found(1000, 1).find("poses are in millimetres"), std::string::npos) << found(1000, 1);
  EXPECT_NE(found(0.001, 1).find("in metres where millimetres"), std::string::npos) << found(0.001, 1);
  EXPECT_NE(found(1, 10).find("depth is a tenth of what it says"), std::string::npos) << found(1, 10);
  EXPECT_NE(found(1, 5).find("depth is a fifth of what it says"), std::string::npos) << found(1, 5);
  EXPECT_NE(found(5, 1).find("depth is five times what it says"), std::string::npos) << found(5, 1);
}

/// Views of a camera that moves by `step_m` and turns by `turn_rad` from each view to the next, with poses of a unit.
test::MemorySequence moving_views(const Eigen::Vector3d& step_m, double turn_rad, double pose_factor, int num_views) {
  const Rigid3 start = test::look_at_point({0.1, -1.3, 0.8}, {0, 0.1, 0.15});
  std::vector<RgbdFrame> frames;
  for (int v = 0; v < num_views; ++v) {
    const Rigid3 step{Rigid3::from_axis_angle({0, 1, 0}, v * turn_rad).rotation, v * step_m};
    frames.push_back(render_view(start * step, 0.0015, v + 1));
    frames.back().world_from_camera.translation *= pose_factor;
  }
  return test::MemorySequence(std::move(frames));
}

// A camera that moves along a wall sees the same depths everywhere.
TEST(CheckQuickly, SeesPosesInMetresOfACameraThatHardlyTurns) {
  for (const Eigen::Vector3d& step_m : {Eigen::Vector3d(0, 0, 0.06), {0, -0.06, 0}, {0.04, 0, 0.04}})
    for (const double turn_rad : {0.0, 0.02}) {
      const std::string found = names_of(check_quickly(moving_views(step_m, turn_rad, 0.001, 9), true));
      EXPECT_NE(found.find("in metres where millimetres"), std::string::npos)
          << step_m.transpose() << ", turned by " << turn_rad << ": " << found;
    }
}

// By 0.17 rad per view: the rotation alone makes most of the depths agree.
TEST(CheckQuickly, SeesPosesInMetresOfACameraThatCirclesQuickly) {
  const test::BallScene scene{.ball_m = {0, 0, 0.25}, .ball_radius_m = 0.25};
  std::vector<RgbdFrame> frames;
  for (int v = 0; v < 2; ++v) {
    const double angle = -0.35 + 0.17 * v;
    const Rigid3 pose = test::look_at_point({std::sin(angle), -std::cos(angle), 0.6}, scene.ball_m);
    frames.push_back(test::render_ball_scene(scene, pose, 0.0015, static_cast<std::uint64_t>(v + 1)));
  }
  EXPECT_EQ(names_of(check_quickly(test::MemorySequence(frames), true)), "");
  for (RgbdFrame& frame : frames) frame.world_from_camera.translation *= 0.001;
  const std::string found = names_of(check_quickly(test::MemorySequence(frames), true));
  EXPECT_NE(found.find("in metres where millimetres"), std::string::npos) << found;
}

TEST(CheckQuickly, LeavesSlowAndStandingCamerasAlone) {
  for (const double step_m : {0.0001, 0.0005, 0.006})
    for (const double turn_rad : {0.0, 0.001, 0.02}) {
      const auto views = moving_views({0.6 * step_m, 0, 0.8 * step_m}, turn_rad, 1, 7);
      EXPECT_EQ(names_of(check_quickly(views, true)), "") << step_m << " m, turned by " << turn_rad;
    }
}

TEST(CheckQuickly, LeavesPosesAloneThatAreNotUsed) {
  EXPECT_TRUE(check_quickly(test::BrokenSequence(good_sequence(), "poses_inverted"), false).empty());
}

}  // namespace
}  // namespace resight
