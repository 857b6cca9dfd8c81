// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <variant>

#include "resight/core/options.hpp"

namespace resight {

/// Free space at a model point rejects it if the newest view that observes it sees through it: things come and go.
struct NewestViewFreeSpace {};

inline void declare(OptionVisitor& /*v*/, NewestViewFreeSpace& /*o*/) {}

/// Free space at a model point rejects it if more than this share of the views that observe it see through it.
struct MajorityFreeSpace {
  double max_share = 0.5;
};

inline void declare(OptionVisitor& v, MajorityFreeSpace& o) {
  v.field(
      "max_share", o.max_share, between(0, 1),
      "A model point that a larger share of its views sees through is an outlier, whatever the reconstruction says. "
      "1: never.",
      "ours; V4R has no such test");
}

/// What the views say of the points of a model.
struct VisibilityOptions {
  double margin_m = 0.02;
  double min_edge_distance_px = 0;
  std::variant<MajorityFreeSpace, NewestViewFreeSpace> free_space{};
};

inline void declare(OptionVisitor& v, VisibilityOptions& o) {
  v.field("margin_m", o.margin_m, at_least(0),
          "A model point farther than the measured depth by more than this is hidden; nearer by more, it is seen "
          "through.");
  v.field("min_edge_distance_px", o.min_edge_distance_px, at_least(0),
          "Pixels nearer to a depth edge count as unobserved: the reconstruction has no points there (integrate."
          "min_edge_distance_px), and the model at a slightly wrong pose projects beside the object. 0: none does.",
          "ours");
  v.choice("free_space", o.free_space,
           {{"majority", "most of the views that observe the point"},
            {"newest_view", "the newest view that observes the point, whatever older ones saw"}},
           "Which views decide that a model point is seen through.");
}

}  // namespace resight
