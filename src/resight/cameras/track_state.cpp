// SPDX-License-Identifier: Apache-2.0
#include "resight/cameras/internal/track_state.hpp"

#include <algorithm>
#include <utility>

namespace resight {

std::vector<std::size_t> TrackState::nearest_keyframes(int component, const Rigid3& pose, int count) const {
  std::vector<std::pair<double, std::size_t>> order;
  for (std::size_t k = 0; k < keyframes.size(); ++k)
    if (component_of(keyframes[k]) == component) order.emplace_back(viewpoint_distance(pose_of(keyframes[k]), pose), k);
  std::ranges::sort(order);
  order.resize(std::min(order.size(), static_cast<std::size_t>(count)));
  std::vector<std::size_t> nearest;
  for (const auto& [distance, k] : order) nearest.push_back(k);
  return nearest;
}

}  // namespace resight
