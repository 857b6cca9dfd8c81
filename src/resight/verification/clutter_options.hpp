// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <variant>

#include "resight/core/options.hpp"

namespace resight {

/// Clutter are the unexplained points in smooth segments of which the hypothesis explains a part.
struct SegmentClutter {
  double near_weight = 1.0;
};

inline void declare(OptionVisitor& v, SegmentClutter& o) {
  v.field("near_weight", o.near_weight, between(0, 1000),
          "Cost of an unexplained point in no segment, times (1 - d^2 / radius_m^2) max(0, cosine of the normals). "
          "Points of other segments cost nothing.");
}

/// Clutter are the unexplained points that continue the surface of an explained one: near its tangent plane, of similar
/// normal and colour.
struct ContinuationClutter {
  double max_offset_m = 0.005;
  std::optional<double> texture_contrast{};
  double noise_sigmas = 0;
};

inline void declare(OptionVisitor& v, ContinuationClutter& o) {
  v.field("max_offset_m", o.max_offset_m, positive(),
          "Largest distance from the tangent plane of an explained point at which a surface continues.");
  v.field(
      "texture_contrast", o.texture_contrast, positive(),
      "Shared texture of contrast c divides the cost by 1 + (c / texture_contrast)^2: textured objects are rarely "
      "part of something larger. For that reason, planes larger than an object do not cost it the points on which it "
      "shares their texture: it explains them. off: full cost.");
  v.field("noise_sigmas", o.noise_sigmas, between(0, 1000),
          "Points in front of the model or behind it, along its normal, are noise and no clutter within this many "
          "standard deviations of the depth (if that is more than support.max_distance_m; up to radius_m).",
          "Nguyen et al. 2012 (noise of the sensor)");
}

/// Cost of scene points that a hypothesis leaves unexplained beside those that it explains.
struct ClutterOptions {
  double radius_m = 0.03;
  double weight = 1.0;
  std::variant<SegmentClutter, ContinuationClutter> rule{};
};

inline void declare(OptionVisitor& v, ClutterOptions& o) {
  v.field("radius_m", o.radius_m, grid_length_m(), "Clutter is counted within this distance of an explained point.",
          "V4R");
  v.field("weight", o.weight, between(0, 1000), "Cost of a clutter point. 0: clutter costs nothing.");
  v.choice("rule", o.rule,
           {{"segments", "the rest of smooth segments that are explained in part (V4R)"},
            {"continuation", "what continues the surface of explained points"}},
           "Which unexplained points are clutter.");
}

}  // namespace resight
