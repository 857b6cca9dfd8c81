// SPDX-License-Identifier: Apache-2.0
#include "resight/recognition/view_hypotheses.hpp"

#include <algorithm>
#include <array>
#include <string_view>

namespace resight {

std::vector<Hypothesis> move_hypotheses(const ViewHypotheses& of_view, const Rigid3& world_from_camera) {
  std::vector<Hypothesis> hypotheses = of_view.hypotheses;
  if (of_view.world_from_camera.rotation == world_from_camera.rotation &&
      of_view.world_from_camera.translation == world_from_camera.translation)
    return hypotheses;
  const Rigid3 new_from_old = world_from_camera * of_view.world_from_camera.inverse();
  const Rigid3f new_from_old_f(new_from_old);
  for (Hypothesis& h : hypotheses) {
    h.world_from_object = new_from_old * h.world_from_object;
    for (Correspondence& c : h.correspondences) {
      c.scene_point = new_from_old_f * c.scene_point;
      c.scene_normal = new_from_old_f.rotation * c.scene_normal;
    }
  }
  return hypotheses;
}

std::string generation_settings(const RecognizerConfig& config) {
  // What follows the hypotheses of a view. All else counts, so that a new setting is not forgotten.
  constexpr std::array<std::string_view, 19> kLaterSections{"preset",
                                                            "num_previous_views",
                                                            "detect_changes",
                                                            "cluster_hypotheses",
                                                            "clear_tolerance_m",
                                                            "min_reported_share",
                                                            "min_carried_share",
                                                            "judge_absent",
                                                            "remember_objects",
                                                            "poses.",
                                                            "attention.",
                                                            "cluster.",
                                                            "changes.",
                                                            "removal.",
                                                            "integrate.",
                                                            "verify.",
                                                            "score.",
                                                            "history.",
                                                            "presence."};
  // Shapes are checked as the verification does (MatchCriteria).
  constexpr std::array<std::string_view, 4> kColors{"verify.appearance.", "verify.support.min_weight",
                                                    "verify.acceptance.min_pattern_similarity",
                                                    "verify.refine.symmetry_step_rad"};
  const auto starts_with_one_of = [](const std::string& name, const auto& sections) {
    return std::ranges::any_of(sections, [&](std::string_view s) { return name.starts_with(s); });
  };
  std::string text;
  const bool all_count = config.skips_places();  // Tracked objects come from all stages.
  for (const auto& [name, value] : config.to_settings())
    if (all_count || !starts_with_one_of(name, kLaterSections) || starts_with_one_of(name, kColors))
      text += name + "=" + value + "\n";
  return text;
}

}  // namespace resight
