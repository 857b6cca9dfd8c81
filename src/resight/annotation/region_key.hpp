// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <tuple>

#include "resight/changes/change_regions.hpp"

namespace resight {

/// What a decision says of the region that it is about. Regions have no number of their own: another version of the
/// change detector may propose more or fewer of them.
struct RegionKey {
  int view = 0;
  RegionKind kind = RegionKind::kNovel;
  Eigen::Vector3d center_in_world_m = Eigen::Vector3d::Zero();  ///< Of its box.

  friend bool operator<(const RegionKey& a, const RegionKey& b) {
    const auto order = [](const RegionKey& key) {
      const Eigen::Vector3d& c = key.center_in_world_m;
      return std::tuple(key.view, key.kind, c.x(), c.y(), c.z());
    };
    return order(a) < order(b);
  }
};

}  // namespace resight
