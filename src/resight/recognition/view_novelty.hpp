// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <deque>

#include "resight/changes/change_detector.hpp"
#include "resight/recognition/search_planner_options.hpp"
#include "resight/sensor/prepared_view.hpp"

namespace resight {

/// Decides which views show enough new surface to be searched for objects (paper, Sec. V: attention).
class ViewNovelty {
 public:
  /// Throws std::invalid_argument for options that fail check().
  explicit ViewNovelty(const SearchPlannerOptions& options);

  /// Whether to search this view; remembers the views that are searched. `changes`: of the same view.
  [[nodiscard]] bool needs_search(const PreparedView& view, const ChangeResult& changes);
  /// The next view is searched in any case.
  void request_search() { views_since_search_ = -1; }
  /// The search of the last view was incomplete: what it shows has not been searched, and the next view is searched.
  void forget_last_search();

 private:
  struct SearchedView {
    Camera camera;
    Rigid3 world_from_camera;
    Image<float> depth_m;
  };
  [[nodiscard]] bool shows_something_new(const PreparedView& view, const ChangeResult& changes) const;
  [[nodiscard]] bool was_searched(const Eigen::Vector3f& p_in_world, const Eigen::Vector3f& eye_in_world) const;

  SearchPlannerOptions options_;
  std::deque<SearchedView> searched_;  // The last few.
  int views_since_search_ = -1;        // -1: search the next view.
};

}  // namespace resight
