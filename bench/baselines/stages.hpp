// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "stage_input.hpp"

/// A stage each: ours and its peers on the same input, one thread; prints the rows of the table.
namespace resight::bench {

void compare_sampling(const StageInput& input);
void compare_normals(const StageInput& input);
void compare_shot(const StageInput& input);
void compare_differences(const StageInput& input);
/// The following need a library.
void compare_matching(const StageInput& input);
void compare_grouping(const StageInput& input);
void compare_verification(const StageInput& input);
/// Needs the truth of the objects, too.
void compare_refinement(const StageInput& input);

}  // namespace resight::bench
