// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>

#include "resight/core/options.hpp"
#include "resight/verification/hypothesis_evidence.hpp"

namespace resight {

/// Least number of visible model points of a hypothesis: fewer are no evidence.
inline constexpr int kMinVisiblePoints = 20;

/// What is asked of a hypothesis that shares no texture with the scene, or is compared without colours: many things
/// have its shape. For one that shares some, the limits lie between these and those for all.
struct UntexturedOptions {
  double max_shared_contrast = 1;
  double min_explained_share = 0.7;
  double min_gain = 0.2;
};

inline void declare(OptionVisitor& v, UntexturedOptions& o) {
  v.field("max_shared_contrast", o.max_shared_contrast, positive(),
          "Contrast of shared texture (grey levels of L*, after even light) from which on nothing more is asked.");
  v.field("min_explained_share", o.min_explained_share, between(0, 1),
          "As acceptance.min_explained_share, where no texture is shared.");
  v.field("min_gain", o.min_gain, between(0, 1),
          "Least unary gain, as a share of what the hypothesis explains, where no texture is shared (with "
          "acceptance.require_unary_gain).");
}

/// When the evidence for one hypothesis is enough, whatever the others are.
struct AcceptanceOptions {
  double min_visible_share = 0.1;
  double min_explained_share = 0.7;
  std::optional<double> min_pattern_similarity{};
  std::optional<double> min_newest_similarity{};
  double min_shared_texture = 0;
  std::optional<UntexturedOptions> untextured{};
  bool require_unary_gain = false;
  void check() const { check_options("AcceptanceOptions", *this); }
};

inline void declare(OptionVisitor& v, AcceptanceOptions& o) {
  v.field("min_visible_share", o.min_visible_share, between(0, 1),
          "A hypothesis of which a smaller share of the model is visible is rejected. 0: none is.", "later V4R");
  v.field("min_explained_share", o.min_explained_share, between(0, 1),
          "A hypothesis of which the scene explains a smaller share of the visible points is rejected. 0: none is.",
          "later V4R");
  v.field(
      "min_pattern_similarity", o.min_pattern_similarity, between(-1, 1),
      "A hypothesis whose colours correlate less with the scene's is rejected, however well they agree in the mean. "
      "off: none is.");
  v.field(
      "min_newest_similarity", o.min_newest_similarity, between(-1, 1),
      "Least similarity of the colours in the newest view that sees at least 50 points; the reconstruction may still "
      "hold those of a former object. off: not compared.");
  v.field("min_shared_texture", o.min_shared_texture, between(0, 1),
          "A hypothesis of a textured model (contrast of 1 or more) that shares a smaller part of its texture with the "
          "scene is rejected. 0: none is.");
  v.group("untextured", o.untextured, "Whether more is asked of a hypothesis that shares little texture.");
  v.field("require_unary_gain", o.require_unary_gain,
          "Hypotheses that alone cost more than they explain are rejected: two that split a larger surface would "
          "otherwise excuse each other.");
  v.rule(!o.untextured || o.untextured->min_gain == 0 || o.require_unary_gain,
         "untextured.min_gain has no effect unless require_unary_gain = true (set it to 0)");
}

/// Whether the evidence is enough to ask for the costs (kCost), or else why not.
[[nodiscard]] Verdict assess_evidence(const HypothesisEvidence& evidence, const AcceptanceOptions& options);

/// Whether it may enter the selection: its verdict is kCost and, if required, it explains more than it costs (by
/// UntexturedOptions::min_gain where it shares no texture).
[[nodiscard]] bool has_unary_gain(const HypothesisEvidence& evidence, const AcceptanceOptions& options);

}  // namespace resight
