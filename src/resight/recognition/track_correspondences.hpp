// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <deque>
#include <map>
#include <span>
#include <vector>

#include "resight/geometry/symmetry.hpp"
#include "resight/hypotheses/hypothesis.hpp"

namespace resight {

/// The correspondences that the last searches for each known object found, while it stays where it is: they hold its
/// pose in the views in which it is not searched for. World frame. Memory grows with the number of objects only.
class TrackCorrespondences {
 public:
  /// Those of `max_searches` searches are kept of each object; those farther than `max_distance_m` from where its pose
  /// has them are not.
  TrackCorrespondences(std::size_t max_searches, double max_distance_m)
      : max_searches_(max_searches), max_distance_m_(max_distance_m) {}

  /// What the search of a view (ascending) found for the object of a track, which was recognised at
  /// `world_from_object`: the hypotheses may be at poses that its symmetries make the same.
  void add(int track, int view, std::span<const Hypothesis> found, const Rigid3& world_from_object,
           const ObjectSymmetries& symmetries);
  /// Of the searches of views from `first_view` on, but before `end_view`, those that agree with the pose; the newest
  /// last.
  [[nodiscard]] std::vector<Correspondence> of_views(int track, int first_view, int end_view,
                                                     const Rigid3& world_from_object) const;
  /// Forgets the tracks that are not among these.
  void keep_only(std::span<const int> tracks);

 private:
  struct Search {
    int view = -1;
    std::vector<Correspondence> found;
  };
  [[nodiscard]] bool agrees(const Correspondence& correspondence, const Rigid3& world_from_object) const;

  std::size_t max_searches_;
  double max_distance_m_;
  std::map<int, std::deque<Search>> searches_;
};

}  // namespace resight
