// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "resight/core/random.hpp"
#include "resight/verification/hypothesis_verifier.hpp"
#include "resight/verification/testing/verify_fixture.hpp"

namespace resight {
namespace {

const ClutterOptions kNoClutter{.weight = 0, .rule = SegmentClutter{.near_weight = 0}};

using namespace analytic;

TEST(VerifyHypotheses, AcceptsTheRightOneOfMany) {
  const Fixture f(one_box(), circle_of_cameras(3, 0.8, 0.6, 2.0));
  const Rigid3 truth = on_table(0, 0, 0.07, 0.4);
  std::vector<Hypothesis> hypotheses;
  Rng rng(3);
  for (int i = 0; i < 8; ++i) {
    const double shift_y_m = rng.uniform(-0.06, 0.06);
    const Eigen::Vector3d shift(rng.uniform(0.02, 0.06), shift_y_m, 0);
    hypotheses.push_back(make_hypothesis(kBox, disturb(truth, shift, kZ, rng.uniform(0.3, 2.0))));
  }
  hypotheses.push_back(make_hypothesis(kCylinder, on_table(0, 0, 0.06)));
  hypotheses.push_back(make_hypothesis(kSphere, on_table(0.02, 0, 0.045)));
  hypotheses.insert(hypotheses.begin() + 4,
                    make_hypothesis(kBox, disturb(truth, {0.002, -0.001, 0.001}, Eigen::Vector3d(1, 2, 3), 0.03)));
  const VerifyResult result = f.verify(hypotheses, make_library());
  EXPECT_THAT(accepted(result), testing::ElementsAre(4));
  EXPECT_GT(result.evidence[4].fit, 0.85);
  EXPECT_LT(result.cost, 0);
  for (std::size_t i = 0; i < hypotheses.size(); ++i) {
    EXPECT_EQ(result.evidence[i].accepted, result.evidence[i].verdict == Verdict::kAccepted) << i;
    EXPECT_GE(result.evidence[i].fit, 0);
    EXPECT_LE(result.evidence[i].fit, 1);
    if (result.evidence[i].verdict == Verdict::kSuppressed) {
      EXPECT_EQ(result.evidence[i].suppressed_by, 4);
    }
  }
}

TEST(VerifyHypotheses, RejectsAnAbsentObject) {
  const Fixture f(one_box(), circle_of_cameras(4));
  const VerifyResult result = f.verify(
      {make_hypothesis(kCylinder, on_table(0.25, 0.1, 0.06)), make_hypothesis(kSphere, on_table(-0.2, 0, 0.3))},
      make_library());
  EXPECT_THAT(accepted(result), testing::IsEmpty());
  EXPECT_EQ(result.cost, 0);
  for (const HypothesisEvidence& e : result.evidence) {
    EXPECT_EQ(e.verdict, Verdict::kNoSupport);
    EXPECT_GT(e.num_visible, 100);
    EXPECT_LT(e.explained_share, 0.2);
  }
}

TEST(VerifyHypotheses, AcceptsTwoInstancesSideBySide) {
  // A gap of 5 mm: each one's explained points reach over to the other.
  const Rigid3 left = on_table(0, -0.0375, 0.07);
  const Rigid3 right = on_table(0, 0.0375, 0.07);
  const Fixture f({.solids = {placed(make_box(), left), placed(make_box(), right)}}, circle_of_cameras(4));
  const VerifyResult result =
      f.verify({make_hypothesis(kBox, left), make_hypothesis(kBox, on_table(0, 0, 0.07)), make_hypothesis(kBox, right)},
               make_library());
  EXPECT_THAT(accepted(result), testing::ElementsAre(0, 2));
}

TEST(VerifyHypotheses, AcceptsTouchingAndStackedObjects) {
  const Rigid3 box = on_table(0, 0, 0.07);
  const Rigid3 on_top = on_table(0, 0, 0.20);              // Stands on the box.
  const Rigid3 beside = on_table(0.05 + 0.045, 0, 0.045);  // Touches its side.
  const Fixture f({.solids = {placed(make_box(), box), placed(make_cylinder(), on_top), placed(make_sphere(), beside)}},
                  circle_of_cameras(5));
  const VerifyResult result =
      f.verify({make_hypothesis(kBox, box), make_hypothesis(kCylinder, on_top), make_hypothesis(kSphere, beside)},
               make_library());
  EXPECT_THAT(accepted(result), testing::ElementsAre(0, 1, 2));
}

TEST(VerifyHypotheses, KeepsOneOfTwoDuplicates) {
  const Fixture f(one_box(), circle_of_cameras(4));
  const Rigid3 truth = on_table(0, 0, 0.07, 0.4);
  for (const DuplicityRule rule : {DuplicityRule::kBeyondBest, DuplicityRule::kAllWeights}) {
    const VerifyResult result =
        f.verify({make_hypothesis(kBox, disturb(truth, {0.002, 0, 0}, kZ, 0)), make_hypothesis(kBox, truth),
                  make_hypothesis(kBox, disturb(truth, {0, 0.002, 0}, kZ, 0.02))},
                 make_library(), {.selection = {.duplicity_rule = rule}});
    ASSERT_EQ(accepted(result).size(), 1U);
    const int winner = accepted(result)[0];
    for (int i = 0; i < 3; ++i) {
      if (i == winner) continue;
      EXPECT_EQ(result.evidence[i].verdict, Verdict::kSuppressed);
      EXPECT_EQ(result.evidence[i].suppressed_by, winner);
      EXPECT_LT(result.evidence[i].costs.unary, 0);
    }
  }
}

TEST(VerifyHypotheses, DistinguishesTwinsByColor) {
  ModelLibrary library = make_library();
  Solid wrong = make_box();
  wrong.paint = checks({40, 160, 60}, {60, 60, 180}, 0.03);
  library.objects.push_back(make_model("green box", wrong));
  for (const double brightness : {1.0, 0.7}) {
    World world = one_box();
    world.brightness = brightness;
    const Fixture f(world, circle_of_cameras(4));
    const Rigid3 truth = on_table(0, 0, 0.07, 0.4);
    const std::vector<Hypothesis> both = {make_hypothesis(3, truth), make_hypothesis(kBox, truth)};
    const VerifyResult result = f.verify(both, library);
    EXPECT_THAT(accepted(result), testing::ElementsAre(1)) << "brightness " << brightness;
    EXPECT_GT(result.evidence[1].fit, result.evidence[0].fit + 0.2);
    // Even without a competitor; accepted without colours.
    EXPECT_THAT(accepted(f.verify({both[0]}, library)), testing::IsEmpty());
    EXPECT_THAT(accepted(f.verify({both[0]}, library, {.appearance = {.use_color = false}})), testing::ElementsAre(0));
  }
}

TEST(VerifyHypotheses, AcceptsAHalfOccludedObject) {
  // One camera from the front, low; a wide board in front hides the lower half of the box.
  const Rigid3 truth = on_table(0, 0, 0.07);
  const Rigid3 camera = look_at({0, -0.9, 0.12}, {0, 0, 0.07});
  const Solid board{Shape::kBox, {0.4, 0.02, 0.075}, plain({90, 90, 90}), on_table(0, -0.12, 0.0375)};
  World world{.solids = {placed(make_box(), truth)}};
  const Fixture open(world, {camera});
  world.solids.push_back(board);
  const Fixture hidden(world, {camera});
  const std::vector<Hypothesis> hypotheses = {make_hypothesis(kBox, truth)};
  const VerifyResult before = open.verify(hypotheses, make_library());
  const VerifyResult after = hidden.verify(hypotheses, make_library());
  EXPECT_THAT(accepted(before), testing::ElementsAre(0));
  EXPECT_THAT(accepted(after), testing::ElementsAre(0));
  // Front face 10 x 14 cm of a surface of 616 cm^2 = 0.227; the top face is seen at a cosine of about 0.13 or less.
  EXPECT_NEAR(before.evidence[0].visible_share, 0.227, 0.03);
  // The ray over the board's rear edge (0, -0.11, 0.075) meets the front face y = -0.035 at z = 0.071 (less 2 cm margin
  // behind the board: none).
  EXPECT_NEAR(after.evidence[0].visible_share, 0.227 * (0.14 - 0.0707) / 0.14, 0.03);
  EXPECT_GT(after.evidence[0].fit, 0.8);
}

TEST(VerifyHypotheses, ThePresenceMaskTakesTheEvidenceAway) {
  const Fixture f(one_box(), circle_of_cameras(3));
  const Rigid3 truth = on_table(0, 0, 0.07, 0.4);
  const std::vector<Hypothesis> hypotheses = {make_hypothesis(kBox, truth), make_hypothesis(kBox, truth)};
  // View-major: hypothesis 0 nowhere, hypothesis 1 in view 1 only.
  const VerifyResult result = f.verify(hypotheses, make_library(), {}, {0, 0, 0, 1, 0, 0});
  EXPECT_THAT(accepted(result), testing::ElementsAre(1));
  EXPECT_EQ(result.evidence[0].verdict, Verdict::kTooFewVisible);
  EXPECT_EQ(result.evidence[0].num_visible, 0);
  EXPECT_THAT(result.evidence[0].visible_share_per_view, testing::Each(0.0F));
  EXPECT_EQ(result.evidence[1].visible_share_per_view[0], 0);
  EXPECT_GT(result.evidence[1].visible_share_per_view[1], 0.2);
  EXPECT_GT(result.evidence[1].explained_share_per_view[1], 0.85);
  EXPECT_EQ(result.evidence[1].visible_share_per_view[2], 0);
  EXPECT_NEAR(result.evidence[1].visible_share, result.evidence[1].visible_share_per_view[1], 1e-6);
}

TEST(VerifyHypotheses, RejectsABoxInsideTheTable) {
  // Its top face lies in the table's surface and has the table's colour: all that is visible of it is explained by the
  // plane.
  ModelLibrary library = make_library();
  library.objects.push_back(make_model("slab", {Shape::kBox, {0.15, 0.12, 0.05}, plain({140, 120, 100}), {}}));
  const Fixture f(one_box(), circle_of_cameras(4));
  const std::vector<Hypothesis> hypotheses = {make_hypothesis(3, on_table(0.25, 0.1, -0.025)),
                                              make_hypothesis(3, on_table(-0.25, 0.1, -0.02))};
  const VerifyResult result = f.verify(hypotheses, library);
  EXPECT_THAT(accepted(result), testing::IsEmpty());
  EXPECT_GT(result.evidence[0].fit, 0.7);  // Its sides count as visible down to the margin.
  EXPECT_EQ(result.evidence[0].verdict, Verdict::kCost);
  EXPECT_GT(result.evidence[0].costs.plane, 100);
  // The planes are what rejects it.
  EXPECT_FALSE(accepted(f.verify(hypotheses, library, {.clutter = kNoClutter, .planes = {}})).empty());
}

TEST(VerifyHypotheses, PunishesAModelThatPiercesThePlane) {
  const Fixture f(one_box(), circle_of_cameras(4));
  const VerifyResult result =
      f.verify({make_hypothesis(kBox, on_table(0, 0, 0.07, 0.4)), make_hypothesis(kBox, on_table(0, 0, 0.03, 0.4))},
               make_library(), {.acceptance = {.min_explained_share = 0.1}});
  EXPECT_LT(result.evidence[0].costs.plane, 60);
  EXPECT_GT(result.evidence[1].costs.plane, 300);
  EXPECT_THAT(accepted(result), testing::ElementsAre(0));
}

TEST(VerifyHypotheses, FollowsAMovedObject) {
  // Views 0 and 1 saw the box at its old place and were cleared there (no depth); views 2 and 3 see it at the new one.
  const Rigid3 old_place = on_table(-0.12, 0, 0.07, 0.4);
  const Rigid3 new_place = on_table(0.15, 0.05, 0.07, 1.2);
  const std::vector<Rigid3> cameras = circle_of_cameras(4, 0.8, 0.6, 1.5);
  const World before{.solids = {placed(make_box(), old_place)}};
  const World after{.solids = {placed(make_box(), new_place)}};
  std::vector<PreparedView> views = {render(before, cameras[0]), render(before, cameras[1]), render(after, cameras[2]),
                                     render(after, cameras[3])};
  for (int v = 0; v < 2; ++v)
    for (std::size_t i = 0; i < views[v].cloud.z.size(); ++i) {
      if (!views[v].cloud.has_point(i)) continue;
      const Eigen::Vector3d p = views[v].frame.world_from_camera * views[v].cloud.point(i).cast<double>();
      if ((p - old_place.translation).norm() > 0.11) continue;
      for (Image<float>* image : {&views[v].cloud.x, &views[v].cloud.y, &views[v].cloud.z, &views[v].cloud.nx,
                                  &views[v].cloud.ny, &views[v].cloud.nz, &views[v].frame.depth_m})
        (*image)[i] = std::numeric_limits<float>::quiet_NaN();
    }
  const std::vector<VerificationView> refs = references(views);
  const std::vector<Hypothesis> hypotheses = {make_hypothesis(kBox, old_place), make_hypothesis(kBox, new_place)};
  const std::vector<std::uint8_t> new_only_later = {1, 0, 1, 0, 1, 1, 1, 1};
  const VerifyResult result = verify_hypotheses(hypotheses, make_library(), merge(views), refs, new_only_later);
  EXPECT_THAT(accepted(result), testing::ElementsAre(1));
  EXPECT_EQ(result.evidence[0].verdict, Verdict::kNoSupport);
  EXPECT_LT(result.evidence[0].explained_share_per_view[3], 0.3);
}

TEST(VerifyHypotheses, NewerViewsThatSeeThroughOutweighStalePoints) {
  // The scene still holds the box's points (the change was missed), but two of three views see through it.
  const Rigid3 truth = on_table(0, 0, 0.07, 0.4);
  const std::vector<Rigid3> cameras = circle_of_cameras(3, 0.8, 0.6, 0.3);
  const std::vector<PreparedView> views = {render(one_box(), cameras[0]), render({}, cameras[1]),
                                           render({}, cameras[2])};
  const std::vector<VerificationView> refs = references(views);
  const std::vector<Hypothesis> hypotheses = {make_hypothesis(kBox, truth)};
  EXPECT_THAT(accepted(verify_hypotheses(hypotheses, make_library(), merge(views), refs, {})), testing::IsEmpty());
  EXPECT_THAT(accepted(verify_hypotheses(hypotheses, make_library(), merge(views), refs, {},
                                         {.visibility = {.free_space = MajorityFreeSpace{.max_share = 1}}})),
              testing::ElementsAre(0));
}

TEST(VerifyHypotheses, TheNewestViewDecidesWhatHasComeOrGone) {
  const Rigid3 truth = on_table(0, 0, 0.07, 0.4);
  const std::vector<Rigid3> cameras = circle_of_cameras(3, 0.8, 0.6, 0.3);
  const std::vector<Hypothesis> hypotheses = {make_hypothesis(kBox, truth)};
  const VerifyOptions newest{.visibility = {.free_space = NewestViewFreeSpace{}}};
  const auto accepts = [&](const std::vector<PreparedView>& views, const VerifyOptions& options) {
    return !accepted(verify_hypotheses(hypotheses, make_library(), merge(views), references(views), {}, options))
                .empty();
  };
  // Two older views see through the place of an object that has just come.
  const std::vector<PreparedView> came = {render({}, cameras[0]), render({}, cameras[1]),
                                          render(one_box(), cameras[2])};
  EXPECT_TRUE(accepts(came, newest));
  EXPECT_FALSE(accepts(came, {}));
  // Two older views still show what the newest sees through.
  const std::vector<PreparedView> gone = {render(one_box(), cameras[0]), render(one_box(), cameras[1]),
                                          render({}, cameras[2])};
  EXPECT_FALSE(accepts(gone, newest));
  EXPECT_TRUE(accepts(gone, {}));
}

TEST(VerifyHypotheses, TellsTheShareThatIsSeenThroughAndTheScore) {
  const std::vector<Rigid3> cameras = circle_of_cameras(3, 0.8, 0.6, 0.3);
  const VerifyOptions options{.visibility = {.free_space = NewestViewFreeSpace{}},
                              .score = {.offset = -1, .fit_weight = 3, .seen_through_weight = 2}};
  const auto evidence = [&](const World& newest) {
    const std::vector<PreparedView> views = {render(one_box(), cameras[0]), render(one_box(), cameras[1]),
                                             render(newest, cameras[2])};
    return verify_hypotheses({{make_hypothesis(kBox, on_table(0, 0, 0.07, 0.4))}}, make_library(), merge(views),
                             references(views), {}, options)
        .evidence[0];
  };
  const HypothesisEvidence there = evidence(one_box());
  EXPECT_LT(there.seen_through_share, 0.05);
  EXPECT_EQ(there.score, hypothesis_score(there, options.score));
  EXPECT_GT(there.score, 0.5);
  const HypothesisEvidence gone = evidence({});
  EXPECT_GT(gone.seen_through_share, 0.5);
  EXPECT_EQ(gone.score, 0) << "rejected before";
}

TEST(VerifyHypotheses, NoiseOfAFarSurfaceIsNoRestOfIt) {
  // The box is measured at its place and up to 14 mm too near.
  const auto clutter = [](double distance_m, double noise_sigmas) {
    const Rigid3 camera = look_at({distance_m, 0, 0.1}, {0, 0, 0.05});
    const Rigid3 pose = on_table(0, 0, 0.07);
    const Fixture f({.solids = {placed(make_box(), pose)}, .has_table = false}, {camera});
    const Eigen::Vector3f towards = (camera.translation - pose.translation).normalized().cast<float>();
    PointCloud scene = f.scene;
    for (std::size_t i = 0; i < f.scene.size(); ++i) scene.points[i] += 0.0035F * static_cast<float>(i % 5) * towards;
    const ContinuationClutter rule{.noise_sigmas = noise_sigmas};
    const VerifyOptions options{.support = {.max_distance_m = 0.01},
                                .refine = {.max_iterations = std::nullopt},
                                .clutter = {.weight = 6, .rule = rule},
                                .planes = {}};
    const std::vector<VerificationView> refs = references(f.views);
    const std::vector<Hypothesis> hypotheses = {make_hypothesis(kBox, pose)};
    return verify_hypotheses(hypotheses, make_library(), scene, refs, {}, options).evidence[0].costs.clutter;
  };
  EXPECT_GT(clutter(2.2, 0), 100);
  EXPECT_LT(clutter(2.2, 3), 0.2 * clutter(2.2, 0));
  EXPECT_GT(clutter(0.8, 0), 100);
  EXPECT_EQ(clutter(0.8, 3), clutter(0.8, 0));  // 14 mm are more than noise there.
}

TEST(VerifyHypotheses, WhatContinuesASurfaceIsChargedForAndANeighborIsNot) {
  ModelLibrary library = make_library();
  const Solid small{Shape::kBox, {0.1, 0.1, 0.08}, plain({180, 170, 60}), on_table(0, 0, 0.04)};
  library.objects.push_back(make_model("small", small));
  VerifyOptions options{
      .clutter = {.weight = 6, .rule = ContinuationClutter{}}, .planes = {}, .acceptance = {.min_explained_share = 0}};
  const auto clutter = [&](const World& world, const Rigid3& pose) {
    const Fixture f(world, circle_of_cameras(4));
    const std::vector<Hypothesis> hypotheses = {make_hypothesis(3, pose)};
    const HypothesisEvidence e = f.verify(hypotheses, library, options).evidence[0];
    EXPECT_GT(e.costs.explained_scene, 100);
    EXPECT_GT(e.explained_share, 0.7);
    return e.costs.clutter / e.costs.explained_scene;
  };
  // Alone, and beside a lower box, whose sides do not continue its own, and one of another colour. Both touch it.
  EXPECT_LT(clutter({.solids = {small}}, small.world_from_object), 0.2);
  const Solid lower{Shape::kBox, {0.1, 0.06, 0.05}, plain({180, 170, 60}), on_table(0.1, 0, 0.025)};
  const Solid other{Shape::kBox, {0.1, 0.1, 0.08}, plain({60, 80, 190}), on_table(-0.1, 0, 0.04)};
  EXPECT_LT(clutter({.solids = {small, lower, other}}, small.world_from_object), 0.35);
  // Within a board of the same height and colour.
  const Solid board{Shape::kBox, {0.3, 0.3, 0.08}, plain({180, 170, 60}), on_table(0, 0, 0.04)};
  EXPECT_GT(clutter({.solids = {board}}, small.world_from_object), 1.0);
}

TEST(VerifyHypotheses, ASimilarTextureRulesOutAPartOfSomethingLarger) {
  const auto evidence = [](const Paint& paint, std::optional<double> contrast) {
    const Solid small{Shape::kBox, {0.1, 0.1, 0.08}, paint, on_table(0, 0, 0.04)};
    const Solid board{Shape::kBox, {0.3, 0.3, 0.08}, paint, on_table(0, 0, 0.04)};
    const ModelLibrary library{.objects = {make_model("small", small)}};
    const Fixture f({.solids = {board}}, circle_of_cameras(4));
    const ContinuationClutter rule{.texture_contrast = contrast};
    const VerifyOptions options{
        .refine = {.max_iterations = std::nullopt}, .clutter = {.weight = 6, .rule = rule}, .planes = {}};
    return f.verify({make_hypothesis(0, small.world_from_object)}, library, options).evidence[0];
  };
  const Paint yellow = plain({180, 170, 60});
  const double full = evidence(yellow, std::nullopt).costs.clutter;
  EXPECT_GT(full, 100);
  EXPECT_LT(evidence(yellow, 0.5).appearance.shared_texture, 0.01);
  EXPECT_NEAR(evidence(yellow, 0.5).costs.clutter, full, 1e-3 * full);
  const Paint printed = checks({180, 170, 60}, {120, 110, 40}, 0.05);
  const double full_of_printed = evidence(printed, std::nullopt).costs.clutter;
  EXPECT_GT(full_of_printed, 100);
  const HypothesisEvidence e = evidence(printed, 0.5);
  EXPECT_GT(e.appearance.shared_texture, 0.5);
  EXPECT_NEAR(e.costs.clutter, full_of_printed / (1 + std::pow(e.appearance.shared_texture / 0.5, 2)),
              1e-2 * full_of_printed);
}

TEST(VerifyHypotheses, ChargesForTheUnexplainedRestOfASegment) {
  // A small box claims a part of a large box's side and top.
  ModelLibrary library = make_library();
  const Solid large{Shape::kBox, {0.3, 0.2, 0.2}, plain({180, 170, 60}), on_table(0, 0, 0.1)};
  library.objects.push_back(make_model("crate", large));
  library.objects.push_back(make_model("small", {Shape::kBox, {0.06, 0.06, 0.06}, plain({180, 170, 60}), {}}));
  const Fixture f({.solids = {large}}, circle_of_cameras(4));
  const Rigid3 corner = Rigid3::from_translation({0.12, 0.07, 0.17});
  const std::vector<Hypothesis> both = {make_hypothesis(3, large.world_from_object), make_hypothesis(4, corner)};
  // The crate's faces are planes, larger than the small box.
  const VerifyResult with_planes = f.verify(both, library);
  EXPECT_THAT(accepted(with_planes), testing::ElementsAre(0));
  EXPECT_GT(with_planes.evidence[1].costs.plane, 50);
  const VerifyResult segments_only = f.verify(both, library, {.planes = {}});
  EXPECT_THAT(accepted(segments_only), testing::ElementsAre(0));
  EXPECT_GT(segments_only.evidence[1].costs.clutter, 200);
  EXPECT_LT(segments_only.evidence[0].costs.clutter, 50);
  // Also without the rival, and it is the clutter cue that does it.
  const std::vector<Hypothesis> small = {both[1]};
  EXPECT_THAT(accepted(f.verify(small, library, {.planes = {}})), testing::IsEmpty());
  EXPECT_THAT(accepted(f.verify(small, library, {.clutter = kNoClutter, .planes = {}})), testing::ElementsAre(0));
}

}  // namespace
}  // namespace resight
