// SPDX-License-Identifier: Apache-2.0
#include "resight/report/scene_changes.hpp"

#include <algorithm>

#include "resight/report/internal/json_values.hpp"

namespace resight {
namespace {

using nlohmann::ordered_json;
using report::pose_json;

// Left, top, width and height of the pixels, in the recorded image; null if the view shows none.
ordered_json rectangle_json(const std::vector<int>& pixels, const ViewChangeRecord& view) {
  const int image_width_px = view.image_width_px;
  if (pixels.empty()) return nullptr;
  int left = image_width_px;
  int right = 0;
  for (const int pixel : pixels) {
    left = std::min(left, pixel % image_width_px);
    right = std::max(right, pixel % image_width_px);
  }
  const int top = pixels.front() / image_width_px;
  const int bottom = pixels.back() / image_width_px;
  const int scale = view.reduction;
  return {scale * left, scale * top, scale * (right - left + 1), scale * (bottom - top + 1)};
}

ordered_json region_json(const ChangeRegion& region, int id, const ViewChangeRecord& view) {
  const Eigen::Vector3d& size_m = region.box.size_m;
  return {{"id", id},
          {"kind", to_string(region.kind)},
          {"points", region.surface_in_world.size()},
          {"pixels", static_cast<std::size_t>(view.reduction * view.reduction) * region.pixels.size()},
          {"rectangle_px", rectangle_json(region.pixels, view)},
          {"world_from_box", pose_json(region.box.world_from_box)},
          {"box_size_m", {size_m.x(), size_m.y(), size_m.z()}}};
}

}  // namespace

std::string format_scene_changes_json(const SceneChanges& changes) {
  int num_regions = 0;
  ordered_json views = ordered_json::array();
  for (const ViewChangeRecord& view : changes.views) {
    ordered_json regions = ordered_json::array();
    for (const ChangeRegion& region : view.regions) regions.push_back(region_json(region, ++num_regions, view));
    views.push_back({{"view", views.size()},
                     {"name", view.view_name},
                     {"world_from_camera", pose_json(view.world_from_camera)},
                     {"changed_share", view.changed_share},
                     {"pose_suspect", view.pose_suspect},
                     {"regions", regions}});
  }
  const ordered_json json = {
      {"version", changes.version}, {"preset", changes.preset}, {"sequence", changes.sequence}, {"views", views}};
  return report::to_text(json);
}

}  // namespace resight
