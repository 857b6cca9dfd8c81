// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace resight {

/// Which views, and which places in them, are searched for objects.
struct SearchPlannerOptions {
  /// A view is not searched if at most this share of its surface is new, or was never searched from a similar
  /// viewpoint; 0 = every view is searched.
  double max_new_share = 0;
  int full_interval = 10;           ///< At least one view in this many is searched.
  double max_turn_rad = 0.26;       ///< A surface seen from a direction that differs more is searched again,
  double max_distance_ratio = 1.2;  ///< and so is one seen from a distance smaller by this factor.
  double max_depth_m = 2.0;         ///< Surfaces farther away do not count.
  /// The place of a tracked object is searched again this many views after its last search; 0 or 1 = in every view.
  int place_interval = 0;
  int place_min_views = 2;  ///< A place is searched in this many views after the object was first recognised there.
  double min_explained_share =
      0.9;             ///< A place is searched if the last view explained less of what it saw of the object.
  void check() const;  ///< Throws std::invalid_argument: field, value, rule.
};

}  // namespace resight
