// SPDX-License-Identifier: Apache-2.0
#include "resight/verification/acceptance.hpp"

#include <optional>

#include "resight/appearance/appearance_match.hpp"
#include "resight/verification/failed_test.hpp"
#include "resight/verification/selection_cost.hpp"

namespace resight {
namespace {

/// The tests of one hypothesis, in their order; remembers the first that fails.
class Tests {
 public:
  void at_least(Verdict verdict, const char* quantity, double value, double limit) {
    if (!failed_ && value < limit)
      failed_ = FailedTest{.verdict = verdict, .quantity = quantity, .value = value, .limit = limit};
  }
  [[nodiscard]] const std::optional<FailedTest>& failed() const { return failed_; }

 private:
  std::optional<FailedTest> failed_;
};

int min_visible_points(const HypothesisEvidence& evidence) {
  return evidence.visible_share < kMinVisibleShareOfSmall ? kMinVisiblePoints : kMinVisiblePointsOfSmall;
}

Tests test_support(const HypothesisEvidence& evidence, const AcceptanceOptions& options) {
  Tests tests;
  tests.at_least(Verdict::kTooFewVisible, "visible points", evidence.num_visible, min_visible_points(evidence));
  tests.at_least(Verdict::kTooFewVisible, "visible share", evidence.visible_share, options.min_visible_share);
  tests.at_least(Verdict::kNoSupport, "explained points", evidence.num_explained, 1);
  tests.at_least(Verdict::kNoSupport, "explained share", evidence.explained_share, options.min_explained_share);
  return tests;
}

std::optional<FailedTest> test_evidence(const HypothesisEvidence& evidence, const AcceptanceOptions& options) {
  const AppearanceEvidence& appearance = evidence.appearance;
  Tests tests = test_support(evidence, options);
  if (appearance.texture_contrast >= kMinTextureContrast)
    tests.at_least(Verdict::kDifferentAppearance, "shared texture", appearance.shared_texture,
                   options.min_shared_texture * appearance.texture_contrast);
  if (options.min_pattern_similarity)
    tests.at_least(Verdict::kDifferentAppearance, "pattern similarity", appearance.pattern_similarity,
                   *options.min_pattern_similarity);
  if (options.min_newest_similarity)
    tests.at_least(Verdict::kDifferentAppearance, "newest similarity", appearance.newest_similarity,
                   *options.min_newest_similarity);
  return tests.failed();
}

}  // namespace

bool has_support(const HypothesisEvidence& evidence, const AcceptanceOptions& options) {
  return !test_support(evidence, options).failed();
}

Verdict assess_evidence(const HypothesisEvidence& evidence, const AcceptanceOptions& options) {
  const auto failed = test_evidence(evidence, options);
  return failed ? failed->verdict : Verdict::kCost;
}

bool may_be_selected(const HypothesisEvidence& evidence, const AcceptanceOptions& options) {
  return evidence.verdict == Verdict::kCost && (!options.require_unary_gain || unary_cost(evidence) < 0);
}

std::optional<FailedTest> find_failed_test(const HypothesisEvidence& evidence, const AcceptanceOptions& options) {
  if (auto failed = test_evidence(evidence, options)) return failed;
  const double gain = -unary_cost(evidence);
  if (gain <= 0) return FailedTest{.verdict = Verdict::kCost, .quantity = "gain", .value = gain, .limit = 0};
  if (evidence.costs.unary <= 0) return std::nullopt;
  return FailedTest{
      .verdict = Verdict::kCost, .quantity = "gain weighted by score", .value = -evidence.costs.unary, .limit = 0};
}

}  // namespace resight
