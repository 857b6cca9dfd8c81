// SPDX-License-Identifier: Apache-2.0
#include "resight/core/check.hpp"

#include <sstream>
#include <stdexcept>
#include <string>

namespace resight {
namespace {

[[noreturn]] void fail(std::string_view field, double value, const std::string& rule) {
  std::ostringstream text;
  text << field << " = " << value << " (must be " << rule << ")";
  throw std::invalid_argument(text.str());
}

}  // namespace

void require(bool condition, std::string_view message) {
  if (!condition) throw std::invalid_argument(std::string(message));
}

void check_positive(std::string_view field, double value) {
  if (!(value > 0)) fail(field, value, "> 0");
}

void check_not_negative(std::string_view field, double value) {
  if (!(value >= 0)) fail(field, value, ">= 0");
}

void check_in_range(std::string_view field, double value, double min, double max) {
  if (value >= min && value <= max) return;
  std::ostringstream rule;
  rule << "in [" << min << ", " << max << "]";
  fail(field, value, rule.str());
}

}  // namespace resight
