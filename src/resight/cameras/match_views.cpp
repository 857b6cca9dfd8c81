// SPDX-License-Identifier: Apache-2.0
#include "resight/cameras/match_views.hpp"

#include <utility>
#include <vector>

#include "resight/core/check.hpp"

namespace resight {
namespace {

// For each feature of `queries`, the nearest of `index` if it passes the ratio test (Lowe 2004); otherwise -1.
std::vector<int> find_distinct(const FeatureSet& queries, const DescriptorIndex& index, double max_ratio) {
  const std::vector<DescriptorMatch> matches = index.search(queries.descriptors, 2);
  const double max_ratio_sq = max_ratio * max_ratio;
  std::vector<int> nearest(queries.size(), -1);
  for (std::size_t i = 0; i < nearest.size(); ++i) {
    const DescriptorMatch& best = matches[2 * i];
    const DescriptorMatch& next = matches[2 * i + 1];
    if (next.index >= 0 && best.distance_sq < max_ratio_sq * next.distance_sq) nearest[i] = best.index;
  }
  return nearest;
}

}  // namespace

void MatchViewsOptions::check() const {
  check_in_range("max_ratio", max_ratio, 0, 1);
  pose.check();
}

ViewFeatures::ViewFeatures(FeatureSet features_in_camera)
    : features_(std::move(features_in_camera)),
      index_(features_.descriptors, features_.dimension, {.exact_below = 1 << 20}) {}

std::optional<ViewMatch> match_views(const ViewFeatures& a, const ViewFeatures& b, const MatchViewsOptions& options) {
  options.check();
  const FeatureSet& in_a = a.features();
  const FeatureSet& in_b = b.features();
  if (in_a.size() < 2 || in_b.size() < 2) return std::nullopt;
  const std::vector<int> a_of_b = find_distinct(in_b, a.index(), options.max_ratio);
  const std::vector<int> b_of_a = find_distinct(in_a, b.index(), options.max_ratio);
  std::vector<Correspondence> mutual;
  for (std::size_t i = 0; i < a_of_b.size(); ++i) {
    const int j = a_of_b[i];
    if (j < 0 || b_of_a[static_cast<std::size_t>(j)] != static_cast<int>(i)) continue;
    const auto k = static_cast<std::size_t>(j);
    mutual.push_back({.model_point = in_b.points[i],
                      .model_normal = in_b.normals[i],
                      .scene_point = in_a.points[k],
                      .scene_normal = in_a.normals[k]});
  }
  const std::optional<PoseEstimate> pose = estimate_pose(mutual, options.pose);
  if (!pose) return std::nullopt;
  return ViewMatch{pose->scene_from_model, static_cast<int>(pose->inliers.size()), pose->rms_m};
}

}  // namespace resight
