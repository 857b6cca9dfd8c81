// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <vector>

#include "resight/geometry/rigid3.hpp"
#include "resight/registration/correspondence.hpp"

namespace resight {

/// "Object o is at this pose", with what speaks for it. In the WORLD frame, so that a change of view needs no transfer.
struct Hypothesis {
  std::uint64_t id = 0;  ///< Unique in a run; smaller = earlier.
  int object = -1;       ///< Index into ModelLibrary::objects.
  Rigid3 world_from_object;
  int origin_view = -1;                         ///< View that it was generated from (of a cluster: the newest).
  std::vector<Correspondence> correspondences;  ///< Scene side in the world frame.
  std::vector<int> origin_views;  ///< Of a cluster: all views that contributed, ascending; else {origin_view}.
};

}  // namespace resight
