// SPDX-License-Identifier: Apache-2.0
#include "resight/core/names.hpp"

#include <algorithm>
#include <string>

#include "resight/core/printable.hpp"

namespace resight {
namespace {

constexpr std::size_t kMaxNameBytes = 200;
constexpr std::size_t kShownBytes = 40;

}  // namespace

Result<void> check_object_name(std::string_view name) {
  if (name.empty()) return Error{"the name of an object is empty"};
  if (name.size() > kMaxNameBytes)
    return Error{"the name of an object has " + std::to_string(name.size()) + " bytes (at most " +
                 std::to_string(kMaxNameBytes) + ")"};
  const std::string shown = printable(name);
  if (shown != name || name.find_first_of("/\\") != name.npos || name == "." || name == "..")
    return Error{"the name of an object '" + shown.substr(0, kShownBytes) +
                 "' has control characters or slashes, or is '.' or '..'"};
  return {};
}

}  // namespace resight
