// SPDX-License-Identifier: Apache-2.0
#include "resight/annotation/change_proposals.hpp"

#include <utility>

namespace resight {
namespace {

constexpr std::size_t kMaxKeptPoints = 400;

/// The pixels of a view that was reduced for the work, in the recorded image.
PixelRuns enlarge(const std::vector<int>& pixels, const Camera& reduced, int reduction, const Camera& recorded) {
  Image<std::uint8_t> mask(recorded.width, recorded.height);
  for (const int pixel : pixels)
    for (int v = 0; v < reduction; ++v)
      for (int u = 0; u < reduction; ++u)
        mask(reduction * (pixel % reduced.width) + u, reduction * (pixel / reduced.width) + v) = 1;
  return find_runs(mask);
}

ChangeProposal make_proposal(int view, const ChangeRegion& region) {
  ChangeProposal proposal{.view = view,
                          .kind = region.kind,
                          .points_in_world = {},
                          .num_points = static_cast<int>(region.surface_in_world.size()),
                          .box = region.box,
                          .pixels = {}};
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
    const Camera recorded = frame->camera;
    const ChangeResult changes = scene.add_view(prepare_view(*std::move(frame), options.prepare));
    const RgbdFrame& shown = scene.window().back().raw;
    for (const ChangeRegion& region : find_change_regions(shown, changes, options.changes.voxel_m)) {
      if (static_cast<int>(region.surface_in_world.size()) < min_points) continue;
      proposals.push_back(make_proposal(v, region));
      proposals.back().pixels =
          enlarge(region.pixels, shown.camera, find_reduction(recorded, options.prepare), recorded);
    }
    if (on_view) on_view(v);
  }
  return proposals;
}

}  // namespace resight
