// SPDX-License-Identifier: Apache-2.0
// What texture and colour decide in verify_hypotheses().
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "resight/verification/hypothesis_verifier.hpp"
#include "resight/verification/testing/verify_fixture.hpp"

namespace resight {
namespace {

using namespace analytic;

// Painted all round, so that each turn looks different.
Solid printed_can() {
  const Paint paint = [](const Eigen::Vector3d& p) {
    const double angle = std::atan2(p.y(), p.x());
    return angle < -1.5 ? Rgb8{200, 40, 40} : angle < 0.3 ? Rgb8{230, 220, 200} : Rgb8{50, 80, 180};
  };
  return {Shape::kCylinder, {0.08, 0.08, 0.12}, paint, on_table(0, 0, 0.06, 0.4)};
}

TEST(VerifyTexture, RotatesRoundObjectsToTheBestTexture) {
  const Solid can = printed_can();
  ModelLibrary library{.objects = {make_model("can", can)}};
  library.objects[0].shape_symmetries.continuous.push_back({.direction = kZ});
  const Fixture f({.solids = {can}}, circle_of_cameras(2, 0.8, 0.4, 1.0));
  const auto angle_left_deg = [&](double turned_deg, std::optional<double> step_rad) {
    const Rigid3 pose = can.world_from_object * Rigid3::from_axis_angle(kZ, turned_deg / 57.29578);
    const VerifyResult result =
        f.verify({make_hypothesis(0, pose)}, library, {.refine = {.symmetry_step_rad = step_rad}});
    return 57.29578 * rotation_angle_rad(result.evidence[0].world_from_object.rotation, can.world_from_object.rotation);
  };
  for (const double turned_deg : {-100.0, 37.0, 170.0}) {
    EXPECT_NEAR(angle_left_deg(turned_deg, std::nullopt), std::abs(turned_deg), 5)
        << turned_deg;  // Shape says nothing of it.
    EXPECT_LT(angle_left_deg(turned_deg, 0.1745), 12) << turned_deg;
  }
  EXPECT_LT(angle_left_deg(0, 0.1745), 5);  // What is right stays.
}

TEST(VerifyTexture, NoRotationToAWorseFit) {
  // In blue light the yellowish side looks as blue as the other; its texture is its own.
  const auto painted = [](double blue) -> Paint {
    return [=](const Eigen::Vector3d& p) {
      const bool front = p.x() > 0;
      const bool dark = std::fmod(std::abs(p.z()) + (front ? 0.0 : 0.0015), 0.02) < 0.01;
      const double grey = dark ? 130 : 170;
      return Rgb8{static_cast<std::uint8_t>(grey * (front ? 1 : 0.8) / blue), static_cast<std::uint8_t>(grey),
                  static_cast<std::uint8_t>(std::min(255.0, grey * (front ? 0.8 : 1) * blue))};
    };
  };
  Solid can = printed_can();
  can.world_from_object = on_table(0, 0, 0.06);
  can.paint = painted(1);
  ModelLibrary library{.objects = {make_model("can", can)}};
  library.objects[0].shape_symmetries.continuous.push_back({.direction = kZ});
  can.paint = painted(1.7);
  const Fixture f({.solids = {can}}, {look_at({0.8, 0, 0.4}, {0, 0, 0.05})});
  const VerifyResult result =
      f.verify({make_hypothesis(0, can.world_from_object)}, library, {.refine = {.symmetry_step_rad = 0.1745}});
  EXPECT_LT(rotation_angle_rad(result.evidence[0].world_from_object.rotation, can.world_from_object.rotation), 0.05);
}

TEST(VerifyTexture, AnUntexturedCanIsNotRotated) {
  // Scan and scene each have stains of their own, of which some turn fits a little better.
  const auto stained = [](double frequency) -> Paint {
    return [=](const Eigen::Vector3d& p) {
      const double stain = std::sin(frequency * p.x() + 40 * p.z()) * std::cos(1.3 * frequency * p.y());
      const auto grey = static_cast<std::uint8_t>(150 + 15 * stain);
      return Rgb8{grey, grey, static_cast<std::uint8_t>(grey + 10)};
    };
  };
  Solid can = printed_can();
  can.paint = stained(90);
  ModelLibrary library{.objects = {make_model("can", can)}};
  can.paint = stained(120);
  library.objects[0].shape_symmetries.continuous.push_back({.direction = kZ});  // As if its own had been overlooked.
  const Fixture f({.solids = {can}}, circle_of_cameras(2, 0.8, 0.4, 1.0));
  const VerifyResult result =
      f.verify({make_hypothesis(0, can.world_from_object)}, library, {.refine = {.symmetry_step_rad = 0.1745}});
  EXPECT_LT(rotation_angle_rad(result.evidence[0].world_from_object.rotation, can.world_from_object.rotation), 0.05);
}

TEST(VerifyTexture, ByDefaultNoTextureIsRejected) {
  // Black for white: the similarity is negative.
  const Rgb8 dark{80, 80, 80};
  const Rgb8 bright{200, 200, 200};
  Solid box{Shape::kBox, {0.1, 0.1, 0.1}, checks(dark, bright, 0.02), on_table(0, 0, 0.05)};
  ModelLibrary library;
  library.objects = {make_model("negative", box)};
  box.paint = checks(bright, dark, 0.02);
  const Fixture f({.solids = {box}}, circle_of_cameras(4));
  const std::vector<Hypothesis> negative = {make_hypothesis(0, box.world_from_object)};
  const HypothesisEvidence evidence =
      f.verify(negative, library, {.appearance = {.light = {0, 0, 0, 0.08}}, .acceptance = {.min_explained_share = 0}})
          .evidence[0];
  EXPECT_LT(evidence.appearance.pattern_similarity, 0);
  EXPECT_GT(evidence.num_explained, 0);
  EXPECT_NE(evidence.verdict, Verdict::kDifferentAppearance);
}

TEST(VerifyTexture, TheNewestViewRejectsAnExchangedObject) {
  // A can stands where another stood, of the same shape: the scene keeps colours of both, the newest view shows one.
  const auto rings = [](Rgb8 even, Rgb8 odd) -> Paint {
    return [=](const Eigen::Vector3d& p) { return std::fmod(p.z() + 1, 0.04) < 0.02 ? even : odd; };
  };
  Solid can{Shape::kCylinder, {0.07, 0.07, 0.12}, rings({190, 60, 60}, {220, 220, 220}), on_table(0, 0, 0.06)};
  ModelLibrary library;
  library.objects = {make_model("before", can)};
  const std::vector<Rigid3> cameras = circle_of_cameras(4);
  Fixture f({.solids = {can}}, cameras);
  can.paint = rings({220, 220, 220}, {60, 160, 60});
  library.objects.push_back(make_model("after", can));
  const PreparedView newest = render_all({.solids = {can}}, {cameras[0]}).front();
  f.views.push_back(newest);  // And the scene as older views have it.
  const auto before = [&](double min_newest_similarity) {
    const std::vector<Hypothesis> hypotheses = {make_hypothesis(0, can.world_from_object)};
    return f.verify(hypotheses, library, {.acceptance = {.min_newest_similarity = min_newest_similarity}}).evidence[0];
  };
  EXPECT_TRUE(before(-1).accepted);
  EXPECT_GT(before(-1).appearance.pattern_similarity, 0.8);
  EXPECT_EQ(before(0.4).verdict, Verdict::kDifferentAppearance);
  EXPECT_LT(before(0.4).appearance.newest_similarity, 0.2);
  f.views.pop_back();
  EXPECT_TRUE(before(0.4).accepted) << "no view shows another";
  EXPECT_GT(before(0.4).appearance.newest_similarity, 0.8);
}

TEST(VerifyTexture, WithoutALimitTheNewestViewStillCountsInTheScore) {
  Solid can = printed_can();
  const ModelLibrary library{.objects = {make_model("before", can)}};
  const std::vector<Rigid3> cameras = circle_of_cameras(4);
  Fixture f({.solids = {can}}, cameras);
  can.paint = checks({60, 160, 60}, {220, 220, 220}, 0.02);
  const auto verify = [&] {
    const VerifyOptions options{.score = {.newest_weight = 1}};
    return f.verify({make_hypothesis(0, can.world_from_object)}, library, options).evidence[0];
  };
  const double score_before = verify().score;
  f.views.push_back(render({.solids = {can}}, cameras[0]));
  const HypothesisEvidence evidence = verify();
  EXPECT_LT(evidence.appearance.newest_similarity, 0.5);
  EXPECT_NE(evidence.verdict, Verdict::kDifferentAppearance);
  EXPECT_LT(evidence.score, score_before - 0.05);
}

TEST(VerifyTexture, ADifferentTextureIsRejected) {
  // The same can, once striped and once in the stripes' mean colour.
  const auto striped = [](const Eigen::Vector3d& p) {
    return std::fmod(std::abs(p.z()), 0.02) < 0.01 ? Rgb8{200, 200, 200} : Rgb8{140, 140, 140};
  };
  Solid can{Shape::kCylinder, {0.07, 0.07, 0.12}, striped, on_table(0, 0, 0.06)};
  ModelLibrary library;
  library.objects = {make_model("striped", can)};
  can.paint = plain({172, 172, 172});
  library.objects.push_back(make_model("plain", can));
  const Fixture f({.solids = {can}}, circle_of_cameras(4));
  const std::vector<Hypothesis> either = {make_hypothesis(0, can.world_from_object),
                                          make_hypothesis(1, can.world_from_object)};
  const VerifyOptions options{.acceptance = {.min_pattern_similarity = 0.8}};
  const VerifyResult result = f.verify(either, library, options);
  EXPECT_THAT(accepted(result), testing::ElementsAre(1));
  EXPECT_EQ(result.evidence[0].verdict, Verdict::kDifferentAppearance);
  EXPECT_LT(result.evidence[0].appearance.pattern_similarity, result.evidence[1].appearance.pattern_similarity - 0.2);
}

TEST(VerifyTexture, ALookAlikeHasOtherHues) {
  Solid box{Shape::kBox, {0.1, 0.1, 0.1}, checks({200, 60, 60}, {230, 220, 120}, 0.03), on_table(0, 0, 0.05)};
  ModelLibrary library;
  library.objects = {make_model("textured", box)};
  Solid red_box = box;
  red_box.paint = plain({150, 90, 90});
  library.objects.push_back(make_model("untextured", red_box));
  const auto hue_similarity_of = [&](int object, const Paint& seen) {
    box.paint = seen;
    const Fixture f({.solids = {box}}, circle_of_cameras(4));
    VerifyOptions options{.acceptance = {.min_explained_share = 0}};
    options.support.min_weight = 1e-9;  // Other colours are still support.
    options.appearance.pattern_radius_m = 0.015;
    const std::vector<Hypothesis> one = {make_hypothesis(object, box.world_from_object)};
    return f.verify(one, library, options).evidence[0].appearance.hue_similarity;
  };
  const double same = hue_similarity_of(0, box.paint);
  const double other = hue_similarity_of(0, checks({90, 60, 200}, {120, 220, 230}, 0.03));
  EXPECT_GT(same, 0.98);
  EXPECT_LT(other, 0.8);
  EXPECT_EQ(hue_similarity_of(1, plain({90, 150, 90})), 1) << "untextured";
}

TEST(VerifyTexture, GreyViewsAreComparedByLightnessAlone) {
  Solid box{Shape::kBox, {0.1, 0.1, 0.1}, checks({220, 60, 40}, {240, 220, 60}, 0.03), on_table(0, 0, 0.05)};
  ModelLibrary library;
  library.objects = {make_model("red and yellow", box)};
  Fixture f({.solids = {box}}, circle_of_cameras(4));
  box.paint = plain({220, 60, 40});
  library.objects.push_back(make_model("red", box));
  const std::vector<Hypothesis> either = {make_hypothesis(0, box.world_from_object),
                                          make_hypothesis(1, box.world_from_object)};
  const VerifyOptions options{.acceptance = {.min_pattern_similarity = 0.5}};
  HypothesisVerifier verifier(library, options);
  const auto accepted_of_views = [&] { return accepted(verifier.verify(either, f.scene, references(f.views), {})); };
  EXPECT_THAT(accepted_of_views(), testing::ElementsAre(0));
  f.turn_grey();
  EXPECT_THAT(accepted_of_views(), testing::ElementsAre(0));
  for (PreparedView& view : f.views) view.is_grey = false;  // A camera with colours sees a grey box.
  EXPECT_THAT(accepted_of_views(), testing::IsEmpty());
}

// Boxes side by side, whose faces are one plane.
class RowTest : public testing::Test {
 protected:
  RowTest() {
    for (const double x : {-0.142, 0.0, 0.142}) {
      row_.solids.push_back(placed(box_, on_table(x, 0, 0.09)));
      hypotheses_.push_back(make_hypothesis(0, row_.solids.back().world_from_object));
    }
  }

