// SPDX-License-Identifier: Apache-2.0
#include "resight/cameras/plausibility.hpp"

#include "resight/core/check.hpp"

namespace resight {

void PlausibilityOptions::check() const {
  check_in_range("PlausibilityOptions.min_overlap", min_overlap, 0, 1);
  check_in_range("PlausibilityOptions.max_seen_through", max_seen_through, 0, 1);
  check_in_range("PlausibilityOptions.min_correlation", min_correlation, -1, 1);
}

}  // namespace resight
