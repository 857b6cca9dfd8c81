// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <utility>

#include "resight/changes/change_detector.hpp"
#include "resight/core/check.hpp"

namespace resight {

void RemovalHistory::add(int view_index, PointCloud removed_in_world) {
  require(entries_.empty() || entries_.back().view_index < view_index,
          "RemovalHistory::add: view_index (must be larger than the last one)");
  entries_.push_back({view_index, std::move(removed_in_world)});
}

PointCloud RemovalHistory::removed_after(int view_index) const {
  PointCloud all;
  for (const Entry& entry : entries_)
    if (entry.view_index > view_index) all.append(entry.removed_in_world);
  return all;
}

const PointCloud& RemovalHistory::removed_at(int view_index) const {
  static const PointCloud kNothing;
  const auto found = std::ranges::find(entries_, view_index, &Entry::view_index);
  return found == entries_.end() ? kNothing : found->removed_in_world;
}

void RemovalHistory::forget_before(int first_kept_view) {
  std::erase_if(entries_, [&](const Entry& entry) { return entry.view_index < first_kept_view; });
}

}  // namespace resight
