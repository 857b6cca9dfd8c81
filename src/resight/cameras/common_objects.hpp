// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>

#include "resight/cameras/view_tracker.hpp"
#include "resight/models/object_model.hpp"
#include "resight/models/observed_object.hpp"
#include "resight/models/pose_distance.hpp"
#include "resight/registration/alignment_view.hpp"
#include "resight/registration/view_alignment.hpp"

namespace resight {

struct JoinByObjectsOptions {
  SamePlaceOptions same_place;
  int min_objects = 2;      ///< Objects that must agree on the relative pose of two components; one may have moved.
  int max_candidates = 16;  ///< Candidate poses whose surfaces are compared.
  /// Above this share of points in front of the other component's surface, a pose is wrong.
  double max_seen_through = 0.15;
  double sigma_m = 0.004;  ///< Of a recognised pose.
  double sigma_rad = 0.035;
  AlignViewOptions align;  ///< What counts as overlap and as seen through.
  void check() const;
};

/// Joins connected components of a track that observe the same objects, even if their views hardly overlap (paper, Sec.
/// III: "common object hypotheses"). Each object observed in both components proposes a relative pose per symmetry. Of
/// the poses on which most objects agree, the one is chosen that the surfaces support most (overlap of points with
/// similar normals) and contradict least (free space). Each join adds an edge to the track.
///
/// `views`: one per view of the track, for the comparison of surfaces; views without levels are ignored. If empty,
/// objects alone decide. Throws std::invalid_argument like find_places(), or if the number of views differs.
[[nodiscard]] CameraTrack join_by_objects(CameraTrack track, std::span<const ObservedObject> observed,
                                          const ModelLibrary& library, std::span<const AlignmentView> views = {},
                                          const JoinByObjectsOptions& options = {});

}  // namespace resight
