// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "resight/core/hash.hpp"
#include "resight/core/options.hpp"
#include "resight/training/training.hpp"

namespace resight {
namespace {

// Increases whenever the same options give another result, or the library file changes.
constexpr int kTrainingVersion = 4;

template <typename Options>
std::string describe(const char* name, Options options) {
  return fmt::format("{} {}\n", name, joined_values(list_options(options)));
}

}  // namespace

std::uint64_t TrainOptions::hash() const {
  // Taken apart completely: a field that is added does not compile here until it is hashed (or left out on purpose, as
  // the number of threads is).
  [[maybe_unused]] const auto& [sift_part, shot_part, voxel_m, turntable_part, edge_px, sift_merge, shot_merge,
                                with_symmetries, symmetry_part, threads] = *this;
  return hash_text(fmt::format("version {}\n", kTrainingVersion) + describe("sift", sift_part) +
                   describe("shot", shot_part) + fmt::format("surface {} {}\n", voxel_m, edge_px) +
                   describe("turntable", turntable_part) + describe("merging", sift_merge) +
                   describe("merging", shot_merge) + fmt::format("find_symmetries {}\n", with_symmetries) +
                   describe("symmetry", symmetry_part));
}

}  // namespace resight
