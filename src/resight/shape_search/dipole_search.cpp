// SPDX-License-Identifier: Apache-2.0
#include "resight/shape_search/dipole_search.hpp"

#include <algorithm>

namespace resight {
namespace {

constexpr int kRings = 4;          // Partners are drawn within so many radii, so that small objects have their share:
constexpr double kRingStep = 1.6;  // each so much smaller than the one before.

}  // namespace

DipoleSearch::DipoleSearch(const PointCloud& scene, const PoseProbe& probe, const std::vector<ProbeModel>& objects,
                           const DipoleTable& table, const ShapeSearchOptions& options)
    : scene_(scene), probe_(probe), objects_(objects), table_(table), options_(options), tree_(scene.points) {}

std::vector<PoseCandidate> DipoleSearch::from_seed(std::size_t seed) const {
  Rng rng = Rng::stream(options_.seed, seed);
  std::vector<PoseCandidate> found;
  std::vector<PointNeighbor> neighbors;
  double radius_m = table_.max_length_m();
  for (int ring = 0; ring < kRings; ++ring, radius_m /= kRingStep) {
    tree_.within(scene_.points[seed], radius_m, neighbors);
    for (int i = 0; i < options_.pairs_per_seed / kRings && !neighbors.empty(); ++i) {
      const auto other =
          static_cast<std::size_t>(neighbors[rng.below(static_cast<std::uint32_t>(neighbors.size()))].index);
      if (other != seed)
        try_dipole({scene_.points[seed], scene_.normals[seed], scene_.points[other], scene_.normals[other]}, rng,
                   found);
    }
  }
  return found;
}

// Objects whose bin holds many are drawn from.
void DipoleSearch::try_dipole(const Dipole& seen, Rng& rng, std::vector<PoseCandidate>& found) const {
  const auto bin = dipole_bin(seen, table_.max_length_m());
  const int first = probe_.pixel_of(seen.p1);
  const int second = probe_.pixel_of(seen.p2);
  if (!bin || first < 0 || second < 0) return;
  const std::span<const DipoleEntry> entries = table_.find(*bin);
  for (std::size_t begin = 0; begin < entries.size();) {
    std::size_t end = begin;
    while (end < entries.size() && entries[end].object == entries[begin].object) ++end;
    const auto count = static_cast<std::uint32_t>(end - begin);
    const auto tries = std::min(count, static_cast<std::uint32_t>(options_.max_entries));
    for (std::uint32_t t = 0; t < tries; ++t)
      try_entry(entries[begin + (tries == count ? t : rng.below(count))], seen, probe_.lab(first), probe_.lab(second),
                found);
    begin = end;
  }
}

void DipoleSearch::try_entry(const DipoleEntry& entry, const Dipole& seen, const LabColor& first,
                             const LabColor& second, std::vector<PoseCandidate>& found) const {
  const ProbeModel& model = objects_[entry.object];
  const float max_chroma = static_cast<float>(options_.coarse.max_chroma_difference);
  if (!model.lab.empty() && std::max(chroma_difference_sq(model.lab[entry.first], first),
                                     chroma_difference_sq(model.lab[entry.second], second)) > max_chroma * max_chroma)
    return;
  const auto pose = align(
      {model.points[entry.first], model.normals[entry.first], model.points[entry.second], model.normals[entry.second]},
      seen);
  if (!pose) return;
  if (const auto candidate = first_test(entry.object, model, *pose, probe_, options_.coarse, options_.min_coarse_score))
    found.push_back(*candidate);
}

}  // namespace resight
