// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>
#include <variant>

#include "resight/appearance/appearance_options.hpp"
#include "resight/core/options.hpp"
#include "resight/verification/acceptance.hpp"
#include "resight/verification/clutter_options.hpp"
#include "resight/verification/hypothesis_score.hpp"
#include "resight/verification/pose_refinement.hpp"
#include "resight/verification/selection_options.hpp"
#include "resight/verification/visibility_options.hpp"

namespace resight {

/// When a scene point explains a model point.
struct SupportOptions {
  double max_distance_m = 0.015;
  double min_weight = 0.8;
};

inline void declare(OptionVisitor& v, SupportOptions& o) {
  v.field("max_distance_m", o.max_distance_m, grid_length_m(),
          "A scene point explains a model point within this distance.", "V4R");
  v.field("min_weight", o.min_weight, between(0, 1),
          "Product of the weights by distance and by colour from which a visible model point is explained. 0: every "
          "point with a neighbour; 1: none.",
          "V4R");
}

/// Tables and walls: points of a plane larger than the object count against a hypothesis instead of for it.
struct PlaneOptions {
  std::optional<double> spacing_m{};
  double max_distance_m = 0.01;
};

inline void declare(OptionVisitor& v, PlaneOptions& o) {
  v.field("spacing_m", o.spacing_m, positive(),
          "Planes are found in the scene downsampled to this, if it is more than the resolution: faster, and without "
          "smooth segments. off: from the smooth segments of the scene at full resolution.");
  v.field("max_distance_m", o.max_distance_m, positive(),
          "Largest distance of a point from its plane. A box that lies flat must be thicker.",
          "ours; V4R: 0.02, which swallows such boxes");
}

/// Options of the global verification (paper [11], as in V4R's GO3D; defaults from there unless said otherwise).
struct VerifyOptions {
  double resolution_m = 0.005;
  SupportOptions support{};
  VisibilityOptions visibility{};
  AppearanceOptions appearance{};
  RefinePoseOptions refine{};
  ClutterOptions clutter{};
  std::optional<PlaneOptions> planes = PlaneOptions{};
  SelectionOptions selection{};
  AcceptanceOptions acceptance{};
  HypothesisScoreOptions score{};
  std::uint64_t seed = 1;
  int num_threads = 1;  ///< Same bits for any value >= 1.
  void check() const { check_options("VerifyOptions", *this); }
};

inline void declare(OptionVisitor& v, VerifyOptions& o) {
  v.field("resolution_m", o.resolution_m, grid_length_m(),
          "Models and scene are downsampled to one point per voxel of this size. Smaller: slower, finer.", "V4R");
  v.group("support", o.support);
  v.group("visibility", o.visibility);
  v.group("appearance", o.appearance);
  v.group("refine", o.refine);
  v.group("clutter", o.clutter);
  v.group("planes", o.planes, "Whether planes larger than an object count as background.", "V4R");
  v.group("selection", o.selection);
  v.group("acceptance", o.acceptance);
  v.group("score", o.score);
  v.seed(o.seed);
  v.num_threads(o.num_threads);
  v.rule(!o.planes || !o.planes->spacing_m || std::holds_alternative<ContinuationClutter>(o.clutter.rule),
         "planes.spacing_m has no effect unless clutter.rule = continuation (the other rule needs smooth segments)");
}

}  // namespace resight
