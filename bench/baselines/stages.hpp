// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "stage_input.hpp"

/// One function per stage: runs our implementation and its peers on the same input with one thread, and prints the rows
/// of the table.
namespace resight::bench {

void compare_sampling(const StageInput& input);
void compare_normals(const StageInput& input);
void compare_shot(const StageInput& input);
void compare_differences(const StageInput& input);
/// The following functions need a library.
void compare_matching(const StageInput& input);
void compare_grouping(const StageInput& input);
void compare_verification(const StageInput& input);
/// Also needs ground truth of the objects.
void compare_refinement(const StageInput& input);

}  // namespace resight::bench
