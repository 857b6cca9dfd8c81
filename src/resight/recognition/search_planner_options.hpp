// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>

#include "resight/core/options.hpp"

namespace resight {

/// A surface, or a tracked object, that is nearer than in any search by this factor is searched again.
inline constexpr double kMaxDistanceRatio = 1.2;

/// Which views, and which places in them, are searched for objects.
struct SearchPlannerOptions {
  std::optional<double> max_new_share{};
  int full_interval = 10;
  std::optional<int> place_interval{};
  double min_explained_share = 0.9;
  void check() const { check_options("SearchPlannerOptions", *this); }
};

inline void declare(OptionVisitor& v, SearchPlannerOptions& o) {
  v.field("max_new_share", o.max_new_share, between(0, 1),
          "A view is not searched if at most this share of its surface is new, or was never searched from a similar "
          "viewpoint. off: every view is searched.",
          "paper, Sec. V");
  v.only_if(o.max_new_share.has_value(), "max_new_share", "a number", [&] {
    v.field("full_interval", o.full_interval, at_least(1), "At least one view in this many is searched.");
  });
  v.field("place_interval", o.place_interval, at_least(2),
          "The place of a tracked object is searched again this many views after its last search. off: in every view.",
          "ours");
  v.only_if(o.place_interval.has_value(), "place_interval", "a number", [&] {
    v.field("min_explained_share", o.min_explained_share, between(0, 1),
            "The place of a tracked object is also searched if the last view explained a smaller share of the object. "
            "0: only every place_interval views.");
  });
}

}  // namespace resight
