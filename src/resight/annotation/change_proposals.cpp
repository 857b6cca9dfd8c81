// SPDX-License-Identifier: Apache-2.0
#include "resight/annotation/change_proposals.hpp"

#include <utility>

namespace resight {
namespace {

constexpr std::size_t kMaxKeptPoints = 400;

ChangeProposal make_proposal(int view, const ChangeRegion& region) {
  ChangeProposal proposal{.view = view,
                          .kind = region.kind,
                          .points_in_world = {},
                          .num_points = static_cast<int>(region.surface_in_world.size()),
                          .box = region.box};
  const auto& points = region.surface_in_world.points;
  const std::size_t step = (points.size() + kMaxKeptPoints - 1) / kMaxKeptPoints;
  for (std::size_t i = 0; i < points.size(); i += step) proposal.points_in_world.push_back(points[i]);
  return proposal;
}

}  // namespace

Result<std::vector<ChangeProposal>> propose_changes(const Sequence& sequence, const DynamicSceneOptions& options,
                                                    int min_points, const std::function<void(int)>& on_view) {
  DynamicScene scene(options);
  std::vector<ChangeProposal> proposals;
  for (int v = 0; v < sequence.num_views(); ++v) {
    auto frame = sequence.read_view(v);
    if (!frame) return frame.error();
    const ChangeResult changes = scene.add_view(prepare_view(*std::move(frame), options.prepare));
    for (const ChangeRegion& region : find_change_regions(scene.window().back().raw, changes, options.changes.voxel_m))
      if (static_cast<int>(region.surface_in_world.size()) >= min_points) proposals.push_back(make_proposal(v, region));
    if (on_view) on_view(v);
  }
  return proposals;
}

}  // namespace resight
