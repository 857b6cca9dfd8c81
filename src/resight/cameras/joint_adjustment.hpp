// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>
#include <vector>

#include "resight/cameras/pose_graph.hpp"
#include "resight/cameras/view_tracker.hpp"
#include "resight/geometry/rigid3.hpp"
#include "resight/models/object_model.hpp"
#include "resight/models/observed_object.hpp"
#include "resight/models/pose_distance.hpp"

namespace resight {

struct AdjustJointlyOptions {
  SamePlaceOptions same_place;
  int min_observations = 2;  ///< Of an object, to have a say.
  double sigma_m = 0.004;    ///< Of a recognised pose.
  double sigma_rad = 0.035;
  PoseGraphOptions graph;
  void check() const;
};

/// An object that did not move while views of a component observed it.
struct StaticObject {
  int object = -1;  ///< Index into the ModelLibrary.
  /// Connected component of the track.
  int component = 0;
  Rigid3 world_from_object;  ///< In the frame of the component.
  std::vector<int> views;    ///< Views that observed it at this pose.
};

/// Adjusted track and the objects that were adjusted with it.
struct JointAdjustment {
  CameraTrack track;
  std::vector<StaticObject> objects;
};

/// Adjusts the poses of the cameras and of static objects jointly. The pose graph has the edges between views and one
/// edge per observation of an object, up to its symmetries. An object that moves counts as one static object per place.
/// The first view of each component keeps its pose. Throws std::invalid_argument like find_places().
[[nodiscard]] JointAdjustment adjust_jointly(CameraTrack track, std::span<const ObservedObject> observed,
                                             const ModelLibrary& library, const AdjustJointlyOptions& options = {});

}  // namespace resight
