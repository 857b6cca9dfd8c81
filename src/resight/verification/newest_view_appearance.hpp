// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <span>
#include <vector>

#include "resight/verification/scene_association.hpp"

namespace resight {

/// Compares a model's colours with those of the newest view that sees enough of it. The reconstruction may still hold
/// the colours of a former object of the same shape.
class NewestViewAppearance {
 public:
  NewestViewAppearance(const PreparedModel& model, const SceneAssociation& association,
                       std::span<const DepthView> views, const VerifyOptions& options);

  /// Similarity by match_surface_texture() under the white balance of the scene; 1 if no view sees enough.
  [[nodiscard]] double similarity(const Eigen::Array3f& white_balance) const;

  /// How far the silhouette of the model reaches over its surroundings. Depth is missing at most contours, but colours
  /// tell: the share of the points that the view should see which lie where it has no depth, and no colour like theirs.
  /// 0 if no view sees enough.
  [[nodiscard]] double silhouette_error(const Eigen::Array3f& white_balance) const;

 private:
  void add_unmeasured(const PreparedModel& model, const SceneAssociation& association, const DepthView& view,
                      std::span<const Evidence> evidence);

  const VerifyOptions& options_;
  std::vector<Eigen::Vector3f> points_;
  ColorPairs colors_;  // One pair per point.
  PhotometricFit light_;
  ColorPairs unmeasured_;      // Of the model alone, where the view has no depth.
  std::vector<Pixel> pixels_;  // Of the same points.
  const Image<Rgb8>* color_ = nullptr;
};

}  // namespace resight
