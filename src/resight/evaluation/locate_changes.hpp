// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>
#include <vector>

#include "resight/evaluation/change_truth.hpp"

namespace resight {

/// Takes the missing poses of changes from the ground truth. Before the change: the pose of the object in the last view
/// that has it. After: its pose in the first view that has it, from the change on. Views beyond another change of an
/// object of this name do not count. If a view has several objects of this name, the one whose place the other view
/// lacks has changed.
///
/// Fails, naming the change, unless exactly one place remains, and for an object that is neither in the library nor in
/// the ground truth. Leaves out changes without poses of objects that are in the ground truth alone.
[[nodiscard]] Result<void> locate_changes(std::span<const TruthView> views, const ModelLibrary& library,
                                          std::vector<TrueChange>& changes);

}  // namespace resight
