// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <vector>

#include "resight/geometry/rigid3.hpp"
#include "resight/registration/correspondence.hpp"

namespace resight {

/// An object at a pose, with its supporting correspondences. In the WORLD frame, so that it is valid in every view.
struct Hypothesis {
  std::uint64_t id = 0;  ///< Unique within a run; smaller = earlier.
  int object = -1;       ///< Index into ModelLibrary::objects.
  Rigid3 world_from_object;
  /// View in which it was generated; for a cluster, the newest one.
  int origin_view = -1;
  std::vector<Correspondence> correspondences;  ///< Scene side in the world frame.
  /// All contributing views, ascending; {origin_view} unless clustered.
  std::vector<int> origin_views;
};

}  // namespace resight