  VerifyResult verify(const Solid& model, std::optional<double> texture_contrast) const {
    const Fixture f(row_, {look_at({0, -0.7, 0.2}, {0, 0, 0.09})});
    return f.verify(hypotheses_, {.objects = {make_model("box", model)}},
                    {.clutter = {.weight = 6, .rule = ContinuationClutter{.texture_contrast = texture_contrast}},
                     .acceptance = {.min_explained_share = 0.3, .require_unary_gain = true}});
  }

  Solid box_{Shape::kBox, {0.14, 0.08, 0.18}, checks({200, 60, 50}, {60, 70, 200}, 0.03), {}};
  World row_;
  std::vector<Hypothesis> hypotheses_;
};

TEST_F(RowTest, SharedTextureTellsFacesFromALargerPlane) {
  EXPECT_THAT(accepted(verify(box_, std::nullopt)), testing::IsEmpty()) << "The faces must be one plane.";
  const VerifyResult result = verify(box_, 2);
  EXPECT_THAT(accepted(result), testing::ElementsAre(0, 1, 2));
  EXPECT_LT(result.evidence[1].costs.plane, 0.1 * result.evidence[1].costs.explained_scene);
}

TEST_F(RowTest, ALargerPlaneOfOtherTextureIsBackground) {
  Solid other = box_;
  other.paint = checks({200, 60, 50}, {60, 70, 200}, 0.047);
  const VerifyResult result = verify(other, 2);
  EXPECT_THAT(accepted(result), testing::IsEmpty());
  EXPECT_GT(result.evidence[1].costs.plane, result.evidence[1].costs.explained_scene);
}

// A low box, taken for a higher one of the same colour. There is depth on the box only, so that only colours tell what
// is beyond its contour.
class SilhouetteTest : public testing::Test {
 protected:
  double silhouette_error(Rgb8 table_color, const std::vector<Solid>& others = {}) const {
    World world{.solids = {low_}, .table_color = table_color};
    for (const Solid& other : others) world.solids.push_back(other);
    Fixture f(world, {look_at({0.8, 0, 0.5}, {0, 0, 0.03})});
    for (PreparedView& view : f.views)
      for (std::size_t i = 0; i < view.cloud.z.size(); ++i)
        if (view.frame.color[i] == table_color)
          view.frame.depth_m[i] = view.cloud.z[i] = std::numeric_limits<float>::quiet_NaN();
    const std::vector<Hypothesis> high = {make_hypothesis(0, on_table(0, 0, high_.size_m.z() / 2))};
    const HypothesisEvidence evidence =
        f.verify(high, {.objects = {make_model("high", high_)}},
                 {.acceptance = {.min_explained_share = 0, .min_newest_similarity = -1}})
            .evidence[0];
    EXPECT_GT(evidence.num_explained, 50);
    return evidence.appearance.silhouette_error;
  }

  const Rgb8 red_{170, 50, 50};
  Solid low_{Shape::kBox, {0.1, 0.14, 0.1}, plain(red_), on_table(0, 0, 0.05)};
  Solid high_{Shape::kBox, {0.1, 0.14, 0.14}, plain(red_), {}};
};

TEST_F(SilhouetteTest, ColoursTellWhereThereIsNoDepth) { EXPECT_GT(silhouette_error({60, 90, 170}), 0.1); }

TEST_F(SilhouetteTest, OfItsOwnColourItMayReachOver) { EXPECT_EQ(silhouette_error({170, 50, 51}), 0); }

TEST_F(SilhouetteTest, SaturatedColoursTellNothing) { EXPECT_EQ(silhouette_error({255, 255, 255}), 0); }

TEST_F(SilhouetteTest, WhatMayBeHiddenTellsNothing) {
  // A bar before the upper border of the box.
  const Solid bar{Shape::kBox, {0.02, 0.4, 0.05}, plain({90, 90, 90}), on_table(0.25, 0, 0.23)};
  EXPECT_LT(silhouette_error({60, 90, 170}, {bar}), 0.5 * silhouette_error({60, 90, 170}));
}

}  // namespace
}  // namespace resight
