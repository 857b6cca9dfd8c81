// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>

#include "resight/core/options.hpp"
#include "resight/verification/hypothesis_evidence.hpp"

namespace resight {

/// Least number of visible model points of a hypothesis: fewer are no evidence.
inline constexpr int kMinVisiblePoints = 20;
/// Objects of less than about 4 cm have few points at all (resolution_m): this share of them is as good, but no fewer
/// points than kMinVisiblePointsOfSmall.
inline constexpr double kMinVisibleShareOfSmall = 0.3;
inline constexpr int kMinVisiblePointsOfSmall = 8;

/// When the evidence for one hypothesis is enough, whatever the others are.
struct AcceptanceOptions {
  double min_visible_share = 0.1;
  double min_explained_share = 0.7;
  std::optional<double> min_pattern_similarity{};
  std::optional<double> min_newest_similarity{};
  double min_shared_texture = 0;
  bool require_unary_gain = false;
  void check() const { check_options("AcceptanceOptions", *this); }
};

inline void declare(OptionVisitor& v, AcceptanceOptions& o) {
  v.field(
      "min_visible_share", o.min_visible_share, between(0, 1),
      "A hypothesis of which a smaller share of the model is visible is rejected. Of objects of less than about 4 cm, "
      "30 % must be visible. 0: none is.",
      "later V4R");
  v.field("min_explained_share", o.min_explained_share, between(0, 1),
          "A hypothesis of which the scene explains a smaller share of the visible points is rejected. 0: none is.",
          "later V4R");
  v.field(
      "min_pattern_similarity", o.min_pattern_similarity, between(-1, 1),
      "A hypothesis whose colours correlate less with the scene's is rejected, however well they agree in the mean. "
      "off: none is.");
  v.field(
      "min_newest_similarity", o.min_newest_similarity, between(-1, 1),
      "Least similarity of the colours in the newest view that sees at least 50 points and a tenth of those that are "
      "visible; the reconstruction may still hold those of a former object. off: none is rejected by it.");
  v.field("min_shared_texture", o.min_shared_texture, between(0, 1),
          "A hypothesis of a textured model (contrast of 1 or more) that shares a smaller part of its texture with the "
          "scene is rejected. 0: none is.");
  v.field("require_unary_gain", o.require_unary_gain,
          "Hypotheses that alone cost more than they explain are rejected: two that split a larger surface would "
          "otherwise excuse each other.");
}

/// Whether enough of it is visible and explained: the tests that need no appearance, and come first.
[[nodiscard]] bool has_support(const HypothesisEvidence& evidence, const AcceptanceOptions& options);

/// Whether the evidence is enough to ask for the costs (kCost), or else why not.
[[nodiscard]] Verdict assess_evidence(const HypothesisEvidence& evidence, const AcceptanceOptions& options);

/// Whether it may enter the selection: its verdict is kCost and, if required, it explains more than it costs.
[[nodiscard]] bool may_be_selected(const HypothesisEvidence& evidence, const AcceptanceOptions& options);

}  // namespace resight
