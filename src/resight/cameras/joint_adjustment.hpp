// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>
#include <vector>

#include "resight/cameras/object_places.hpp"

namespace resight {

struct AdjustJointlyOptions {
  SamePlaceOptions same_place;
  int min_observations = 2;  ///< Of an object, to have a say.
  double sigma_m = 0.004;    ///< Of a recognised pose.
  double sigma_rad = 0.035;
  PoseGraphOptions graph;
  void check() const;
};

/// An object that stood still while views of a part saw it.
struct StaticObject {
  int object = -1;  ///< Index into the ModelLibrary.
  int part = 0;
  Rigid3 world_from_object;  ///< In the frame of the part.
  std::vector<int> views;    ///< In which it was seen there.
};

struct JointAdjustment {
  CameraTrack track;
  std::vector<StaticObject> objects;
};

/// Adjusts the poses of cameras and of the objects that stand still before them together: a graph of the edges between
/// views and of one edge for each sight of an object, up to its symmetries. An object that moves stands still at each
/// of its places. The first view of each part stays. Throws std::invalid_argument as find_places().
[[nodiscard]] JointAdjustment adjust_jointly(CameraTrack track, std::span<const ObservedObject> observed,
                                             const ModelLibrary& library, const AdjustJointlyOptions& options = {});

}  // namespace resight
