// SPDX-License-Identifier: Apache-2.0
#include "resight/inspection/object_scale.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <tuple>

#include "resight/core/random.hpp"
#include "resight/features/sift.hpp"
#include "resight/sensor/testing/ball_scene.hpp"
#include "resight/sensor/testing/memory_sequence.hpp"

namespace resight {
namespace {

RgbdFrame ball_view(int number) {
  const double angle = 0.06 * number;
  const Rigid3 pose = test::look_at_point({0.9 * std::sin(angle), -0.9 * std::cos(angle), 0.6}, {0, 0.1, 0.15});
  RgbdFrame frame = test::render_ball_scene({}, pose, 0.001, static_cast<std::uint64_t>(number + 1));
  frame.name = std::to_string(number);
  return frame;
}

/// Depths of all views times `depth_scale`.
test::MemorySequence ball_sequence(float depth_scale = 1) {
  std::vector<RgbdFrame> frames;
  for (int v = 1; v < 6; ++v) {
    frames.push_back(ball_view(v));
    for (float& z_m : frames.back().depth_m.data()) z_m *= depth_scale;
  }
  return test::MemorySequence(std::move(frames));
}

/// Two "objects": the left and the right part of what the first view shows. `scales`: of their models.
ModelLibrary make_parts(float left_scale, float right_scale) {
  const PreparedView view = prepare_view(ball_view(0));
  ModelLibrary library;
  for (const auto& [name, from, to, scale] :
       {std::tuple("left", 0, 150, left_scale), std::tuple("right", 150, 320, right_scale)}) {
    Image<std::uint8_t> mask(320, 240, 0);
    for (int v = 0; v < 240; ++v)
      for (int u = from; u < to; ++u) mask(u, v) = 255;
    ObjectModel object;
    object.name = name;
    object.sift = encode(extract_sift(view, {}, &mask));
    for (Eigen::Vector3f& p : object.sift.points) p *= scale;
    object.diameter_m = 0.8F * scale;
    library.objects.push_back(std::move(object));
  }
  return library;
}

ObjectScales measure(const Sequence& sequence, const ModelLibrary& library, int num_threads = 1) {
  return measure_object_scales(sequence, library, {.max_views = 12, .num_threads = num_threads}).value();
}

ObjectScales sightings(const std::vector<double>& log_scales) {
  ObjectScales scales{.found = {}, .num_views = 12, .num_objects = 1};
  for (const double s : log_scales) scales.found.push_back({.object = 0, .view = 0, .log_scale = s, .num_matches = 20});
  return scales;
}

// Their spread is uncertain, too.
TEST(ObjectScale, FewNoisySightingsAreNoWrongSize) {
  const ModelLibrary library = make_parts(1, 1);
  Rng rng(3);
  for (const int num_sightings : {3, 4, 6, 12}) {
    int num_wrong = 0;
    for (int trial = 0; trial < 1000; ++trial) {
      std::vector<double> log_scales;
      for (int i = 0; i < num_sightings; ++i) log_scales.push_back(rng.normal());
      num_wrong += find_scale_faults(sightings(log_scales), library).empty() ? 0 : 1;
    }
    EXPECT_LE(num_wrong, 6) << num_sightings;
  }
}

TEST(ObjectScale, TheMiddleOfTwoSightingsIsBetweenThem) {
  EXPECT_NE(describe_scales(sightings({-0.1, -0.1, 0.1, 0.1})).find("are 1.000 times"), std::string::npos);
}

TEST(ObjectScale, RightModelsHaveNoFault) {
  const ModelLibrary library = make_parts(1, 1);
  const ObjectScales scales = measure(ball_sequence(), library);
  ASSERT_GE(scales.found.size(), 8U);
  for (const ObjectScale& found : scales.found) EXPECT_NEAR(found.log_scale, 0, 0.03) << found.object;
  EXPECT_TRUE(find_scale_faults(scales, library).empty());
  EXPECT_TRUE(scales.is_measured());
  EXPECT_NE(describe_scales(scales).find("times as large"), std::string::npos);
}

TEST(ObjectScale, ModelsInAnotherUnitAreFound) {
  for (const float scale : {1000.0F, 0.0254F, 1.2F}) {
    const ModelLibrary library = make_parts(scale, scale);
    const auto findings = find_scale_faults(measure(ball_sequence(), library), library);
    ASSERT_EQ(findings.size(), 1U) << scale;
    EXPECT_EQ(findings[0].fault, "model_size");
    EXPECT_NEAR(findings[0].value * scale, 1, 0.03);
    EXPECT_GT(findings[0].margin, 1);
  }
}

TEST(ObjectScale, DepthInAnotherUnitIsFound) {
  const ModelLibrary library = make_parts(1, 1);
  const auto findings = find_scale_faults(measure(ball_sequence(10), library), library);
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_NEAR(findings[0].value, 10, 0.3);
  EXPECT_NE(findings[0].remedy.find("--depth-scale 0.1 times"), std::string::npos) << findings[0].remedy;
}

TEST(ObjectScale, ASingleModelInAnotherUnitIsNamed) {
  const ModelLibrary library = make_parts(1, 10);
  const auto findings = find_scale_faults(measure(ball_sequence(), library), library);
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_EQ(findings[0].message.substr(0, 8), "right is");
  EXPECT_NEAR(findings[0].value, 0.1, 0.003);
}

// The only object of the library is the nearest one to all keypoints of the image, whose upper part has hundreds.
TEST(ObjectScale, AnObjectBelowManyOtherFeaturesIsFound) {
  const PreparedView view = prepare_view(ball_view(0));
  Image<std::uint8_t> mask(320, 240, 0);
  for (int v = 170; v < 240; ++v)
    for (int u = 0; u < 320; ++u) mask(u, v) = 255;
  ModelLibrary library;
  ObjectModel& object = library.objects.emplace_back();
  object.name = "lower";
  object.sift = encode(extract_sift(view, {}, &mask));
  object.diameter_m = 0.8F;
  ASSERT_GE(object.sift.size(), 30U);
  ASSERT_GE(extract_sift(view).size(), 300U);
  EXPECT_GE(measure(ball_sequence(), library).found.size(), 4U);
}

TEST(ObjectScale, UntexturedModelsTellNothing) {
  ModelLibrary library = make_parts(1, 1);
  for (ObjectModel& object : library.objects) object.sift = {};
  const ObjectScales scales = measure(ball_sequence(), library);
  EXPECT_FALSE(scales.is_measured());
  EXPECT_TRUE(find_scale_faults(scales, library).empty());
  EXPECT_EQ(describe_scales(scales), "the sizes of the known objects (0 of 0 textured ones found in 5 views)");
}

TEST(ObjectScale, ModelsWithoutExtentTellNothing) {
  EXPECT_TRUE(measure(ball_sequence(), make_parts(0, 0)).found.empty());
}

TEST(ObjectScale, ResultsDoNotDependOnThreads) {
  const ModelLibrary library = make_parts(1.2F, 1.2F);
  const ObjectScales one = measure(ball_sequence(), library);
  const ObjectScales three = measure(ball_sequence(), library, 3);
  ASSERT_EQ(one.found.size(), three.found.size());
  for (std::size_t i = 0; i < one.found.size(); ++i) EXPECT_EQ(one.found[i].log_scale, three.found[i].log_scale);
}

}  // namespace
}  // namespace resight
