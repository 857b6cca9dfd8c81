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
  kTooFewVisible,  ///< kMinVisiblePoints or acceptance.min_visible_share not reached: hidden, outside, or the mask
                   ///< allows no view.
  kNoSupport,      ///< Less than acceptance.min_explained_share of the visible points is explained.
  kDifferentAppearance,  ///< Less than acceptance.min_pattern_similarity, min_newest_similarity or min_shared_texture.
  kSuppressed,           ///< Pays off alone, but not beside `suppressed_by`.
  kCost,  ///< Costs more than it explains even alone (outliers, clutter, planes); what is plain, nearly as much.
};

/// Short lower-case name for reports.
[[nodiscard]] const char* to_string(Verdict verdict);

/// What speaks for and against one hypothesis. The costs but for the outliers', and explained_scene, are worked out
/// only of those that have support and the right pattern.
struct HypothesisEvidence {
  bool accepted = false;
  Rigid3 world_from_object;  ///< The pose that was judged: the hypothesis', refined and turned.
  double fit = 0;  ///< In [0, 1]: share of its visible points that the scene explains (distance, normal, colour),
                   ///< each weighted by how well; grazing ones count little.
  double visible_share = 0;     ///< Visible / all model points.
  int num_visible = 0;          ///< Model points visible in at least one allowed view.
  int num_explained = 0;        ///< Of these, inliers.
  int num_correspondences = 0;  ///< Of the hypothesis, within support.max_distance_m at the pose.
  double explained_scene = 0;   ///< Sum of weights of the scene points it explains, without those of a plane.
  double outlier_cost = 0;
  std::vector<float> visible_share_per_view;    ///< One per view; 0 where the presence mask excludes it, and before
                                                ///< it came (visibility.arrival_share).
  std::vector<float> explained_share_per_view;  ///< Of the visible points in that view, those with an inlier and not
                                                ///< looked through by that view.
  double explained_share =
      0;  ///< Inliers / visible points, grazing ones count a tenth: what acceptance.min_explained_share tests.
  double pattern_similarity = 1;  ///< Of the model's colours and the scene's (pattern_similarity.hpp).
  double shared_texture = 0;      ///< PatternMatch::shared_texture of both, but no more than the model's own print
                                  ///< has in even light.
  double texture_contrast = 0;    ///< Of the model's own print in even light, where it is visible: at most so much can
                                  ///< be shared.
  double newest_similarity = 1;  ///< As pattern_similarity, with the colours of the newest view that sees enough of it;
                                 ///< 1 if that is not asked for, or none does.
  double clutter_cost = 0;       ///< Alone: unexplained rest of the segments that it explains in part.
  double plane_cost = 0;         ///< Points of planes that it claims, and model points on the far side of a plane.
  double unary_cost = 0;  ///< Cost of the set of this one only; negative pays off. 0 if rejected before the choice.
  Verdict verdict = Verdict::kTooFewVisible;
  PoseUncertainty uncertainty;  ///< Of accepted ones.
  int suppressed_by = -1;  ///< Index of the accepted hypothesis that it conflicts with most; -1 for other verdicts.
};

struct VerifyResult {
  std::vector<HypothesisEvidence> evidence;  ///< One per hypothesis.
  double cost = 0;                           ///< Of the chosen set; the empty set costs 0.
  int num_moves = 0;                         ///< Accepted moves of the local search.
  int num_planes = 0;  ///< Found around the hypotheses: farther parts of the scene are not looked at.
  int num_segments = 0;
  int num_components = 0;  ///< Sets of hypotheses that share no scene point and no voxel: chosen independently.
  bool is_optimal = true;  ///< Every component was solved exactly.
};

}  // namespace resight
