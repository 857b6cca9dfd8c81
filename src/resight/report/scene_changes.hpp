// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "resight/changes/change_regions.hpp"

namespace resight {

/// What changed in a view, without knowledge of objects.
struct ViewChangeRecord {
  std::string view_name;
  int image_width_px = 0;    ///< Of the view in which the regions were found.
  int reduction = 1;         ///< This many pixels of the recorded image are one of that view, in each direction.
  Rigid3 world_from_camera;  ///< Corrected.
  double changed_share = 0;
  bool pose_suspect = false;
  std::vector<ChangeRegion> regions;
};

struct SceneChanges {
  std::string version;
  std::string preset;
  std::string sequence;
  std::vector<ViewChangeRecord> views;
};

/// Formats the changes of a sequence as JSON (docs/formats.md). Regions are numbered from 1 in the order of the views.
[[nodiscard]] std::string format_scene_changes_json(const SceneChanges& changes);

}  // namespace resight
