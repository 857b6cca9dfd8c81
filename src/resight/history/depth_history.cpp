// SPDX-License-Identifier: Apache-2.0
#include "resight/history/depth_history.hpp"

#include "resight/core/check.hpp"

namespace resight {
namespace {

// Pixel (u, v) of the result is pixel (u, v) * step of the view: no mean over a depth edge.
RgbdFrame downsample(const RgbdFrame& frame, int step_px) {
  const Camera& whole = frame.camera;
  RgbdFrame small;
  small.world_from_camera = frame.world_from_camera;
  small.camera = {(whole.width + step_px - 1) / step_px,
                  (whole.height + step_px - 1) / step_px,
                  whole.fx / step_px,
                  whole.fy / step_px,
                  whole.cx / step_px,
                  whole.cy / step_px,
                  whole.noise};
  small.depth_m = Image<float>(small.camera.width, small.camera.height);
  for (int v = 0; v < small.camera.height; ++v)
    for (int u = 0; u < small.camera.width; ++u) small.depth_m(u, v) = frame.depth_m(u * step_px, v * step_px);
  return small;
}

}  // namespace

DepthHistory::DepthHistory(DepthHistoryOptions options, int step_px) : options_(options), step_px_(step_px) {
  options_.check();
  check_positive("step_px", step_px);
}

void DepthHistory::add(int view, const RgbdFrame& frame) {
  views_.push_back({view, downsample(frame, step_px_)});
  while (views_.size() > static_cast<std::size_t>(options_.max_views)) views_.pop_front();
}

std::optional<int> DepthHistory::last_seen_free(const PointCloud& surface_in_object, const Rigid3& world_from_object,
                                                const PresenceOptions& presence) const {
  for (auto view = views_.rbegin(); view != views_.rend(); ++view)
    if (assess_presence(surface_in_object, world_from_object, view->frame, presence).is_gone) return view->number;
  return std::nullopt;
}

}  // namespace resight
