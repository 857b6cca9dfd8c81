// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string_view>

namespace resight {

/// Throws std::invalid_argument with `message` unless `condition` holds. For mistakes of the caller.
void require(bool condition, std::string_view message);

/// Option checks. Each throws std::invalid_argument with "field = value (must be rule)". NaN fails every check.
void check_positive(std::string_view field, double value);
void check_not_negative(std::string_view field, double value);
void check_in_range(std::string_view field, double value, double min, double max);

}  // namespace resight
