// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <span>
#include <vector>

#include "resight/evidence/object_presence.hpp"
#include "resight/history/object_event.hpp"
#include "resight/history/object_observation.hpp"
#include "resight/history/placement_memory.hpp"
#include "resight/history/tentative_tracks.hpp"
#include "resight/history/track_association.hpp"
#include "resight/history/tracked_object.hpp"
#include "resight/models/object_model.hpp"
#include "resight/sensor/rgbd_frame.hpp"

namespace resight {

struct ObjectHistoryOptions {
  /// An observation within this distance and same_rotation_rad of a track's pose is at the same place.
  double same_place_m = 0.03;
  double same_rotation_rad = 0.349;  ///< 20 deg, over the object's symmetries.
  /// An object recognised within its old place has moved if at least this share of the old place is seen free. With
  /// less, only its pose is known better, or worse.
  double min_displaced_gone_share = 0.2;
  double min_new_share = 0;  ///< An observation is new only if the view confirms this share of the model's points.
  /// A new object whose score is lower is tentative: no event is reported for it until a view scores this much. If it
  /// has moved, its old place is reported as if it had not been recognised.
  double confirm_score = 0;
  /// A removal is reported if the object is not recognised elsewhere for this many views after its place was seen free.
  int confirm_removal_views = 1;
  /// An arrival whose pose is corrected is reported again, up to this many views after its first report.
  int correct_views = 6;
  PresenceOptions presence;
  DepthHistoryOptions memory;
  void check() const;  ///< Throws std::invalid_argument: field, value, rule.
};

/// What a view adds to the history.
struct HistoryUpdate {
  std::vector<ObjectEvent> events;
  std::vector<int> tracks;  ///< Per observation: number of its track; -1 if the view itself does not confirm it.
};

/// Remembers which object was where, and reports what happened to it. Memory grows with the number of objects, not of
/// views. Events report what is known at their view; a later view may correct them (ObjectEvent::supersedes).
class ObjectHistory {
 public:
  /// `library` must outlive it. Throws std::invalid_argument for options that fail check().
  explicit ObjectHistory(const ModelLibrary& library, ObjectHistoryOptions options = {});

  /// Takes over the observations of a view (numbers ascend) and returns their tracks and the events. An object at a new
  /// place is
  /// - moved, if one of its kind has left its place, as far back as the memory reaches, and was not missing from both
  ///   places while both were seen free; also, at a place that was free before, if the only object of its kind that is
  ///   not recognised is out of sight,
  /// - else added, if an earlier view saw the place free, or another object in it,
  /// - else found.
  /// If its score is below confirm_score, it becomes a tentative track.
  /// An object that leaves its place after one of its kind was added elsewhere has moved there. Another object
  /// recognised in its place shows that it has left as well as free space does. An arrival whose pose the next views
  /// correct is reported again. `frame` is the view's frame. Without change detection (`use_evidence` false), free
  /// space is not used: nothing is added or removed.
  [[nodiscard]] HistoryUpdate update(int view, std::span<const ObjectObservation> observations, const RgbdFrame& frame,
                                     bool use_evidence);
  /// Reports the removals that still wait for confirmation. Call it after the last view.
  [[nodiscard]] std::vector<ObjectEvent> finish();
  /// The objects that are at their places, whether the last view saw them or not. Tentative ones come last.
  [[nodiscard]] std::vector<TrackedObject> tracked_objects() const;

 private:
  /// A view on its way through update().
  struct View : ViewObservations {
    const RgbdFrame& frame;
    bool use_evidence;
    HistoryUpdate& update;
  };
  [[nodiscard]] bool is_confirmed_by_view(const ObjectObservation& observed) const {
    return observed.confirmed_share >= options_.min_new_share;
  }
  [[nodiscard]] bool is_confirmed(const ObjectObservation& observed, int view) const;
  void match_in_place(View& view);
  void keep_in_place(Track& track, int observation, View& view) const;
  void correct_arrival(Track& track, View& view) const;
  void update_unmatched_tracks(View& view);
  [[nodiscard]] const ObjectObservation* find_replacement(const Track& track, bool is_surface_seen,
                                                          const View& view) const;
  static void leave(Track& track, int view, double confidence, bool is_replaced);
  void join(Track& left, Track& added, View& view);
  void add_unmatched_observations(View& view);
  [[nodiscard]] Track* find_out_of_sight(const ObjectObservation& observed, int since_view, const RgbdFrame& frame);
  void place_new(std::size_t observation, View& view);
  [[nodiscard]] Track* find_previous_track(const ObjectObservation& observed, int since_view,
                                           std::optional<int> last_free_view, View& view, ObjectEvent& event);
  [[nodiscard]] Track& new_track(int object, int id);
  void confirm_removals(View& view);
  static void remove(Track& track, std::vector<ObjectEvent>& events);
  void forget_old(const View& view);

  ObjectHistoryOptions options_;
  TrackAssociation association_;
  PlacementMemory memory_;
  std::vector<Track> tracks_;
  TentativeTracks tentative_;
  int next_id_ = 0;
};

}  // namespace resight
