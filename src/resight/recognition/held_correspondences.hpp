// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <deque>
#include <map>
#include <span>
#include <vector>

#include "resight/hypotheses/hypothesis.hpp"

namespace resight {

/// The correspondences that the last searches for each known object found, while it stays where it is: they hold its
/// pose in the views in which it is not searched for. World frame. Memory grows with the number of objects only.
class HeldCorrespondences {
 public:
  /// Those of `max_searches` searches are kept of each object.
  explicit HeldCorrespondences(std::size_t max_searches) : max_searches_(max_searches) {}

  /// Those found by the search of a view (in ascending order) for the object of a track.
  void add(int track, int view, std::vector<Correspondence> found);
  /// Of the searches of views from `first_view` on, but before `end_view`; the newest last.
  [[nodiscard]] std::vector<Correspondence> of_views(int track, int first_view, int end_view) const;
  /// Forgets the tracks that are not among these.
  void keep_only(std::span<const int> tracks);

 private:
  struct Search {
    int view = -1;
    std::vector<Correspondence> found;
  };
  std::size_t max_searches_;
  std::map<int, std::deque<Search>> searches_;
};

}  // namespace resight
