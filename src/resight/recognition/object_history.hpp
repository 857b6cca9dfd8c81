// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <span>
#include <vector>

#include "resight/evidence/object_presence.hpp"
#include "resight/models/object_model.hpp"
#include "resight/recognition/body_overlap.hpp"
#include "resight/recognition/depth_history.hpp"
#include "resight/recognition/scene_update.hpp"
#include "resight/recognition/tentative_tracks.hpp"
#include "resight/recognition/tracked_object.hpp"

namespace resight {

struct ObjectHistoryOptions {
  double same_place_m = 0.03;  ///< A detection within this and same_rotation_rad of a track's pose: it is still there.
  double same_rotation_rad = 0.349;       ///< 20 deg, over the object's symmetries.
  double min_displaced_gone_share = 0.2;  ///< An object recognised within its old place has moved if at least so much
                                          ///< of that is seen free; with less it is only seen better, or worse.
  double min_new_share = 0;   ///< What the view itself confirms less of (of the model's points) is not new in it.
  double min_told_score = 0;  ///< What is new at a place and scores less is not told until it scores as much, for which
                              ///< its having been recognised there before counts as well. Its old place, if it has
                              ///< moved, is told of as if it had not been recognised.
  int confirm_removal_views =
      1;  ///< An object seen gone is called removed when it is not recognised elsewhere for so many more views.
  int correct_views = 6;  ///< An arrival whose pose turns out otherwise is told anew, up to so many views after it was
                          ///< first told.
  PresenceOptions presence;
  DepthHistoryOptions memory;
  void check() const;
};

/// Remembers which object was where, and tells what happened to it. Memory grows with the number of objects, not of
/// views. What is told of a view is what is known by then; a later view may tell better (ObjectEvent::replaces).
class ObjectHistory {
 public:
  explicit ObjectHistory(const ModelLibrary& library, ObjectHistoryOptions options = {});

  /// Takes over the detections of a view (gives each that the view confirms its track) and returns the events of the
  /// tracks concerned. What is new at a place is
  /// - moved, if one of its kind has left its place, as far back as the memory reaches, and was not missing from both
  ///   while both were seen free; also, at a place that was free before, if of its kind the only one that is not
  ///   recognised is out of sight,
  /// - else added, if an earlier view saw the place free, or another object in it,
  /// - else found;
  /// if its score is below min_told_score, it is looked for in the next views and nothing is told of it before one of
  /// them scores as much.
  /// What leaves a place after one of its kind was added elsewhere has moved there; another object recognised in its
  /// place tells that it has left as well as free space does. An arrival whose pose the next views correct is told
  /// anew. `current` is the view's frame. Without change detection (`use_evidence` false) no free space is looked for:
  /// nothing is called added or removed.
  [[nodiscard]] std::vector<ObjectEvent> update(int view, std::vector<Detection>& detections, const RgbdFrame& current,
                                                bool use_evidence);
  /// Removals that still wait for confirmation; to be called after the last view.
  [[nodiscard]] std::vector<ObjectEvent> finish();
  /// What is known to be there, whether the last view saw it or not; what is not sure comes last.
  [[nodiscard]] std::vector<TrackedObject> tracked_objects() const;

 private:
  enum class State { kPresent, kLeaving, kGone, kJoined };
  struct Track {
    int id = 0;
    int object = -1;
    Rigid3 world_from_object;
    int last_view = -1;  // that it was recognised with
    State state = State::kPresent;
    int seen_view = -1;                  // likewise, and saw itself
    int since_view = -1;                 // that it was first recognised with at its place
    int reported_view = -1;              // that told so
    std::optional<ObjectEvent> arrival;  // that told of it: kAdded or kMoved
    int left_view = -1;                  // first view that saw its place free, or taken
    bool is_replaced = false;            // by another object
    double confidence = 0;               // of that
  };

  /// Where an object was until it was recognised elsewhere.
  struct FormerPlacement {
    int object = -1;
    Rigid3 world_from_object;
    int seen_view = -1;  // last
  };

  [[nodiscard]] static bool was_added(const Track& track) {
    return track.arrival && track.arrival->kind == ObjectEventKind::kAdded;
  }
  [[nodiscard]] bool is_same_place(const ObjectModel& model, const Rigid3& a, const Rigid3& b) const;
  void correct_arrival(Track& track, int view, std::vector<ObjectEvent>& events) const;
  void match_in_place(std::vector<Detection>& detections, std::vector<int>& track_of, int view,
                      std::vector<ObjectEvent>& events);
  void keep_in_place(Track& track, Detection& detection, int view, std::vector<ObjectEvent>& events) const;
  [[nodiscard]] int find_displaced(const Track& track, std::span<const Detection> detections,
                                   std::span<const int> track_of) const;
  void look_at_old_places(std::vector<Detection>& detections, std::vector<int>& track_of, int view,
                          const RgbdFrame& current, bool use_evidence, std::vector<ObjectEvent>& events);
  static void leave(Track& track, int view, double confidence, bool is_replaced);
  [[nodiscard]] const Detection* find_replacement(const Track& track, int view, bool is_surface_seen,
                                                  std::span<const Detection> detections,
                                                  std::span<const int> track_of) const;
  [[nodiscard]] bool is_still_taken(const Track& left, int view) const;
  [[nodiscard]] const ObjectModel& model_of(const auto& thing) const {
    return library_.objects[static_cast<std::size_t>(thing.object)];
  }
  [[nodiscard]] bool is_in_space_of(const auto& one, const auto& other) const {
    return is_mostly_within(model_of(one), one.world_from_object, model_of(other), other.world_from_object);
  }
  [[nodiscard]] std::optional<int> last_seen_taken(const Detection& detection, int view) const;
  [[nodiscard]] Track* find_added_since(const Track& left);
  void join(Track& left, Track& added, int view, std::vector<Detection>& detections, std::vector<ObjectEvent>& events);
  [[nodiscard]] Track* find_left(const Detection& detection, int since_view, std::optional<int> last_free_view);
  [[nodiscard]] Track* find_out_of_sight(const Detection& detection, int since_view, const RgbdFrame& current);
  Track& new_track(int object, int id);
  [[nodiscard]] bool is_confirmed(const Detection& detection, int view) const;
  void place_new(Detection& detection, int view, const RgbdFrame& current, bool use_evidence,
                 std::vector<ObjectEvent>& events);
  void confirm_removals(int view, std::vector<ObjectEvent>& events);
  void remove(Track& track, std::vector<ObjectEvent>& events) const;

  const ModelLibrary& library_;
  ObjectHistoryOptions options_;
  DepthHistory memory_;
  std::vector<Track> tracks_;
  std::vector<FormerPlacement> former_placements_;  // since the memory begins
  TentativeTracks tentative_;
  int next_id_ = 0;
};

}  // namespace resight
