// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <array>
#include <cstddef>

namespace resight::inspection {

/// Standard errors by which an estimate must differ: four, and more for few values, whose standard errors are uncertain
/// themselves (Student's distribution: exceeded as rarely as three standard deviations of a normal one).
[[nodiscard]] inline double sure_errors(std::size_t num_values, std::size_t num_parameters) {
  constexpr std::array<double, 9> kOfFew{236, 19.2, 9.22, 6.62, 5.51, 4.90, 4.53, 4.28, 4.09};
  const std::size_t freedom = std::max(num_values, num_parameters + 1) - num_parameters;
  return freedom <= kOfFew.size() ? kOfFew[freedom - 1] : 4;
}

}  // namespace resight::inspection
