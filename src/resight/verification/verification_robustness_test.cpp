// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <cstring>
#include <limits>

#include "resight/core/random.hpp"
#include "resight/verification/hypothesis_verifier.hpp"
#include "resight/verification/testing/verify_fixture.hpp"

namespace resight {
namespace {

using namespace analytic;

TEST(VerifyHypotheses, WorksWithoutNormalsOrColors) {
  const Fixture f(one_box(), circle_of_cameras(4));
  ModelLibrary library = make_library();
  const std::vector<Hypothesis> hypotheses = {make_hypothesis(kBox, on_table(0, 0, 0.07, 0.4)),
                                              make_hypothesis(kBox, on_table(0.3, 0, 0.07))};
  Fixture bare = f;
  bare.scene.colors.clear();
  EXPECT_THAT(accepted(bare.verify(hypotheses, library)), testing::ElementsAre(0));
  bare.scene.normals.clear();
  EXPECT_THAT(accepted(bare.verify(hypotheses, library)), testing::ElementsAre(0));
  for (ObjectModel& object : library.objects) object.surface.normals.clear();
  EXPECT_THAT(accepted(bare.verify(hypotheses, library)), testing::ElementsAre(0));
}

TEST(VerifyHypotheses, CopesWithNothing) {
  const Fixture f(one_box(), circle_of_cameras(2));
  const ModelLibrary library = make_library();
  const std::vector<Hypothesis> hypotheses = {make_hypothesis(kBox, on_table(0, 0, 0.07, 0.4))};
  const std::vector<VerificationView> refs = references(f.views);
  EXPECT_TRUE(f.verify({}, library).evidence.empty());
  const VerifyResult no_scene = verify_hypotheses(hypotheses, library, {}, refs, {});
  EXPECT_EQ(no_scene.evidence[0].verdict, Verdict::kNoSupport);
  EXPECT_EQ(no_scene.evidence[0].fit, 0);
  const VerifyResult no_views = verify_hypotheses(hypotheses, library, f.scene, {}, {});
  EXPECT_EQ(no_views.evidence[0].verdict, Verdict::kTooFewVisible);
  ModelLibrary hollow;
  hollow.objects.resize(1);
  EXPECT_EQ(f.verify(hypotheses, hollow).evidence[0].verdict, Verdict::kTooFewVisible);
  // Outside of all images, and behind the cameras.
  const VerifyResult outside =
      f.verify({make_hypothesis(kBox, on_table(30, 0, 0)), make_hypothesis(kBox, on_table(0, 0, 5))}, library);
  for (const HypothesisEvidence& e : outside.evidence) EXPECT_EQ(e.verdict, Verdict::kTooFewVisible);
}

TEST(VerifyHypotheses, IgnoresNonFinitePoints) {
  const Fixture f(one_box(), circle_of_cameras(2));
  const std::vector<Hypothesis> hypotheses = {make_hypothesis(kBox, on_table(0, 0, 0.07, 0.4))};
  Fixture spoilt = f;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (const Eigen::Vector3f& p :
       {Eigen::Vector3f(nan, 0, 0), Eigen::Vector3f(0, std::numeric_limits<float>::infinity(), 0)}) {
    spoilt.scene.points.push_back(p);
    spoilt.scene.normals.push_back({nan, nan, nan});
    spoilt.scene.colors.push_back({});
  }
  const VerifyResult clean = f.verify(hypotheses, make_library());
  const VerifyResult result = spoilt.verify(hypotheses, make_library());
  EXPECT_THAT(accepted(result), testing::ElementsAre(0));
  EXPECT_EQ(result.cost, clean.cost);
}

TEST(VerifyHypotheses, GivesTheSameBytesForAnyNumberOfThreads) {
  const Fixture f(
      {.solids = {placed(make_box(), on_table(0, 0, 0.07)), placed(make_cylinder(), on_table(0.2, 0.1, 0.06))}},
      circle_of_cameras(4));
  std::vector<Hypothesis> hypotheses;
  Rng rng(11);
  for (int i = 0; i < 16; ++i) {
    const Eigen::Vector3d shift{rng.uniform(-0.02, 0.02), rng.uniform(-0.02, 0.02), 0};
    const double yaw_rad = rng.uniform(-0.3, 0.3);
    const Rigid3 pose = on_table(i % 2 == 0 ? 0 : 0.2, i % 2 == 0 ? 0 : 0.1, 0.065);
    hypotheses.push_back(make_hypothesis(i % 3, disturb(pose, shift, kZ, yaw_rad)));
  }
  const VerifyResult serial =
      f.verify(hypotheses, make_library(),
               {.selection = {.max_exact_hypotheses = 2}, .acceptance = {.min_explained_share = 0.35}});
  ASSERT_GT(accepted(serial).size(), 0U);
  for (const int threads : {2, 5}) {
    const VerifyResult parallel = f.verify(hypotheses, make_library(),
                                           {.selection = {.max_exact_hypotheses = 2},
                                            .acceptance = {.min_explained_share = 0.35},
                                            .num_threads = threads});
    EXPECT_EQ(parallel.cost, serial.cost);
    for (std::size_t i = 0; i < hypotheses.size(); ++i) {
      const HypothesisEvidence& a = serial.evidence[i];
      const HypothesisEvidence& b = parallel.evidence[i];
      EXPECT_EQ(a.verdict, b.verdict);
      EXPECT_EQ(a.suppressed_by, b.suppressed_by);
      for (const auto field : {&HypothesisEvidence::fit, &HypothesisEvidence::visible_share})
        EXPECT_EQ(std::memcmp(&(a.*field), &(b.*field), sizeof(double)), 0);
      for (const auto field : {&HypothesisCosts::explained_scene, &HypothesisCosts::outlier, &HypothesisCosts::clutter,
                               &HypothesisCosts::plane, &HypothesisCosts::unary})
        EXPECT_EQ(std::memcmp(&(a.costs.*field), &(b.costs.*field), sizeof(double)), 0);
      EXPECT_EQ(a.explained_share_per_view, b.explained_share_per_view);
    }
  }
}

TEST(VerifyHypotheses, RefusesTheCallersMistakes) {
  const Fixture f(one_box(), circle_of_cameras(2));
  const ModelLibrary library = make_library();
  const std::vector<Hypothesis> good = {make_hypothesis(kBox, on_table(0, 0, 0.07))};
  EXPECT_THROW(f.verify({make_hypothesis(3, {})}, library), std::invalid_argument);
  EXPECT_THROW(f.verify({make_hypothesis(-1, {})}, library), std::invalid_argument);
  EXPECT_THROW(f.verify(good, library, {}, {1}), std::invalid_argument);
  EXPECT_THROW(f.verify(good, library, {.resolution_m = 0}), std::invalid_argument);
  EXPECT_THROW(f.verify(good, library, {.acceptance = {.min_visible_share = 2}}), std::invalid_argument);
  EXPECT_THROW(f.verify(good, library, {.appearance = {.sigma_l = std::numeric_limits<double>::quiet_NaN()}}),
               std::invalid_argument);
  // Grids of such cells or reaches would not fit into the memory, and such a deviation made scores NaN.
  EXPECT_THROW(f.verify(good, library, {.resolution_m = 1e-300}), std::invalid_argument);
  EXPECT_THROW(f.verify(good, library, {.support = {.max_distance_m = 100}}), std::invalid_argument);
  EXPECT_THROW(f.verify(good, library, {.clutter = {.radius_m = 1e300}}), std::invalid_argument);
  EXPECT_THROW(f.verify(good, library, {.appearance = {.sigma_ab = 1e300}}), std::invalid_argument);
  EXPECT_THROW(f.verify(good, library, {.appearance = {.sigma_l = 1e300}}), std::invalid_argument);
  EXPECT_THROW(f.verify(good, library, {.refine = {.max_distance_m = 1e300}}), std::invalid_argument);
  EXPECT_THROW(f.verify(good, library, {.num_threads = 0}), std::invalid_argument);
  Hypothesis broken = good[0];
  broken.world_from_object.translation.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(f.verify({broken}, library), std::invalid_argument);
  const std::vector<VerificationView> null_view(1);
  EXPECT_THROW((void)verify_hypotheses(good, library, f.scene, null_view, {}), std::invalid_argument);
}

}  // namespace
}  // namespace resight
