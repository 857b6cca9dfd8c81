// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>
#include <vector>

#include "resight/cameras/object_places.hpp"

namespace resight {

struct JoinByObjectsOptions {
  SamePlaceOptions same_place;
  int min_objects = 2;             ///< That must agree on how two parts lie: one may have moved between them.
  int max_candidates = 16;         ///< Ways to join two parts whose surfaces are compared.
  double max_seen_through = 0.15;  ///< More of the one part's points in front of what the other sees: a wrong way.
  double sigma_m = 0.004;          ///< Of a recognised pose.
  double sigma_rad = 0.035;
  AlignViewOptions align;  ///< What counts as overlap and as seen through.
  void check() const;
};

/// Joins parts of a track that see the same objects, however little their views overlap (paper, Sec. III: "common
/// object hypotheses"). Each object seen in both parts, with each of its symmetries, says how they lie; of the ways
/// that most objects agree on, the one joins them that their surfaces contradict least (free space) and support most
/// (overlap of points with like normals). An edge for each join is added to the track.
///
/// `views`: one for each view of the track, for the surfaces; those without levels do not count. Empty: objects alone
/// decide. Throws std::invalid_argument as find_places().
[[nodiscard]] CameraTrack join_by_objects(CameraTrack track, std::span<const ObservedObject> observed,
                                          const ModelLibrary& library, std::span<const AlignmentView> views = {},
                                          const JoinByObjectsOptions& options = {});

}  // namespace resight
