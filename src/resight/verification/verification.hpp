// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "resight/geometry/point_cloud.hpp"
#include "resight/hypotheses/hypothesis.hpp"
#include "resight/models/object_model.hpp"
#include "resight/sensor/prepared_view.hpp"

namespace resight {

/// Options of the global verification (paper [11], as in V4R's GO3D; reference values from there).
struct VerifyOptions {
  double resolution_m = 0.005;          ///< Models and scene are thinned to this.
  double inlier_distance_m = 0.015;     ///< A scene point explains a model point within this.
  double occlusion_margin_m = 0.02;     ///< A model point farther than the depth image by more than this is hidden.
  double outlier_weight = 1.0;
  double duplicity_weight = 1.0;        ///< Scene points explained twice.
  double clutter_radius_m = 0.03;
  double clutter_weight = 1.0;
  double occupancy_weight = 2.0;        ///< Voxels filled by two objects.
  double occupancy_voxel_m = 0.005;
  double hypothesis_penalty = 0.0;
  bool use_color = true;
  double color_sigma_l = 0.6;
  double color_sigma_ab = 0.6;
  bool use_planes = true;
  int min_plane_points = 5000;          ///< At the resolution of a full view; scaled with the reconstruction's.
  double plane_distance_m = 0.02;
  double smooth_angle_rad = 0.25;       ///< Smooth segments: neighbours' normals differ by less.
  double smooth_distance_m = 0.01;
  int min_smooth_points = 100;
  double max_smooth_curvature = 0.04;
  int max_moves = 5000;                 ///< Of the local search: a budget in steps.
  int min_visible_points = 20;          ///< Fewer visible model points: no evidence, rejected.
  std::uint64_t seed = 1;
  int num_threads = 1;                  ///< Same bits for any value >= 1.
  void check() const;
};

/// A view that hypotheses are checked in.
struct VerificationView {
  const PreparedView* view = nullptr;   ///< As used for the reconstruction (removed points cleared).
};

/// What speaks for and against one hypothesis.
struct HypothesisEvidence {
  bool accepted = false;
  double score = 0;             ///< In [0, 1]: share of its visible points that the scene explains (distance, normal, colour).
  double visible_share = 0;     ///< Visible / all model points.
  int num_visible = 0;          ///< Model points visible in at least one allowed view.
  int num_explained = 0;        ///< Of these, inliers.
  double explained_scene = 0;   ///< Sum of weights of the scene points it explains.
  double outlier_cost = 0;
  std::vector<float> visible_share_per_view;    ///< One per view; 0 where the presence mask excludes it.
  std::vector<float> explained_share_per_view;  ///< Of the visible points in that view, those with an inlier.
};

struct VerifyResult {
  std::vector<HypothesisEvidence> evidence;   ///< One per hypothesis.
  double cost = 0;                            ///< Of the chosen set; the empty set costs 0.
  int num_moves = 0;                          ///< Accepted moves of the local search.
  int num_planes = 0;
  int num_segments = 0;
};

/// Chooses the set of hypotheses that explains the scene best (binary cost of [11], local search with activate, deactivate and replace moves).
/// `present`: views x hypotheses (view-major), non-zero where the change detection says that the object may be present; empty = everywhere.
/// A model point counts as visible if one allowed view sees it (its own back and self-occluded parts do not count). Scene and views in the world frame.
[[nodiscard]] VerifyResult verify_hypotheses(std::span<const Hypothesis> hypotheses, const ModelLibrary& library, const PointCloud& scene_in_world,
                                             std::span<const VerificationView> views, std::span<const std::uint8_t> present, const VerifyOptions& options = {});

}  // namespace resight
