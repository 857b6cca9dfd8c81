// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <span>
#include <vector>

#include "resight/history/object_observation.hpp"
#include "resight/history/track.hpp"
#include "resight/models/object_model.hpp"

namespace resight {

/// Index of "no track" or "no observation".
inline constexpr int kUnmatched = -1;

/// The observations of one view, and the track that each belongs to.
struct ViewObservations {
  int view = 0;
  std::span<const ObjectObservation> observations;
  std::vector<int> track_of;  ///< Per observation: index into the tracks, or kUnmatched.
};

/// Decides which observations and tracks are the same object. Distances in metres, world frame. Changes nothing.
class TrackAssociation {
 public:
  /// `library` must outlive it. An observation within `same_place_m` and `same_rotation_rad` (over the symmetries) of a
  /// track is at the same place.
  TrackAssociation(const ModelLibrary& library, double same_place_m, double same_rotation_rad)
      : library_(library), same_place_m_(same_place_m), same_rotation_rad_(same_rotation_rad) {}

  [[nodiscard]] const ObjectModel& model_of(int object) const {
    return library_.objects[static_cast<std::size_t>(object)];
  }
  [[nodiscard]] bool is_same_place(int object, const Rigid3& a, const Rigid3& b) const;
  /// Most of the body of `one` lies in that of `other`: both cannot be there.
  [[nodiscard]] bool is_in_space_of(const auto& one, const auto& other) const {
    return is_within(one.object, one.world_from_object, other.object, other.world_from_object);
  }

  /// The nearest unmatched observation at the place of a track, or kUnmatched.
  [[nodiscard]] int find_in_place(const Track& track, const ViewObservations& view) const;
  /// The nearest unmatched observation whose body overlaps that of the track, or kUnmatched. Two bodies of one kind
  /// cannot overlap, so it is the same object.
  [[nodiscard]] int find_displaced(const Track& track, const ViewObservations& view) const;
  /// The nearest track of this kind that was added after a view last saw `left`; null if there is none.
  [[nodiscard]] Track* find_added_since(const Track& left, std::span<Track> tracks) const;
  /// The track of this kind that the observation at a new place continues: one whose old place was seen free, and that
  /// was not seen there while the new one was occupied. Tracks that can have moved directly come first (the new place
  /// was not free since they left), then those that are leaving, then the nearest. Null if there is none.
  [[nodiscard]] Track* find_left(const ObjectObservation& observed, int since_view, std::optional<int> last_free_view,
                                 std::span<Track> tracks) const;
  /// The only present track of this kind that was not seen since `since_view`; null if there are none or several.
  [[nodiscard]] Track* find_only_unseen(const ObjectObservation& observed, int since_view,
                                        std::span<Track> tracks) const;
  /// Whether the observation overlaps the old place of a track of its kind that `view` has found leaving.
  [[nodiscard]] bool has_just_left(const ObjectObservation& observed, int view, std::span<const Track> tracks) const;
  /// Whether `view` shows another object in the space of a track.
  [[nodiscard]] bool is_still_occupied(const Track& left, int view, std::span<const Track> tracks) const;

 private:
  [[nodiscard]] bool is_within(int one, const Rigid3& world_from_one, int other, const Rigid3& world_from_other) const;

  const ModelLibrary& library_;
  double same_place_m_;
  double same_rotation_rad_;
};

}  // namespace resight
