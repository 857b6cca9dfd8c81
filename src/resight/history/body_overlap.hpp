// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "resight/models/object_model.hpp"

namespace resight {

/// Share of the body of one object that lies in that of another, in [0, 1]: the share of points spread over `one` in
/// the bounding box of `other` (axes of its object frame). About 0 for objects that stand next to each other.
[[nodiscard]] double share_within(const ObjectModel& one, const Rigid3& world_from_one, const ObjectModel& other,
                                  const Rigid3& world_from_other);

/// Whether at least half of the body of `one` lies in `other`: both cannot be there.
[[nodiscard]] bool is_mostly_within(const ObjectModel& one, const Rigid3& world_from_one, const ObjectModel& other,
                                    const Rigid3& world_from_other);

/// Two detections of one kind whose centres are nearer than this may be one object with an inaccurate pose: for most
/// objects, the two bodies would overlap.
[[nodiscard]] double same_body_distance_m(const ObjectModel& model);

}  // namespace resight
