// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>
#include <vector>

namespace resight {

/// Assigns rows to columns one to one: as many pairs as possible and, among those, the smallest sum of costs (Hungarian
/// method; time: smaller side squared times larger side; memory: their sum). `cost`: num_rows x num_columns, row by
/// row; each finite and >= 0, or NaN = forbidden. Returns the column of each row, or -1. Throws std::invalid_argument
/// for other costs or a wrong number of them.
[[nodiscard]] std::vector<int> assign_optimally(std::span<const double> cost, int num_rows, int num_columns);

}  // namespace resight
