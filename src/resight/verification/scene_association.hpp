// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "resight/appearance/appearance_match.hpp"
#include "resight/verification/local_scene.hpp"
#include "resight/verification/scene_preparation.hpp"
#include "resight/verification/verify_options.hpp"
#include "resight/verification/visibility.hpp"

namespace resight {

/// A scene point explains a model point only if their normals differ by less than this (60 deg).
inline constexpr double kMaxInlierAngle_rad = 1.0472;
/// Model points seen at a more grazing angle than this (V4R: 60 deg) count with a tenth: depth is worst there.
inline constexpr double kGrazingAngle_rad = 1.0472;
inline constexpr double kGrazingWeight = 0.1;

/// A visible model point and a scene point within the inlier distance.
struct PointMatch {
  int visible;  ///< Position in ModelVisibility::visible.
  int local;    ///< Index into the LocalScene.
  float distance_sq;
};

/// What views and scene show of a model at a pose: its visible points, their neighbours in the scene, and the
/// photometric fit. World frame.
class SceneAssociation {
 public:
  /// `allowed`: per view, non-zero = the object may be present there. Model, scene and options must outlive it.
  SceneAssociation(const PreparedModel& model, const Rigid3& world_from_object, const PreparedScene& scene,
                   std::span<const DepthView> views, std::span<const std::uint8_t> allowed,
                   const VerifyOptions& options);

  /// Agreement of the colours where model and scene meet: mean similarity per visible point plus pattern similarity.
  /// Assumes a neutral white balance, because that of the scene is not known yet.
  [[nodiscard]] double color_fit() const;
  /// Upper bound of the explained share, whatever the colours.
  [[nodiscard]] double supported_share() const;
  /// Cosine between the normals of a match; 1 where there are none.
  [[nodiscard]] float normal_dot(const PointMatch& match) const {
    return local_normals.empty()
               ? 1.0F
               : normals[static_cast<std::size_t>(visibility.visible[static_cast<std::size_t>(match.visible)])].dot(
                     local_normals[static_cast<std::size_t>(match.local)]);
  }

  Rigid3 world_from_object;
  std::vector<Eigen::Vector3f> points;   ///< Of the model.
  std::vector<Eigen::Vector3f> normals;  ///< Empty or as long as points.
  ModelVisibility visibility;
  float depth_noise_m = 0;                     ///< Of the depth in the farthest view that confirms the object.
  std::optional<LocalScene> local;             ///< The scene around it; none if nothing of it is visible.
  std::vector<Eigen::Vector3f> local_normals;  ///< Of its points; empty if model or scene has none.
  std::vector<LabColor> local_lab;             ///< Likewise.
  std::vector<PointMatch> matches;             ///< Matches of one visible point are contiguous.
  std::vector<PointMatch> nearest;             ///< Of each visible point that has one of similar normal.
  ColorPairs nearest_colors;                   ///< Of `nearest`; empty if model or scene has none.
  PhotometricFit light;                        ///< Fitted to the colours of this model alone.

 private:
  [[nodiscard]] float largest_depth_noise(std::span<const DepthView> views) const;
  void compare_with_scene();
  void find_matches();
  void fit_light_of_matches();

  const PreparedModel* model_;
  const PreparedScene* scene_;
  const VerifyOptions* options_;
};

/// The visible ones of at most 2,000 model points at this pose: enough to refine it.
[[nodiscard]] std::vector<int> find_roughly_visible(const PreparedModel& model, const Rigid3& world_from_object,
                                                    std::span<const DepthView> views,
                                                    std::span<const std::uint8_t> allowed,
                                                    const VerifyOptions& options);

}  // namespace resight
