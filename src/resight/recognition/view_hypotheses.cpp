// SPDX-License-Identifier: Apache-2.0
#include "resight/recognition/view_hypotheses.hpp"

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
  // All but what follows the hypotheses of a view is as it is by default.
  RecognizerConfig counted;
  counted.run = config.run;
  counted.camera.color_offset = config.camera.color_offset;
  counted.camera.depth_bias = config.camera.depth_bias;
  counted.prepare = config.prepare;
  counted.features = config.features;
  counted.hypotheses.generate = config.hypotheses.generate;
  counted.shape = config.shape;
  // Shapes are checked as the verification does (match_criteria()).
  counted.verify.appearance = config.verify.appearance;
  counted.verify.support.min_weight = config.verify.support.min_weight;
  counted.verify.acceptance.min_pattern_similarity = config.verify.acceptance.min_pattern_similarity;
  counted.verify.refine.symmetry_step_rad = config.verify.refine.symmetry_step_rad;
  std::string text;
  // Tracked objects come from all stages.
  for (const auto& [name, value] : (config.limits_search() ? config : counted).to_settings())
    text += name + "=" + value + "\n";
  return text;
}

}  // namespace resight
