// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "resight/models/object_model.hpp"

namespace resight {

/// How much of the body of one object at its pose lies in that of another at its pose, in [0, 1]: of points spread over
/// the one, the share in the box around the other (axes of its object frame). Next to each other: about 0.
[[nodiscard]] double share_within(const ObjectModel& one, const Rigid3& world_from_one, const ObjectModel& other,
                                  const Rigid3& world_from_other);

/// Most of the body of the one lies in the other: both cannot be there.
[[nodiscard]] bool is_mostly_within(const ObjectModel& one, const Rigid3& world_from_one, const ObjectModel& other,
                                    const Rigid3& world_from_other);

/// Between the centres of one object at two poses in the same frame.
[[nodiscard]] double center_distance_m(const ObjectModel& model, const Rigid3& a, const Rigid3& b);

/// Two of one kind whose centres are nearer than this may be one that was seen otherwise: the bodies of most would
/// overlap.
[[nodiscard]] double same_body_distance_m(const ObjectModel& model);

}  // namespace resight
