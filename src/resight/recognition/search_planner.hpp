// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <map>
#include <set>
#include <span>
#include <vector>

#include "resight/changes/change_detector.hpp"
#include "resight/core/image.hpp"
#include "resight/evidence/object_presence.hpp"
#include "resight/history/tracked_object.hpp"
#include "resight/hypotheses/hypothesis.hpp"
#include "resight/models/object_model.hpp"
#include "resight/recognition/hypothesis_pool.hpp"
#include "resight/recognition/scene_update.hpp"
#include "resight/recognition/search_planner_options.hpp"
#include "resight/recognition/track_correspondences.hpp"
#include "resight/recognition/view_novelty.hpp"
#include "resight/sensor/prepared_view.hpp"

namespace resight {

/// Decides which views, and which places in them, are searched (paper, Sec. V). A tracked object at its place needs
/// only be verified: the correspondences of its last searches hold its pose. Views are given in order, by their
/// numbers.
class SearchPlanner {
 public:
  /// `library` must outlive it. `presence`: decides which tracked objects a view shows at their places.
  /// `correspondences`: its limits apply to those that are held.
  SearchPlanner(const ModelLibrary& library, const SearchPlannerOptions& options, const PresenceOptions& presence,
                TrackCorrespondences correspondences);

  /// Call first for each view. `outdated`: by tracked object, whether its place has changed since it was seen there, as
  /// find_outdated() tells; empty = none. The view is searched for these objects, and the correspondences
  /// that held them are forgotten.
  void set_outdated(std::span<const TrackedObject> tracked, std::span<const std::uint8_t> outdated);
  /// Whether to search this view. `changes`: of the same view.
  [[nodiscard]] bool needs_search(const PreparedView& view, const ChangeResult& changes) {
    return novelty_.needs_search(view, changes);
  }
  /// Whether places of tracked objects are skipped in views that are searched.
  [[nodiscard]] bool skips_places() const { return options_.place_interval.has_value(); }
  /// Where not to search a view: non-zero where a tracked object that needs no search explains the pixel. Empty if no
  /// places are skipped. Remembers which places are searched.
  [[nodiscard]] Image<std::uint8_t> find_skipped_pixels(int number, const RgbdFrame& frame,
                                                        std::span<const TrackedObject> tracked);
  /// Tracked objects as hypotheses, with the correspondences of their last searches before the view `window_begin`.
  /// World frame; ids are left to HypothesisPool::merge().
  [[nodiscard]] std::vector<Hypothesis> tracked_hypotheses(std::span<const TrackedObject> tracked,
                                                           int window_begin) const;

  /// Records what the search of a view found. `tracked`: the objects that are tracked now.
  void record(int number, std::span<const Detection> detections, std::span<const TrackedObject> tracked,
              const HypothesisPool& pool);
  /// The next view is searched in any case.
  void request_search() { novelty_.request_search(); }
  /// The search of this view was incomplete: the next view is searched everywhere.
  void request_full_search();

 private:
  struct PlaceSearch {
    int view = -1;                // Last view that searched the place of the object; -1: none.
    double depth_m = 0;           // Of the object's centre: the least of the searched views.
    double explained_share = -1;  // Of the object, by the last view.
  };
  [[nodiscard]] bool needs_search(const TrackedObject& tracked, int number, double depth_m) const;

  const ModelLibrary& library_;
  SearchPlannerOptions options_;
  PresenceOptions presence_;
  ViewNovelty novelty_;
  TrackCorrespondences correspondences_;  // Empty unless places are skipped.
  std::map<int, PlaceSearch> search_of_track_;
  std::set<int> outdated_tracks_;
};

}  // namespace resight
