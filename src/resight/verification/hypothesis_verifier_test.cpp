// SPDX-License-Identifier: Apache-2.0
#include "resight/verification/hypothesis_verifier.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

#include "resight/verification/testing/verify_fixture.hpp"

namespace resight {
namespace {

using namespace analytic;

TEST(HypothesisVerifier, EachCallIsLikeTheFirst) {
  const Fixture f(one_box(), circle_of_cameras(3, 0.8, 0.6, 2.0));
  const std::vector<VerificationView> views = references(f.views);
  const ModelLibrary library = make_library();
  const Hypothesis box = make_hypothesis(kBox, on_table(0, 0, 0.07, 0.4));
  const Hypothesis can = make_hypothesis(kCylinder, on_table(0, 0, 0.06));
  const Hypothesis ball = make_hypothesis(kSphere, on_table(0.02, 0, 0.045));
  VerifyOptions options;
  options.refine.symmetry_step_rad = 0.2;
  HypothesisVerifier verifier(library, options);
  for (const std::vector<Hypothesis>& hypotheses :
       {std::vector{can}, {}, std::vector{box, can}, std::vector{ball, box}, std::vector{can}}) {
    const VerifyResult found = verifier.verify(hypotheses, f.scene, views, {});
    const VerifyResult expected = verify_hypotheses(hypotheses, library, f.scene, views, {}, options);
    ASSERT_EQ(found.evidence.size(), expected.evidence.size());
    EXPECT_EQ(found.cost, expected.cost);
    for (std::size_t h = 0; h < expected.evidence.size(); ++h) {
      EXPECT_EQ(found.evidence[h].verdict, expected.evidence[h].verdict);
      EXPECT_EQ(found.evidence[h].num_visible, expected.evidence[h].num_visible);
      EXPECT_GT(found.evidence[h].num_visible, 100);
      EXPECT_EQ(found.evidence[h].fit, expected.evidence[h].fit);
    }
  }
}

TEST(HypothesisVerifier, RefusesBadOptionsAtOnce) {
  const ModelLibrary library = make_library();
  EXPECT_THROW(HypothesisVerifier(library, {.resolution_m = 0}), std::invalid_argument);
}

}  // namespace
}  // namespace resight
