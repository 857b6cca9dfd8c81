// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <span>
#include <vector>

#include "resight/core/options.hpp"
#include "resight/evidence/object_presence.hpp"
#include "resight/history/object_event.hpp"
#include "resight/history/object_observation.hpp"
#include "resight/history/place_change.hpp"
#include "resight/history/placement_memory.hpp"
#include "resight/history/tentative_tracks.hpp"
#include "resight/history/track_association.hpp"
#include "resight/history/tracked_object.hpp"
#include "resight/models/object_model.hpp"
#include "resight/sensor/rgbd_frame.hpp"

namespace resight {

/// An observation at a track's place is of that track if it is rotated by less than this (20 deg), over the symmetries.
inline constexpr double kSameTrackRotation_rad = 0.349;
/// An object recognised within its old place has moved if at least this share of the old place is seen free. With less,
/// only its pose is known better, or worse.
inline constexpr double kMinDisplacedGoneShare = 0.2;

struct ObjectHistoryOptions {
  double same_place_m = 0.03;
  double min_new_share = 0;
  double confirm_score = 0;
  PresenceOptions presence{};
  DepthHistoryOptions memory{};
  void check() const { check_options("ObjectHistoryOptions", *this); }
};

inline void declare(OptionVisitor& v, ObjectHistoryOptions& o) {
  v.field(
      "same_place_m", o.same_place_m, positive(),
      "An observation within this distance of a track's last pose (and 20 deg) is at the same place. An object that "
      "moves less from view to view is followed, without an event.");
  v.field("min_new_share", o.min_new_share, between(0, 1),
          "An observation is new only if the view itself confirms this share of the model. 0: it always may be.");
  v.field(
      "confirm_score", o.confirm_score, between(0, 1),
      "A new object that scores less is tentative: no event is reported for it until a view scores this much. If it "
      "has moved, its old place is reported as if it had not been recognised. 0: every object is confirmed at once.");
  v.group("presence", o.presence);
  v.group("memory", o.memory);
}

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
  explicit ObjectHistory(const ModelLibrary& library, const ObjectHistoryOptions& options = {});

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
  /// space is not used: nothing is added or removed. The support of a flat object lies within the margin of depth.
  /// There, `find_change` decides whether the object came or left, together with the noise of the depth.
  [[nodiscard]] HistoryUpdate update(int view, std::span<const ObjectObservation> observations, const RgbdFrame& frame,
                                     bool use_evidence, const FindPlaceChange& find_change = {});
  /// Reports the removals that still wait for confirmation. Call it after the last view.
  [[nodiscard]] std::vector<ObjectEvent> finish();
  /// The objects that are at their places, whether the last view saw them or not. Tentative ones come last.
  [[nodiscard]] std::vector<TrackedObject> tracked_objects() const;

 private:
  /// A view on its way through update().
  struct View : ViewObservations {
    const RgbdFrame& frame;
    bool use_evidence;
    const FindPlaceChange& find_change;
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
  [[nodiscard]] ObjectPresence assess(const Track& track, const View& view) const;
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
