// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <CLI/CLI.hpp>
#include <functional>
#include <string>

namespace resight::app {

/// Takes a number for which `is_allowed` holds, and nothing behind it. CLI11 itself takes nan to be in every range.
/// `what` ends the message, such as "a number above 0"; `shown` stands in the help.
[[nodiscard]] CLI::Validator number_validator(std::function<bool(double)> is_allowed, std::string what,
                                              std::string shown);
[[nodiscard]] CLI::Validator positive_number();
/// From 0 to `max`.
[[nodiscard]] CLI::Validator number_up_to(double max);

}  // namespace resight::app
