// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "resight/io/trace_file.hpp"
#include "resight/viewer/internal/sequence_numbers.hpp"
#include "resight/viewer/object_table.hpp"

namespace resight::viewer {

/// The trace of a view for the page. Objects are numbers of the table; -1: unknown. Poses are 4x4 matrices, column by
/// column; the pose of a hypothesis is the refined one, if it was verified. `numbers`: of the views of the run.
[[nodiscard]] std::string format_trace(const StoredTrace& trace, const ObjectTable& objects,
                                       const SequenceNumbers& numbers);

}  // namespace resight::viewer
