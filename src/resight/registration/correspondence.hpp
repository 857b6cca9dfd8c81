// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>

#include "resight/features/feature_set.hpp"

namespace resight {

/// A model keypoint matched to a scene keypoint. The containing structure defines the frame of the scene side.
struct Correspondence {
  Eigen::Vector3f model_point;
  Eigen::Vector3f model_normal;
  Eigen::Vector3f scene_point;
  Eigen::Vector3f scene_normal;
  float distance_sq = 0;  ///< Squared L2 distance of the descriptors.
  FeatureType type = FeatureType::kSift;
  int model_feature = -1;  ///< Index into the object's FeatureSet of this type.
  int scene_feature = -1;  ///< Index into the view's FeatureSet of this type.
};

}  // namespace resight
