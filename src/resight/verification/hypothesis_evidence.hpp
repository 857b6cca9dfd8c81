// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <vector>

#include "resight/geometry/rigid3.hpp"
#include "resight/registration/pose_uncertainty.hpp"
#include "resight/sensor/prepared_view.hpp"

namespace resight {

/// A view that hypotheses are checked in.
struct VerificationView {
  const PreparedView* view = nullptr;  ///< As used for the reconstruction (removed points cleared).
};

/// Why a hypothesis was accepted or not.
enum class Verdict : std::uint8_t {
  kAccepted,
  /// kMinVisiblePoints or acceptance.min_visible_share not reached: occluded, outside, or the mask allows no view.
  kTooFewVisible,
  kNoSupport,            ///< Less than acceptance.min_explained_share of the visible points is explained.
  kDifferentAppearance,  ///< Less than acceptance.min_pattern_similarity, min_newest_similarity or min_shared_texture.
  kSuppressed,           ///< Has unary gain, but does not pay beside `suppressed_by`.
  kCost,                 ///< Costs more than it explains even alone.
};

/// Short lower-case name for reports.
[[nodiscard]] const char* to_string(Verdict verdict);

/// How the colours of model and scene agree. All but is_compared are as they are here if these have no colours, or the
/// hypothesis has not enough support (has_support()).
struct AppearanceEvidence {
  bool is_compared = true;        ///< Whether model and scene have colours.
  double pattern_similarity = 1;  ///< pattern_similarity() of the colours of model and scene.
  /// The same with the colours of the newest view that sees enough of the model; 1 if not compared.
  double newest_similarity = 1;
  double hue_similarity = 1;    ///< hue_similarity() of model and scene; 1 for an untextured model.
  double shared_texture = 0;    ///< PatternMatch::shared_texture, at most texture_contrast.
  double texture_contrast = 0;  ///< Texture of the visible model itself, in even light.
  /// NewestViewAppearance::silhouette_error(), for hypotheses with enough support and the right appearance.
  double silhouette_error = 0;
};

/// The terms of the selection. All but `outlier` are computed only for hypotheses with enough support and the right
/// appearance.
struct HypothesisCosts {
  double explained_scene = 0;  ///< Gain: sum of the weights of the explained scene points (HypothesisCues).
  double outlier = 0;          ///< Visible model points that are not explained.
  double clutter = 0;          ///< Unexplained scene points beside the explained ones (ClutterOptions).
  double plane = 0;            ///< Points of planes that it claims, and model points on the far side of a plane.
  /// Cost of the set with this hypothesis alone. What it explains counts by its score (selection.score_power), unless
  /// it was merged with another one before the selection. Negative: unary gain. 0 if rejected earlier.
  double unary = 0;
};

/// Evidence for and against one hypothesis.
struct HypothesisEvidence {
  bool accepted = false;
  Rigid3 world_from_object;  ///< The verified pose: refined, then rotated by symmetry.
  /// In [0, 1]: mean similarity (distance, normal, colour) over the visible points; 0 for points that are not
  /// explained. Grazing ones count little.
  double fit = 0;
  double visible_share = 0;     ///< Visible / all model points.
  int num_visible = 0;          ///< Model points visible in at least one allowed view.
  int num_explained = 0;        ///< Of these, inliers.
  int num_correspondences = 0;  ///< Of the hypothesis, within support.max_distance_m at the pose.
  /// One per view; 0 where the presence mask excludes it.
  std::vector<float> visible_share_per_view;
  /// Explained share of the points visible in that view; points that it sees through are not explained.
  std::vector<float> explained_share_per_view;
  /// Inliers / visible points, grazing ones count a tenth: what acceptance.min_explained_share tests.
  double explained_share = 0;
  double seen_through_share = 0;  ///< Of the visible points (visibility.free_space).
  AppearanceEvidence appearance;
  HypothesisCosts costs;
  /// Probability that it is right, in [0, 1] (HypothesisScoreOptions); 0 without enough support or the right
  /// appearance.
  double score = 0;
  Verdict verdict = Verdict::kTooFewVisible;
  PoseUncertainty uncertainty;  ///< Of accepted ones.
  /// Index of the accepted hypothesis that it conflicts with most, or of the one that refinement has led to the same
  /// pose; -1 for other verdicts.
  int suppressed_by = -1;
};

struct VerifyResult {
  std::vector<HypothesisEvidence> evidence;  ///< One per hypothesis.
  double cost = 0;                           ///< Of the chosen set; the empty set costs 0.
};

}  // namespace resight
