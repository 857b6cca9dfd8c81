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

/// Poses from the oriented point pairs of one view. All arguments must outlive it; camera frame.
class PointPairSearch {
 public:
  /// `max_entries`: of each object, per oriented point pair (in place of options.max_entries).
  PointPairSearch(const PointCloud& scene, const PoseScorer& scorer, const std::vector<SampledModel>& objects,
                  const PointPairTable& table, std::span<const int> max_entries, const ShapeSearchOptions& options);

  /// Poses that pass the coarse test, from the pairs of one scene point and others around it.
  [[nodiscard]] std::vector<PoseCandidate> from_seed(std::size_t seed) const;

 private:
  void measure_distances(std::size_t seed, Eigen::ArrayXf& distances_sq) const;
  void try_point_pair(const OrientedPointPair& seen, Rng& rng, std::vector<PoseCandidate>& found) const;
  void try_entry(const PointPairEntry& entry, const OrientedPointPair& seen, const Eigen::Vector2f& first,
                 const Eigen::Vector2f& second, std::vector<PoseCandidate>& found) const;

  const PointCloud& scene_;
  const PoseScorer& scorer_;
  const std::vector<SampledModel>& objects_;
  const PointPairTable& table_;
  std::span<const int> max_entries_;
  const ShapeSearchOptions& options_;
  Eigen::Array<float, Eigen::Dynamic, 3> coordinates_;  // of the scene
};

}  // namespace resight
