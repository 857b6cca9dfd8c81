// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <deque>

#include "resight/changes/change_detector.hpp"
#include "resight/sensor/prepared_view.hpp"

namespace resight {

struct AttentionOptions {
  double max_unseen_share = 0;      ///< A view is not searched if no more of its surface than this is new, or was never
                                    ///< searched as it is seen now; 0 = every view is searched.
  int full_look_every = 10;         ///< But of so many views at least one is.
  double max_turn_rad = 0.26;       ///< Seen from farther aside than this, a surface is worth another search...
  double max_distance_ratio = 1.2;  ///< ...as it is from so much nearer; and so is a known object.
  double max_depth_m = 2.0;         ///< Surfaces farther away do not count.
  int object_look_every = 0;    ///< What is known, and seen where it was, is searched for again when so many views have
                                ///< passed since it was last; 0 or 1 = in each.
  int object_min_views = 2;     ///< But in each of so many views from the first at its place on...
  double min_sure_share = 0.9;  ///< ...and if the last view did not explain so much of what it saw of it.
  void check() const;
};

/// Decides which views are searched for objects (paper, Sec. V: attention). In a view that shows nothing new, what is
/// known needs only to be confirmed.
class ViewNovelty {
 public:
  /// Throws std::invalid_argument for options that fail check().
  explicit ViewNovelty(const AttentionOptions& options);

  /// Whether to search this view; remembers what was searched. `changes`: of the same view.
  [[nodiscard]] bool needs_search(const PreparedView& view, const ChangeResult& changes);
  /// The next view is searched in any case.
  void request_search() { views_since_look_ = -1; }

 private:
  struct Look {
    Camera camera;
    Rigid3 world_from_camera;
    Image<float> depth_m;
  };
  [[nodiscard]] bool shows_something_new(const PreparedView& view, const ChangeResult& changes) const;
  [[nodiscard]] bool was_searched(const Eigen::Vector3f& p_in_world, const Eigen::Vector3f& eye_in_world) const;

  AttentionOptions options_;
  std::deque<Look> looks_;     // The last few.
  int views_since_look_ = -1;  // -1: look now.
};

}  // namespace resight
