// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>
#include <vector>

namespace resight {

/// Pairs rows with columns one to one: as many pairs as possible, and among those the cheapest sum (Hungarian method,
/// cubic in the larger side). `cost`: num_rows x num_columns, row by row, each finite and >= 0, or NaN = the two may
/// not be paired. Returns the column of each row, -1 = left alone.
[[nodiscard]] std::vector<int> assign_optimally(std::span<const double> cost, int num_rows, int num_columns);

}  // namespace resight
