// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "class_truth.hpp"

namespace resight::bench {

/// A number of things out of a total.
struct Count {
  std::int64_t num = 0;
  std::int64_t total = 0;
  void add(bool counts) { num += counts ? 1 : 0, ++total; }
  /// NaN of nothing.
  [[nodiscard]] double share() const {
    return total > 0 ? static_cast<double>(num) / static_cast<double>(total) : std::numeric_limits<double>::quiet_NaN();
  }
};

/// Of the added or of the removed.
struct SideScore {
  Count precision;         ///< Reported pixels that are right.
  Count recall;            ///< True pixels that are reported.
  Count thin;              ///< Objects of 5 to 20 mm height of which enough is reported.
  Count tall;              ///< Higher objects.
  Count region_precision;  ///< Reported regions that are mostly right.
  Count region_recall;     ///< True regions that one reported region covers for the most part.
};

struct ChangeScore {
  std::array<SideScore, 2> sides;  ///< By Side.
  Count unchanged;                 ///< Unchanged objects that are called changed.
  Count false_in_class;            ///< False pixels, of both sides, that lie in ChangeTruth::same_class.
};

/// What a method reports between two views.
struct ReportedChanges {
  std::array<Mask, 2> masks;          ///< By Side, both in the pixels of the still camera.
  std::array<Components, 2> regions;  ///< By Side: pixels of the masks that belong together.
};

/// A miss, or a false report.
struct Mistake {
  bool is_false = false;
  Side side = kAdded;
  Region pixels;
  std::string text;
};

/// Adds to the score what was reported between two views, and to `mistakes`, unless null, what is wrong.
void score_changes(const ChangeTruth& truth, const ReportedChanges& reported, ChangeScore& score,
                   std::vector<Mistake>* mistakes);

}  // namespace resight::bench
