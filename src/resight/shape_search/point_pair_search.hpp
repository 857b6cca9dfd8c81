// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <span>
#include <vector>

#include "resight/core/random.hpp"
#include "resight/shape_search/point_pair_table.hpp"
#include "resight/shape_search/pose_candidate.hpp"
#include "resight/shape_search/shape_search.hpp"

namespace resight {

/// Dipoles of one view, and the poses they stand for. All arguments must outlive it; camera frame.
class PointPairSearch {
 public:
  /// `max_entries`: of each object, per dipole (in place of options.max_entries).
  PointPairSearch(const PointCloud& scene, const PoseScorer& probe, const std::vector<SampledModel>& objects,
                  const PointPairTable& table, std::span<const int> max_entries, const ShapeSearchOptions& options);

  /// Poses that pass the first test, of dipoles from one scene point to others around it.
  [[nodiscard]] std::vector<PoseCandidate> from_seed(std::size_t seed) const;

 private:
  void measure_distances(std::size_t seed, Eigen::ArrayXf& distances_sq) const;
  void try_point_pair(const OrientedPointPair& seen, Rng& rng, std::vector<PoseCandidate>& found) const;
  void try_entry(const PointPairEntry& entry, const OrientedPointPair& seen, const Eigen::Vector2f& first,
                 const Eigen::Vector2f& second, std::vector<PoseCandidate>& found) const;

  const PointCloud& scene_;
  const PoseScorer& probe_;
  const std::vector<SampledModel>& objects_;
  const PointPairTable& table_;
  std::span<const int> max_entries_;
  const ShapeSearchOptions& options_;
  Eigen::Array<float, Eigen::Dynamic, 3> coordinates_;  // of the scene
};

}  // namespace resight
