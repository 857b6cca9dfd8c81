// SPDX-License-Identifier: Apache-2.0
#include "resight/shape_search/match_pairs.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "resight/hypotheses/correspondence_grouping.hpp"
#include "resight/shape_search/point_pair_table.hpp"

namespace resight {
namespace {

constexpr float kMinLength_m = 0.012F;            // Shorter pairs leave the rotation too uncertain.
constexpr float kMaxLengthDifference_m = 0.008F;  // Two keypoints are off by a few millimetres each.
constexpr float kMaxCosineDifference = 0.3F;      // Of normals with each other and with the line.

bool may_be_one_thing(const OrientedPointPair& model, const OrientedPointPair& scene) {
  const Eigen::Vector3f model_line = model.p2 - model.p1;
  const Eigen::Vector3f scene_line = scene.p2 - scene.p1;
  const float model_length = model_line.norm();
  const float scene_length = scene_line.norm();
  if (!(scene_length > kMinLength_m && model_length > kMinLength_m) ||
      std::abs(model_length - scene_length) > kMaxLengthDifference_m)
    return false;
  const auto alike = [](float a, float b) { return std::abs(a - b) < kMaxCosineDifference; };  // False for NaN.
  return alike(model.n1.dot(model.n2), scene.n1.dot(scene.n2)) &&
         alike(model.n1.dot(model_line) / model_length, scene.n1.dot(scene_line) / scene_length) &&
         alike(model.n2.dot(model_line) / model_length, scene.n2.dot(scene_line) / scene_length);
}

}  // namespace

std::vector<PoseCandidate> poses_of_match_pairs(std::span<const Correspondence> matches, int object,
                                                const SampledModel& model, const PoseScorer& scorer,
                                                const ShapeSearchOptions& options) {
  std::vector<PoseCandidate> found;
  if (options.max_matches == 0 || model.points.empty()) return found;
  const std::vector<int> best = select_best_correspondences(matches, options.max_matches);
  for (std::size_t i = 0; i < best.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const Correspondence& a = matches[static_cast<std::size_t>(best[i])];
      const Correspondence& b = matches[static_cast<std::size_t>(best[j])];
      const OrientedPointPair in_model{a.model_point, a.model_normal, b.model_point, b.model_normal};
      const OrientedPointPair in_scene{a.scene_point, a.scene_normal, b.scene_point, b.scene_normal};
      if (!may_be_one_thing(in_model, in_scene)) continue;
      const auto pose = align(in_model, in_scene);
      if (!pose) continue;
      if (const auto candidate = test_coarsely(object, model, *pose, scorer)) found.push_back(*candidate);
    }
  return found;
}

std::vector<int> agreeing_matches(std::span<const Correspondence> matches, const Rigid3& scene_from_object,
                                  double max_distance_m) {
  const Rigid3f motion(scene_from_object);
  std::vector<std::pair<float, int>> near;
  for (std::size_t i = 0; i < matches.size(); ++i) {
    if (matches[i].type != FeatureType::kSift) continue;
    const float distance = (motion * matches[i].model_point - matches[i].scene_point).norm();
    if (distance <= static_cast<float>(max_distance_m)) near.emplace_back(distance, static_cast<int>(i));
  }
  std::sort(near.begin(), near.end());
  std::set<int> used_of_model;
  std::set<int> used_of_scene;
  std::vector<int> agreeing;
  for (const auto& [distance, i] : near) {
    const Correspondence& c = matches[static_cast<std::size_t>(i)];
    if (used_of_model.contains(c.model_feature) || used_of_scene.contains(c.scene_feature)) continue;
    used_of_model.insert(c.model_feature);
    used_of_scene.insert(c.scene_feature);
    agreeing.push_back(i);
  }
  std::sort(agreeing.begin(), agreeing.end());
  return agreeing;
}

}  // namespace resight
