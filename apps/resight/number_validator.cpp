// SPDX-License-Identifier: Apache-2.0
#include "number_validator.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <utility>

namespace resight::app {

CLI::Validator number_validator(std::function<bool(double)> is_allowed, std::string what, std::string shown) {
  return CLI::Validator(
      [is_allowed = std::move(is_allowed), what = std::move(what)](const std::string& text) {
        double value = 0;
        const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
        const bool is_number = code == std::errc() && end == text.data() + text.size() && std::isfinite(value);
        return is_number && is_allowed(value) ? std::string() : text + " is not " + what;
      },
      std::move(shown));
}

CLI::Validator positive_number() {
  return number_validator([](double value) { return value > 0; }, "a number above 0", "NUMBER > 0");
}

CLI::Validator number_up_to(double max) {
  return number_validator([max](double value) { return value >= 0 && value <= max; },
                          fmt::format("a number from 0 to {}", max), fmt::format("NUMBER in [0 - {}]", max));
}

}  // namespace resight::app
