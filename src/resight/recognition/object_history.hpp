// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>
#include <vector>

#include "resight/models/object_model.hpp"
#include "resight/recognition/object_presence.hpp"
#include "resight/recognition/scene_update.hpp"

namespace resight {

struct ObjectHistoryOptions {
  double same_place_m = 0.03;  ///< A detection within this and same_rotation_rad of a track's pose: it is still there.
  double same_rotation_rad = 0.349;       ///< 20 deg, over the object's symmetries.
  double min_displaced_gone_share = 0.2;  ///< An object recognised within its old place has moved if at least so much
                                          ///< of that is seen free; with less it is only seen better, or worse.
  double min_new_share = 0;  ///< What the view itself sees less of (of the model's points) is not new in it.
  int confirm_removal_views =
      1;  ///< An object seen gone is called removed when it is not recognised elsewhere for so many more views.
  PresenceOptions presence;
  void check() const;
};

/// An object that was not seen to leave its place.
struct KnownObject {
  int object = -1;
  Rigid3 world_from_object;
  int last_view = -1;  ///< That it was recognised with.
};

/// Remembers which object was where, and tells what happened to it. Memory grows with the number of objects, not of
/// views.
class ObjectHistory {
 public:
  explicit ObjectHistory(const ModelLibrary& library, ObjectHistoryOptions options = {});

  /// Takes over the detections of a view (gives each its track) and returns one event per track concerned. `current` is
  /// the view's frame, `earlier` are raw frames of views before it: what they see at a place decides between added and
  /// found, moved and found. What is new where it was free before has moved if it is the only one known of its kind and
  /// its old place has been seen free, or is out of sight. Without change detection (`use_evidence` false) no free
  /// space is looked for: nothing is called added or removed.
  [[nodiscard]] std::vector<ObjectEvent> update(int view, std::vector<Detection>& detections, const RgbdFrame& current,
                                                std::span<const RgbdFrame* const> earlier, bool use_evidence);
  /// Removals that still wait for confirmation; to be called after the last view.
  [[nodiscard]] std::vector<ObjectEvent> finish();
  /// What is known to be there, by track; whether the last view saw it or not.
  [[nodiscard]] std::vector<KnownObject> known_objects() const;

 private:
  enum class State { kPresent, kLeaving, kGone };
  struct Track {
    int id = 0;
    int object = -1;
    Rigid3 world_from_object;
    int last_view = -1;  // that it was recognised with
    State state = State::kPresent;
    int left_view = -1;     // first view that saw its place free
    double confidence = 0;  // of that
  };

  [[nodiscard]] bool same_place(const Track& track, const Detection& detection) const;
  void match_in_place(std::vector<Detection>& detections, std::vector<int>& track_of, int view,
                      std::vector<ObjectEvent>& events);
  void keep_in_place(Track& track, Detection& detection, int view, std::vector<ObjectEvent>& events) const;
  [[nodiscard]] int find_displaced(const Track& track, std::span<const Detection> detections,
                                   std::span<const int> track_of) const;
  void look_at_old_places(std::vector<Detection>& detections, std::vector<int>& track_of, int view,
                          const RgbdFrame& current, bool use_evidence, std::vector<ObjectEvent>& events);
  [[nodiscard]] Track* find_left(const Detection& detection);
  [[nodiscard]] Track* find_out_of_sight(const Detection& detection, const RgbdFrame& current);
  void place_new(Detection& detection, int view, const RgbdFrame& current, std::span<const RgbdFrame* const> earlier,
                 bool use_evidence, std::vector<ObjectEvent>& events);
  void confirm_removals(int view, std::vector<ObjectEvent>& events);

  const ModelLibrary& library_;
  ObjectHistoryOptions options_;
  std::vector<Track> tracks_;
};

}  // namespace resight
