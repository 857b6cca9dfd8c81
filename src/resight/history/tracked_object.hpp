// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "resight/geometry/rigid3.hpp"

namespace resight {

/// An object that no view has seen leave its place. Views are numbers in the sequence.
struct TrackedObject {
  int track = -1;   ///< Number in the history.
  int object = -1;  ///< Index into the ModelLibrary.
  Rigid3 world_from_object;
  int last_view = -1;        ///< Last view in whose window it was recognised.
  int seen_view = -1;        ///< Last view that recognised it and confirmed it itself.
  int since_view = -1;       ///< First view that recognised it at its place.
  bool is_confirmed = true;  ///< False: a tentative track (TentativeTracks).
};

}  // namespace resight
