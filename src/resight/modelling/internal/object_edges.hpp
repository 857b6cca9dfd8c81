// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>
#include <utility>
#include <vector>

#include "resight/modelling/internal/track_view.hpp"

namespace resight {

/// Where the initial pose of an alignment comes from.
enum class StartKind { kGuess, kMatched, kGiven };

/// Initial pose of an alignment. On round objects, feature matches and given poses determine the rotation better than
/// the surface does.
struct AlignmentStart {
  Rigid3 pose;
  StartKind kind = StartKind::kGuess;
};

/// Pose from matches and given pose are taken as different beyond this many standard deviations.
inline constexpr double kMatchSigmas = 3;

/// Whether a pose from matches or of the track differs from the given one by more than so many standard deviations.
[[nodiscard]] bool contradicts(const Rigid3& pose, const Rigid3& given, double sigmas,
                               const TrackObjectOptions& options);

/// Alignment options; with a prior at the initial pose unless it is a guess.
[[nodiscard]] AlignViewOptions align_options(const TrackObjectOptions& options, StartKind kind);

/// Whether overlap, free space and brightness correlation are within the limits. NaN correlation passes.
[[nodiscard]] bool is_plausible(const AlignedView& aligned, const TrackObjectOptions& options);

/// Score that chooses between two alignments of a view. Brightness counts most for the rotation of round objects.
[[nodiscard]] double alignment_score(const AlignedView& aligned);

/// Measures the relative pose of each pair independently, starting from `object_from_camera` and from feature matches.
/// Pairs that cannot be aligned are skipped. `parts` has one entry per pose. `kind`: of the poses. Matches that
/// contradict given poses are not used.
[[nodiscard]] std::vector<PoseEdge> measure_edges(std::span<const Rigid3> object_from_camera,
                                                  std::span<const TrackView> parts,
                                                  std::span<const std::pair<int, int>> pairs, StartKind kind,
                                                  const TrackObjectOptions& options);

/// Distance between the object's surfaces as placed by the two views of an edge: median over the edges whose second
/// view observes the object, metres; NaN without such edges.
[[nodiscard]] double median_error_m(std::span<const TrainingView> views, std::span<const PoseEdge> edges);

/// Measures the pairs again from their current poses and returns median_error_m() of their edges.
[[nodiscard]] double measure_closure(std::span<const TrainingView> views, std::span<const std::pair<int, int>> loops,
                                     StartKind kind, const TrackObjectOptions& options);

}  // namespace resight
