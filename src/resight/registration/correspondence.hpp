// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>

#include "resight/features/feature_set.hpp"

namespace resight {

/// A model keypoint taken for a scene keypoint. The scene side is in the frame that the holder says.
struct Correspondence {
  Eigen::Vector3f model_point;
  Eigen::Vector3f model_normal;
  Eigen::Vector3f scene_point;
  Eigen::Vector3f scene_normal;
  float distance_sq = 0;  ///< Between the descriptors, squared L2.
  FeatureType type = FeatureType::kSift;
  int model_feature = -1;  ///< Index into the object's FeatureSet of this type.
  int scene_feature = -1;  ///< Index into the view's FeatureSet of this type.
};

}  // namespace resight
