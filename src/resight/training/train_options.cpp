// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "resight/core/check.hpp"
#include "resight/core/hash.hpp"
#include "resight/training/training.hpp"

namespace resight {
namespace {

// Increases whenever the same options give another result, or the library file changes.
constexpr int kTrainingVersion = 4;

// Destructures each options struct completely, so that a new field does not compile here until it is hashed (or
// deliberately left out, like numbers of threads).
std::string describe(const SiftOptions& options) {
  const auto& [contrast_threshold, edge_threshold, num_octave_layers, root_sift] = options;
  return fmt::format("sift {} {} {} {}\n", contrast_threshold, edge_threshold, num_octave_layers, root_sift);
}

std::string describe(const ShotOptions& options) {
  [[maybe_unused]] const auto& [spacing_m, radius_m, voxel_m, min_variation, max_depth_m, min_neighbors, num_threads] =
      options;
  return fmt::format("shot {} {} {} {} {} {}\n", spacing_m, radius_m, voxel_m, min_variation, max_depth_m,
                     min_neighbors);
}

std::string describe(const TurntableOptions& options) {
  [[maybe_unused]] const auto& [step_deg, elevation_deg, both_sides, distance_m, sensor_noise, seed, num_threads] =
      options;
  return fmt::format("turntable {} {} {} {} {} {}\n", step_deg, elevation_deg, both_sides, distance_m, sensor_noise,
                     seed);
}

std::string describe(const SymmetryOptions& options) {
  [[maybe_unused]] const auto& [agreement, close_agreement, distance_m, distance_share, normal_angle_rad, blur_share,
                                brightness, chroma, num_samples, num_threads] = options;
  return fmt::format("symmetry {} {} {} {} {} {} {} {} {}\n", agreement, close_agreement, distance_m, distance_share,
                     normal_angle_rad, blur_share, brightness, chroma, num_samples);
}

std::string describe(const FeatureMerging& merging) {
  const auto& [max_distance_m, max_descriptor_distance] = merging;
  return fmt::format("merging {} {}\n", max_distance_m, max_descriptor_distance);
}

}  // namespace

void TrainOptions::check() const {
  sift.check();
  shot.check();
  check_positive("TrainOptions.surface_voxel_m", surface_voxel_m);
  turntable.check();
  check_not_negative("TrainOptions.min_edge_distance_px", min_edge_distance_px);
  sift_merging.check();
  shot_merging.check();
  symmetry.check();
  require(num_threads >= 1, fmt::format("TrainOptions.num_threads = {} (must be >= 1)", num_threads));
}

std::uint64_t TrainOptions::hash() const {
  [[maybe_unused]] const auto& [sift_part, shot_part, voxel_m, turntable_part, edge_px, sift_merge, shot_merge,
                                with_symmetries, symmetry_part, threads] = *this;
  return hash_text(fmt::format("version {}\n", kTrainingVersion) + describe(sift_part) + describe(shot_part) +
                   fmt::format("surface {} {}\n", voxel_m, edge_px) + describe(turntable_part) + describe(sift_merge) +
                   describe(shot_merge) + fmt::format("find_symmetries {}\n", with_symmetries) +
                   describe(symmetry_part));
}

}  // namespace resight
