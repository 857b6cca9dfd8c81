// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "resight/appearance/photometric_fit.hpp"
#include "resight/geometry/point_cloud.hpp"
#include "resight/hypotheses/hypothesis.hpp"
#include "resight/models/object_model.hpp"
#include "resight/segmentation/scene_planes.hpp"
#include "resight/segmentation/smooth_segments.hpp"
#include "resight/sensor/prepared_view.hpp"
#include "resight/verification/pose_refinement.hpp"

namespace resight {

/// What a scene point costs that several accepted hypotheses explain.
enum class DuplicityRule : std::uint8_t {
  kBeyondBest,  ///< All weights but the largest. Ours: what touches another object pays only for the overlap.
  kAllWeights,  ///< All weights, the largest included (V4R's mode 2): such a point is worse than an unexplained one.
};

/// What is asked of a hypothesis that shares no contrast with the scene, or is compared without colours: many things
/// have its shape. For one that shares some contrast, the limits lie between these and those for all.
struct UntexturedOptions {
  double max_shared_contrast = 0;  ///< From this shared contrast on nothing more is asked; 0: of none.
  double min_explained_share = 0.7;
  double min_gain =
      0.2;  ///< With must_pay_alone: that it explains more than it costs, alone, as a share of what it explains.
};

/// Options of the global verification (paper [11], as in V4R's GO3D; reference values from there).
struct VerifyOptions {
  double resolution_m = 0.005;       ///< Models and scene are thinned to this.
  double inlier_distance_m = 0.015;  ///< A scene point explains a model point within this.
  double occlusion_margin_m = 0.02;  ///< A model point farther than the depth image by more than this is hidden.
  double outlier_weight = 1.0;
  double duplicity_weight = 1.0;  ///< Scene points explained twice, at most 1000.
  DuplicityRule duplicity_rule = DuplicityRule::kBeyondBest;
  double clutter_radius_m = 0.03;
  double clutter_weight = 1.0;  ///< Of an unexplained point in the smooth segment of an explained one.
  double near_clutter_weight =
      1.0;  ///< Of one in no segment, times (1 - d^2/r^2) max(0, n_p n_q); in another segment: none.
  double continuation_offset_m = 0;  ///< If positive, only points that continue the surface count as unexplained: this
                                     ///< near the tangent plane of an explained one, of like normal and colour.
  double continuation_contrast = 0;  ///< ...and count 1 / (1 + (c / this)^2) if the prints share contrast c
                                     ///< (PatternMatch::shared_texture): a print rules out that it is a part of
                                     ///< something larger. 0: full in any case.
  double clutter_sigmas = 0;  ///< ...and not what lies in front of the model or behind it, along its normal, within so
                              ///< many standard deviations of the depth where they exceed inlier_distance_m (and up to
                              ///< clutter_radius_m): of things far away, noise. With continuation_offset_m only.
  double occupancy_weight = 2.0;  ///< Voxels filled by two objects.
  double occupancy_voxel_m = 0.005;
  double hypothesis_penalty = 0.0;
  bool use_color = true;
  double color_sigma_l = 0.4;   ///< Of (L - 50)/50, after the model's colours are adapted to the light...
  double color_sigma_ab = 0.2;  ///< ...and of a/128, b/128.
  PhotometricLimits light{};    ///< What the light may do to the colours of the model.
  RefinePoseOptions refine{};   ///< Before it is judged, each hypothesis is moved onto the scene.
  double turn_step_rad = 0;  ///< If positive, a refined pose is turned about what its shape leaves free (a can's axis,
                             ///< in such steps; a box's half turns) to where the print fits best; 0: it stays.
  double merge_distance_m = 0.01;        ///< Refined hypotheses of one object nearer than this (at its centre)...
  double merge_rotation_rad = 0.174533;  ///< ...and this (over its symmetries) are one.
  bool use_planes = true;
  double plane_spacing_m = 0;  ///< Planes are found in the scene thinned to this, if it is more than resolution_m
                               ///< (and segments are not needed: continuation_offset_m > 0).
  FindPlanesOptions planes{};
  double plane_weight = 0.8;  ///< How well a plane explains its points (V4R: 0.8, half of it with colour).
  SmoothSegmentsOptions segments{};
  double min_facing = 0.1;          ///< Cosine between normal and viewing ray from which a model point can be seen.
  double steep_angle_rad = 1.0472;  ///< Outliers seen more steeply than this (V4R: 60 deg)...
  double steep_weight = 0.1;        ///< ...count only this much (V4R: 0.1): depth is worst there.
  double min_inlier_weight = 0.8;   ///< Distance times colour weight from which a model point is explained (V4R: 0.8).
  double max_inlier_angle_rad = 1.0472;  ///< ...by a scene point whose normal deviates by less.
  bool newest_view_decides = false;  ///< A point that the newest view seeing it looks through is an outlier, whatever
                                     ///< older views saw: things come and go. Instead of the share that follows.
  double max_seen_through_share = 0.5;  ///< A point that more of the views seeing it look through is an outlier,
                                        ///< whatever the reconstruction says; 1 turns it off (V4R has no such test).
  double max_absent_share = 1;          ///< A view that looks through more of the model than this, while newer ones
                                ///< do not, is of before it came: it and older ones say nothing. 1 turns it off.
  int max_moves = 5000;                ///< Accepted moves of the local search, per component: a budget in steps.
  int max_exact_hypotheses = 12;       ///< Components up to this size (at most 20) are solved exactly.
  int min_shared_points = 10;          ///< Replace moves: pairs sharing more explained points than this (V4R: 10).
  int min_visible_points = 20;         ///< Fewer visible model points: no evidence, rejected.
  double min_visible_share = 0.1;      ///< As later V4R: less of the model visible is rejected...
  double min_explained_share = 0.7;    ///< ...and less of the visible points explained too. 0 turns either off.
  double min_pattern_similarity = -1;  ///< Prints that differ more are not the same, however well they fit in the mean;
                                       ///< -1 turns it off.
  double min_newest_similarity = -1;   ///< Likewise with the colours of the newest view that sees at least 50 points of
                                       ///< it: the scene may still have those of what was exchanged for it.
  double min_shared_print = 0;  ///< A model with a print (texture_contrast of 1 or more) is another if the scene shares
                                ///< less than this part of it.
  UntexturedOptions plain{};
  bool must_pay_alone = false;  ///< Hypotheses that cost more than they explain alone are rejected: together, two that
                                ///< split a larger surface would excuse what each of them leaves.
  std::uint64_t seed = 1;
  int num_threads = 1;  ///< Same bits for any value >= 1.
  void check() const;
};

/// A view that hypotheses are checked in.
struct VerificationView {
  const PreparedView* view = nullptr;  ///< As used for the reconstruction (removed points cleared).
};

/// Why a hypothesis was accepted or not.
enum class Verdict : std::uint8_t {
  kAccepted,
  kTooFewVisible,  ///< min_visible_points or min_visible_share not reached: hidden, outside, or the mask allows no
                   ///< view.
  kNoSupport,      ///< Less than min_explained_share (plain.min_explained_share) of the visible points is explained.
  kDifferentAppearance,  ///< Less than min_pattern_similarity, min_newest_similarity or min_shared_print.
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
                   ///< each weighted by how well; steep ones count little.
  double visible_share = 0;     ///< Visible / all model points.
  int num_visible = 0;          ///< Model points visible in at least one allowed view.
  int num_explained = 0;        ///< Of these, inliers.
  int num_correspondences = 0;  ///< Of the hypothesis, within inlier_distance_m at the pose.
  double explained_scene = 0;   ///< Sum of weights of the scene points it explains, without those of a plane.
  double outlier_cost = 0;
  std::vector<float> visible_share_per_view;    ///< One per view; 0 where the presence mask excludes it, and before
                                                ///< it came (max_absent_share).
  std::vector<float> explained_share_per_view;  ///< Of the visible points in that view, those with an inlier and not
                                                ///< looked through by that view.
  double explained_share =
      0;  ///< Inliers / visible points, steep ones counting steep_weight: what min_explained_share tests.
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

/// Chooses the set of hypotheses that explains the scene best (binary cost of [11], local search with activate,
/// deactivate and replace moves). `present`: views x hypotheses (view-major), non-zero where the change detection says
/// that the object may be present; empty = everywhere. A model point counts as visible if one allowed view sees it (its
/// own back and self-occluded parts do not count). Scene and views in the world frame.
///
/// Minimises J = -( E - r Out - Dup - Clut - w Occ - p |x| - Plane ). Deviations from V4R, each because the published
/// form fails where our tests look: small components are solved exactly; planes are always active, and count against a
/// hypothesis only where they are larger than its object; Occ is summed over pairs and does not count voxels whose
/// normals oppose (contact). A model or a scene without colours is judged by its shape, without normals by distance and
/// colour. Throws std::invalid_argument for bad options, a null view, a wrong size of `present`, an unknown object or a
/// pose that is not rigid. Non-finite scene points are ignored.
[[nodiscard]] VerifyResult verify_hypotheses(std::span<const Hypothesis> hypotheses, const ModelLibrary& library,
                                             const PointCloud& scene_in_world, std::span<const VerificationView> views,
                                             std::span<const std::uint8_t> present, const VerifyOptions& options = {});

}  // namespace resight
