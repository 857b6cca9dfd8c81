// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>

#include "resight/core/options.hpp"
#include "resight/verification/hypothesis_evidence.hpp"

namespace resight {

/// Weights of a logistic regression; all 0: 0.5 for any evidence. `bench_fit_scores` fits them. Those of `default` are
/// fitted to its detections at K = 0 and 5, where the simulator (`dynamic-tabletop`, seed 1) counts as much as all
/// other recordings together: the more look-alikes a scene holds, the less often the same evidence is right.
/// Later fits held these weights and added those of the silhouette and of the hue, each with a new offset, and that of
/// models without colours; docs/ablation.md names their seeds. docs/results.md says how well the scores generalise.
struct HypothesisScoreOptions {
  double offset = 0;
  double gain_weight = 0;
  double correspondence_weight = 0;
  double fit_weight = 0;
  double visible_weight = 0;
  double texture_weight = 0;
  double beside_planes_weight = 0;
  double newest_weight = 0;
  double seen_through_weight = 0;
  double silhouette_weight = 0;
  double hue_weight = 0;
  double uncolored_weight = 0;
  void check() const { check_options("HypothesisScoreOptions", *this); }
};

inline void declare(OptionVisitor& v, HypothesisScoreOptions& o) {
  v.field("offset", o.offset, between(-100, 100), "Log odds of being right before any evidence.", "fitted");
  v.field(
      "gain_weight", o.gain_weight, between(0, 100),
      "Weight of the unary gain: what a hypothesis explains of the scene less what it costs, as a share of the former.",
      "fitted");
  v.field("correspondence_weight", o.correspondence_weight, between(0, 100), "Weight of log(1 + correspondences).",
          "fitted");
  v.field("fit_weight", o.fit_weight, between(0, 100), "Weight of the fit: how well the visible points are explained.",
          "fitted");
  v.field("visible_weight", o.visible_weight, between(0, 100), "Weight of log(0.01 + visible share of the model).",
          "fitted");
  v.field("texture_weight", o.texture_weight, between(0, 100),
          "Weight of log(1 + contrast of the texture that model and scene share), in grey levels of L*.", "fitted");
  v.field("beside_planes_weight", o.beside_planes_weight, between(0, 100),
          "Weight of the share of what a hypothesis explains that is no part of a plane larger than the object: pieces "
          "of tables and walls look like the faces of boxes.",
          "fitted");
  v.field("newest_weight", o.newest_weight, between(0, 100),
          "Weight of the similarity of the model's colours to those of the newest view.", "fitted");
  v.field("seen_through_weight", o.seen_through_weight, between(0, 100),
          "Weight, against the hypothesis, of the share of the visible points that are seen through "
          "(visibility.free_space).",
          "fitted");
  v.field("silhouette_weight", o.silhouette_weight, between(0, 100),
          "Weight, against the hypothesis, of log(0.02 + share of the points that lie where the newest view has no "
          "depth, and shows other colours).",
          "fitted");
  v.field("hue_weight", o.hue_weight, between(0, 100),
          "Weight of the hue similarity of model and scene, 1 for an untextured model: look-alikes often have other "
          "colours.",
          "fitted");
  v.field("uncolored_weight", o.uncolored_weight, between(-100, 100),
          "Takes the place of the weights of texture, newest colours, silhouette and hue where model or scene has no "
          "colours: these say nothing then.",
          "fitted");
}

/// What the weights of HypothesisScoreOptions weigh, in their order.
using ScoreCues = std::array<double, 11>;
[[nodiscard]] ScoreCues score_cues(const HypothesisEvidence& evidence);

/// How likely a hypothesis with enough support and the right appearance is right, in [0, 1]: of the accepted ones with
/// score s about a share s is.
[[nodiscard]] double hypothesis_score(const HypothesisEvidence& evidence, const HypothesisScoreOptions& options);

}  // namespace resight
