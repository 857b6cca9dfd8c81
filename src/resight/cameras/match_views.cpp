// SPDX-License-Identifier: Apache-2.0
#include "resight/cameras/match_views.hpp"

#include <vector>

#include "resight/core/check.hpp"

namespace resight {
void MatchViewsOptions::check() const {
  check_in_range("max_ratio", max_ratio, 0, 1);
  pose.check();
}

std::optional<ViewMatch> match_views(const ViewFeatures& a, const ViewFeatures& b, const MatchViewsOptions& options) {
  options.check();
  const FeatureSet& in_a = a.features();
  const FeatureSet& in_b = b.features();
  if (in_a.size() < 2 || in_b.size() < 2) return std::nullopt;
  std::vector<Correspondence> mutual;
  for (const FeaturePair& pair : find_mutual_matches(b, a, options.max_ratio)) {
    const auto of_b = static_cast<std::size_t>(pair.a);
    const auto of_a = static_cast<std::size_t>(pair.b);
    mutual.push_back({.model_point = in_b.points[of_b],
                      .model_normal = in_b.normals[of_b],
                      .scene_point = in_a.points[of_a],
                      .scene_normal = in_a.normals[of_a]});
  }
  const std::optional<PoseEstimate> pose = estimate_pose(mutual, options.pose);
  if (!pose) return std::nullopt;
  ViewMatch match{pose->scene_from_model, static_cast<int>(pose->inliers.size()), pose->rms_m, {}, {}};
  for (const int i : pose->inliers) {
    match.points_a.push_back(mutual[static_cast<std::size_t>(i)].scene_point);
    match.points_b.push_back(mutual[static_cast<std::size_t>(i)].model_point);
  }
  return match;
}

}  // namespace resight
