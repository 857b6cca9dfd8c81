// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <deque>
#include <map>
#include <span>
#include <vector>

#include "resight/geometry/symmetry.hpp"
#include "resight/hypotheses/hypothesis.hpp"

namespace resight {

/// The correspondences that the last searches found for each tracked object at its place: they hold its pose in views
/// that do not search this place. World frame. Memory grows with the number of objects only.
class TrackCorrespondences {
 public:
  /// Keeps the correspondences of the last `max_searches` searches per object, without those whose scene point is
  /// farther than `max_distance_m` from the model point at the object's pose.
  TrackCorrespondences(std::size_t max_searches, double max_distance_m)
      : max_searches_(max_searches), max_distance_m_(max_distance_m) {}

  /// Adds what the search of a view (ascending) found for a track, recognised at `world_from_object`. The hypotheses
  /// may be at poses that are equivalent by symmetry.
  void add(int track, int view, std::span<const Hypothesis> found, const Rigid3& world_from_object,
           const ObjectSymmetries& symmetries);
  /// The correspondences of views in [first_view, end_view) that agree with the pose; the newest last.
  [[nodiscard]] std::vector<Correspondence> of_views(int track, int first_view, int end_view,
                                                     const Rigid3& world_from_object) const;
  void forget(int track) { searches_.erase(track); }
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
