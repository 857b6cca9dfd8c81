// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <memory>
#include <vector>

#include "resight/hypotheses/hypothesis.hpp"
#include "resight/models/object_model.hpp"
#include "resight/sensor/prepared_view.hpp"
#include "resight/shape_search/oriented_points.hpp"
#include "resight/shape_search/pose_probe.hpp"

namespace resight {

struct ShapeSearchOptions {
  bool enabled = false;
  SampleSceneOptions scene{};
  int max_model_samples = 300;   ///< Per object.
  int max_seeds = 1500;          ///< Scene points from which dipoles are drawn.
  int pairs_per_seed = 20;
  int max_entries = 32;          ///< Of the table tried per dipole and object.
  int coarse_samples = 40;       ///< Of a model's surface in the coarse test of a pose.
  int max_coarse_wrong = 5;      ///< Contradicted samples at which the coarse test gives up.
  double min_coarse_score = 0.2;
  ProbeOptions coarse{};
  int max_refined = 1000;         ///< Poses per object that are refined and judged.
  int refine_iterations = 6;
  double refine_distance_m = 0.02;
  double tolerance_m = 0.008;    ///< Of the depth when a refined pose is judged.
  double min_explained_share = 0.55;
  double min_pattern_similarity = 0.4;
  double min_visible_share = 0.2;
  double color_sigma_l = 0.45;
  double color_sigma_ab = 0.17;
  LightLimits light{};
  int max_hypotheses = 4;        ///< Per object and view.
  double same_place_m = 0.015;   ///< Poses nearer than this...
  double same_rotation_rad = 0.21;  ///< ...and this are one.
  std::uint64_t seed = 1;
  int num_threads = 1;
  void check() const;
};

/// A pose found by shape.
struct ShapeCandidate {
  int object = -1;
  Rigid3 camera_from_object;
  double quality = 0;
  int num_explained = 0;
};

/// Finds objects by their shape alone, checked with their colours: for what has no print, and hence no matches.
class ShapeSearch {
 public:
  ShapeSearch(const ModelLibrary& library, const ShapeSearchOptions& options);
  ~ShapeSearch();
  ShapeSearch(ShapeSearch&&) noexcept;

  [[nodiscard]] std::vector<ShapeCandidate> search(const PreparedView& view) const;

  /// How a pose would fare, for benches.
  struct Trial {
    ProbeCounts coarse;
    PoseProbe::Fit fit;
  };
  [[nodiscard]] Trial try_pose(const PreparedView& view, int object, const Rigid3& camera_from_object) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace resight
