// SPDX-License-Identifier: Apache-2.0
#include "resight/recognition/search_planner.hpp"

#include <algorithm>
#include <utility>

#include "resight/core/check.hpp"
#include "resight/recognition/explained_pixels.hpp"

namespace resight {
namespace {

// A place is searched in this many views after the object was first recognised there.
constexpr int kPlaceMinViews = 2;

}  // namespace

SearchPlanner::SearchPlanner(const ModelLibrary& library, const SearchPlannerOptions& options,
                             const PresenceOptions& presence, TrackCorrespondences correspondences)
    : library_(library),
      options_(options),
      presence_(presence),
      novelty_(options),
      correspondences_(std::move(correspondences)) {}

void SearchPlanner::set_outdated(std::span<const TrackedObject> tracked, std::span<const std::uint8_t> outdated) {
  require(outdated.empty() || outdated.size() == tracked.size(), "set_outdated: not one flag per tracked object");
  outdated_tracks_.clear();
  for (std::size_t i = 0; i < outdated.size(); ++i) {
    if (outdated[i] == 0) continue;
    outdated_tracks_.insert(tracked[i].track);
    correspondences_.forget(tracked[i].track);
  }
  if (!outdated_tracks_.empty()) request_search();
}

// A search can find something if the object is tentative or new at its place, was not searched for lately, is nearer
// than in any search, was not all that the last view saw at its place, or if the place has changed.
bool SearchPlanner::needs_search(const TrackedObject& tracked, int number, double depth_m) const {
  const auto last = search_of_track_.find(tracked.track);
  return !tracked.is_confirmed || outdated_tracks_.contains(tracked.track) || last == search_of_track_.end() ||
         last->second.view < 0 || number - tracked.since_view < kPlaceMinViews ||
         number - last->second.view >= options_.place_interval.value_or(0) || tracked.seen_view + 1 != number ||
         last->second.explained_share < options_.min_explained_share ||
         depth_m * kMaxDistanceRatio < last->second.depth_m;
}

Image<std::uint8_t> SearchPlanner::find_skipped_pixels(int number, const RgbdFrame& frame,
                                                       std::span<const TrackedObject> tracked) {
  if (!skips_places()) return {};
  const Rigid3 camera_from_world = frame.world_from_camera.inverse();
  std::vector<TrackedObject> skipped;
  for (std::size_t i = 0; i < tracked.size(); ++i) {
    const Eigen::Vector3d center = library_.objects[static_cast<std::size_t>(tracked[i].object)].center.cast<double>();
    const Eigen::Vector3d center_in_camera = camera_from_world * (tracked[i].world_from_object * center);
    const double depth_m = center_in_camera.z();
    if (!needs_search(tracked[i], number, depth_m)) {
      skipped.push_back(tracked[i]);
      continue;
    }
    if (!frame.camera.pixel_of(center_in_camera)) continue;
    PlaceSearch& search = search_of_track_[tracked[i].track];
    search.depth_m = search.view < tracked[i].since_view ? depth_m : std::min(search.depth_m, depth_m);
    search.view = number;
  }
  return find_explained_pixels(frame, skipped, library_, presence_);
}

std::vector<Hypothesis> SearchPlanner::tracked_hypotheses(std::span<const TrackedObject> tracked,
                                                          int window_begin) const {
  std::vector<Hypothesis> hypotheses;
  for (const TrackedObject& t : tracked) {
    Hypothesis& hypothesis = hypotheses.emplace_back();
    hypothesis.object = t.object;
    hypothesis.world_from_object = t.world_from_object;
    hypothesis.origin_view = t.last_view;
    hypothesis.origin_views = {t.last_view};
    hypothesis.correspondences = correspondences_.of_views(t.track, t.since_view, window_begin, t.world_from_object);
  }
  return hypotheses;
}

void SearchPlanner::record(int number, std::span<const Detection> detections, std::span<const TrackedObject> tracked,
                           const HypothesisPool& pool) {
  if (!skips_places()) return;
  std::vector<int> tracks;
  for (const TrackedObject& t : tracked) tracks.push_back(t.track);
  correspondences_.keep_only(tracks);
  std::erase_if(search_of_track_,
                [&](const auto& entry) { return std::ranges::find(tracks, entry.first) == tracks.end(); });
  for (const Detection& detection : detections) {
    if (detection.track < 0) continue;
    search_of_track_[detection.track].explained_share = detection.views.back().explained_share;
    correspondences_.add(detection.track, number, pool.members_of_newest_view(detection.hypothesis_id),
                         detection.world_from_object,
                         library_.objects[static_cast<std::size_t>(detection.object)].symmetries);
  }
}

void SearchPlanner::request_full_search() {
  novelty_.forget_last_search();
  search_of_track_.clear();
}

}  // namespace resight
