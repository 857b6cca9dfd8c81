// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <vector>

#include "resight/features/feature_set.hpp"
#include "resight/geometry/rigid3.hpp"

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

/// "Object o is at this pose", with what speaks for it. In the WORLD frame, so that a change of view needs no transfer.
struct Hypothesis {
  std::uint64_t id = 0;  ///< Unique in a run; smaller = earlier.
  int object = -1;       ///< Index into ModelLibrary::objects.
  Rigid3 world_from_object;
  int origin_view = -1;                         ///< View that it was generated from (of a cluster: the newest).
  std::vector<Correspondence> correspondences;  ///< Scene side in the world frame.
  std::vector<int> origin_views;  ///< Of a cluster: all views that contributed, ascending; else {origin_view}.
};

}  // namespace resight
