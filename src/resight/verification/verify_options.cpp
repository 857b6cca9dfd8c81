// SPDX-License-Identifier: Apache-2.0
#include "resight/verification/verify_options.hpp"

#include <numbers>
#include <string>

#include "resight/core/check.hpp"
#include "resight/verification/hypothesis_verifier.hpp"

namespace resight {

const char* to_string(Verdict verdict) {
  switch (verdict) {
    case Verdict::kAccepted:
      return "accepted";
    case Verdict::kTooFewVisible:
      return "too few visible";
    case Verdict::kNoSupport:
      return "no support";
    case Verdict::kDifferentAppearance:
      return "other pattern";
    case Verdict::kSuppressed:
      return "outvoted";
    case Verdict::kCost:
      return "cost";
  }
  return "unknown";
}

void VerifyOptions::check() const {
  const auto name = [](const char* field) { return std::string("VerifyOptions.") + field; };
  check_positive(name("resolution_m"), resolution_m);
  check_positive(name("inlier_distance_m"), inlier_distance_m);
  check_not_negative(name("occlusion_margin_m"), occlusion_margin_m);
  check_not_negative(name("outlier_weight"), outlier_weight);
  check_in_range(name("duplicity_weight"), duplicity_weight, 0, 1000);
  check_positive(name("clutter_radius_m"), clutter_radius_m);
  check_in_range(name("clutter_weight"), clutter_weight, 0, 1000);
  check_in_range(name("near_clutter_weight"), near_clutter_weight, 0, 1000);
  check_not_negative(name("continuation_offset_m"), continuation_offset_m);
  check_not_negative(name("continuation_contrast"), continuation_contrast);
  check_in_range(name("clutter_sigmas"), clutter_sigmas, 0, 1000);
  check_in_range(name("occupancy_weight"), occupancy_weight, 0, 1e6);
  check_positive(name("occupancy_voxel_m"), occupancy_voxel_m);
  check_in_range(name("hypothesis_penalty"), hypothesis_penalty, 0, 1e9);
  check_positive(name("color_sigma_l"), color_sigma_l);
  check_positive(name("color_sigma_ab"), color_sigma_ab);
  refine.check();
  check_in_range(name("turn_step_rad"), turn_step_rad, 0, std::numbers::pi);
  check_not_negative(name("merge_distance_m"), merge_distance_m);
  check_in_range(name("merge_rotation_rad"), merge_rotation_rad, 0, std::numbers::pi);
  check_not_negative(name("light.max_log_exposure"), light.max_log_exposure);
  check_not_negative(name("light.max_log_darkening"), light.max_log_darkening);
  check_not_negative(name("light.max_log_white_balance"), light.max_log_white_balance);
  check_not_negative(name("light.max_veil"), light.max_offset);
  check_not_negative(name("light.max_log_chroma"), light.max_log_chroma);
  check_not_negative(name("light.max_log_shading"), light.max_log_shading);
  check_not_negative(name("plane_spacing_m"), plane_spacing_m);
  planes.check();
  segments.check();
  check_in_range(name("plane_weight"), plane_weight, 0, 1);
  check_in_range(name("min_facing"), min_facing, -1, 1);
  check_in_range(name("steep_angle_rad"), steep_angle_rad, 0, std::numbers::pi / 2);
  check_in_range(name("steep_weight"), steep_weight, 0, 1);
  check_in_range(name("min_inlier_weight"), min_inlier_weight, 0, 1);
  check_in_range(name("max_inlier_angle_rad"), max_inlier_angle_rad, 0, std::numbers::pi / 2);
  check_in_range(name("max_seen_through_share"), max_seen_through_share, 0, 1);
  check_in_range(name("max_absent_share"), max_absent_share, 0, 1);
  check_not_negative(name("max_moves"), max_moves);
  check_in_range(name("max_exact_hypotheses"), max_exact_hypotheses, 0, 20);
  check_not_negative(name("min_shared_points"), min_shared_points);
  check_not_negative(name("min_visible_points"), min_visible_points);
  check_in_range(name("min_visible_share"), min_visible_share, 0, 1);
  check_in_range(name("min_explained_share"), min_explained_share, 0, 1);
  check_in_range(name("min_pattern_similarity"), min_pattern_similarity, -1, 1);
  check_in_range(name("min_newest_similarity"), min_newest_similarity, -1, 1);
  check_not_negative(name("plain.max_shared_contrast"), plain.max_shared_contrast);
  check_in_range(name("plain.min_explained_share"), plain.min_explained_share, 0, 1);
  check_in_range(name("min_shared_print"), min_shared_print, 0, 1);
  check_in_range(name("plain.min_gain"), plain.min_gain, 0, 1);
  check_positive(name("num_threads"), num_threads);
}

VerifyResult verify_hypotheses(std::span<const Hypothesis> hypotheses, const ModelLibrary& library,
                               const PointCloud& scene_in_world, std::span<const VerificationView> views,
                               std::span<const std::uint8_t> present, const VerifyOptions& options) {
  return HypothesisVerifier(library, options).verify(hypotheses, scene_in_world, views, present);
}

}  // namespace resight
