// SPDX-License-Identifier: Apache-2.0
#include "resight/shape_search/point_pair_search.hpp"

#include <algorithm>

namespace resight {
namespace {

constexpr int kPairsPerSeed = 20;  // More find little that other seeds do not.
constexpr int kRings = 4;          // Partners are drawn within so many radii, so that small objects have their share:
constexpr double kRingStep = 1.6;  // each so much smaller than the one before.

// The points within a radius, in order: of all or, of a smaller ring, of those of the ring around it.
void keep_within(const Eigen::ArrayXf& distances_sq, float radius_sq, bool of_all, std::vector<int>& near) {
  if (!of_all) {
    std::erase_if(near, [&](int i) { return !(distances_sq[i] < radius_sq); });
    return;
  }
  near.resize(static_cast<std::size_t>(distances_sq.size()));
  std::size_t num_near = 0;
  for (Eigen::Index i = 0; i < distances_sq.size(); ++i) {  // Without branches, which would be a guess each.
    near[num_near] = static_cast<int>(i);
    num_near += distances_sq[i] < radius_sq ? 1 : 0;
  }
  near.resize(num_near);
}

}  // namespace

PointPairSearch::PointPairSearch(const PointCloud& scene, const PoseScorer& scorer,
                                 const std::vector<SampledModel>& objects, const PointPairTable& table,
                                 std::span<const int> max_entries, const ShapeSearchOptions& options)
    : scene_(scene), scorer_(scorer), objects_(objects), table_(table), max_entries_(max_entries), options_(options) {
  coordinates_.resize(static_cast<Eigen::Index>(scene.size()), 3);
  for (std::size_t i = 0; i < scene.size(); ++i)
    coordinates_.row(static_cast<Eigen::Index>(i)) = scene.points[i].transpose().array();
}

// To all points, in vector code: partners are drawn from thousands of points around a seed, more than a tree can spare.
void PointPairSearch::measure_distances(std::size_t seed, Eigen::ArrayXf& distances_sq) const {
  const Eigen::Vector3f& p = scene_.points[seed];
  distances_sq = (coordinates_.col(0) - p.x()).square() + (coordinates_.col(1) - p.y()).square() +
                 (coordinates_.col(2) - p.z()).square();
}

std::vector<PoseCandidate> PointPairSearch::from_seed(std::size_t seed) const {
  Rng rng = Rng::stream(options_.seed, seed);
  std::vector<PoseCandidate> found;
  Eigen::ArrayXf distances_sq;
  measure_distances(seed, distances_sq);
  std::vector<int> near;
  double radius_m = table_.max_length_m();
  for (int ring = 0; ring < kRings; ++ring, radius_m /= kRingStep) {
    keep_within(distances_sq, static_cast<float>(radius_m * radius_m), ring == 0, near);
    for (int i = 0; i < kPairsPerSeed / kRings && !near.empty(); ++i) {
      const auto other = static_cast<std::size_t>(near[rng.below(static_cast<std::uint32_t>(near.size()))]);
      if (other != seed)
        try_point_pair({scene_.points[seed], scene_.normals[seed], scene_.points[other], scene_.normals[other]}, rng,
                       found);
    }
  }
  return found;
}

// Objects whose bin holds many are drawn from.
void PointPairSearch::try_point_pair(const OrientedPointPair& seen, Rng& rng, std::vector<PoseCandidate>& found) const {
  const auto bin = point_pair_bin(seen, table_.max_length_m());
  const int first = scorer_.pixel_of(seen.p1);
  const int second = scorer_.pixel_of(seen.p2);
  if (!bin || first < 0 || second < 0) return;
  const std::span<const PointPairEntry> entries = table_.find(*bin);
  for (std::size_t begin = 0; begin < entries.size();) {
    std::size_t end = begin;
    while (end < entries.size() && entries[end].object == entries[begin].object) ++end;
    const auto count = static_cast<std::uint32_t>(end - begin);
    const auto tries = std::min(count, static_cast<std::uint32_t>(max_entries_[entries[begin].object]));
    for (std::uint32_t t = 0; t < tries; ++t)
      try_entry(entries[begin + (tries == count ? t : rng.below(count))], seen, scorer_.chroma_at(first),
                scorer_.chroma_at(second), found);
    begin = end;
  }
}

void PointPairSearch::try_entry(const PointPairEntry& entry, const OrientedPointPair& seen,
                                const Eigen::Vector2f& first, const Eigen::Vector2f& second,
                                std::vector<PoseCandidate>& found) const {
  const SampledModel& model = objects_[entry.object];
  const float max_difference = static_cast<float>(CountSamplesOptions{}.max_chroma_difference);
  if (!model.chroma.empty() && !(is_similar_chroma(model.chroma[entry.first], first, max_difference) &&
                                 is_similar_chroma(model.chroma[entry.second], second, max_difference)))
    return;
  const auto pose = align(
      {model.points[entry.first], model.normals[entry.first], model.points[entry.second], model.normals[entry.second]},
      seen);
  if (!pose) return;
  if (const auto candidate = test_coarsely(entry.object, model, *pose, scorer_)) found.push_back(*candidate);
}

}  // namespace resight
