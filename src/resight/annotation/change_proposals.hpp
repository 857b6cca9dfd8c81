// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <vector>

#include "resight/annotation/pixel_runs.hpp"
#include "resight/annotation/region_key.hpp"
#include "resight/reconstruction/dynamic_scene.hpp"
#include "resight/sensor/sequence.hpp"

namespace resight {

/// A region that came or left, as the change detector sees it.
struct ChangeProposal {
  int view = 0;
  RegionKind kind = RegionKind::kNovel;
  std::vector<Eigen::Vector3f> points_in_world;  ///< At most 400 of them, evenly.
  int num_points = 0;                            ///< Before that.
  OrientedBox box;
  PixelRuns pixels;  ///< Of the recorded image: those that show the region, or see through it.
  [[nodiscard]] RegionKey key() const {
    return {.view = view, .kind = kind, .center_in_world_m = box.world_from_box.translation};
  }
};

/// Compares each view with those before it and returns all regions of at least `min_points` points, in the order of the
/// views. Calls `on_view` after each view. Fails if a view cannot be read.
[[nodiscard]] Result<std::vector<ChangeProposal>> propose_changes(const Sequence& sequence,
                                                                  const DynamicSceneOptions& options, int min_points,
                                                                  const std::function<void(int)>& on_view = {});

}  // namespace resight
