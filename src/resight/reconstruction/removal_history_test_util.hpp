// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <utility>
#include <vector>

#include "resight/geometry/point_cloud.hpp"

namespace resight {

/// What each view found removed, for a reference implementation of Algorithm 1 that starts from the raw views each
/// time. A removal clears only views taken before it, so that an object put back at its old place survives.
class RemovalHistory {
 public:
  void add(int view, PointCloud removed_in_world) { entries_.emplace_back(view, std::move(removed_in_world)); }
  /// Union of what was removed in views later than `view`.
  [[nodiscard]] PointCloud removed_after(int view) const {
    PointCloud all;
    for (const auto& [number, removed_in_world] : entries_)
      if (number > view) all.append(removed_in_world);
    return all;
  }

 private:
  std::vector<std::pair<int, PointCloud>> entries_;
};

}  // namespace resight
