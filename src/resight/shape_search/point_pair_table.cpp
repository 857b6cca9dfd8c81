// SPDX-License-Identifier: Apache-2.0
#include "resight/shape_search/point_pair_table.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "resight/core/check.hpp"

namespace resight {
namespace {

constexpr double kDistanceBin_m = 0.01;     // A few times the depth noise at 1 m.
constexpr std::uint32_t kAngleBins = 10;    // Of 0 to 180 deg.
constexpr std::uint32_t kTorsionBins = 20;  // Of 360 deg.
constexpr float kFlatCosine = 0.26F;        // 15 deg.
constexpr float kMinSquare = 0.2F;          // Part of a normal that is square to the line.

std::uint32_t bin_of(float value, float range, std::uint32_t bins) {
  const float scaled = value / range * static_cast<float>(bins);
  return std::min(bins - 1, static_cast<std::uint32_t>(std::max(0.0F, scaled)));
}

std::uint32_t num_distance_bins(double max_length_m) {
  return static_cast<std::uint32_t>(std::ceil(max_length_m / kDistanceBin_m)) + 1;
}

// Columns: the line, the part of the normals' sum that is square to it, and what completes them.
std::optional<Eigen::Matrix3f> frame_of(const OrientedPointPair& d) {
  const Eigen::Vector3f line = (d.p2 - d.p1).normalized();
  Eigen::Vector3f up = d.n1 + d.n2;
  up -= line * line.dot(up);
  const float length = up.norm();
  if (!(length > kMinSquare)) return std::nullopt;
  up /= length;
  Eigen::Matrix3f frame;
  frame << line, up, line.cross(up);
  return frame;
}

}  // namespace

std::uint32_t num_point_pair_bins(double max_length_m) {
  return num_distance_bins(max_length_m) * kAngleBins * kAngleBins * kTorsionBins;
}

std::optional<std::uint32_t> point_pair_bin(const OrientedPointPair& d, double max_length_m) {
  const Eigen::Vector3f offset = d.p2 - d.p1;
  const float distance = offset.norm();
  if (!(distance >= static_cast<float>(kDistanceBin_m)) || distance > static_cast<float>(max_length_m))
    return std::nullopt;
  const Eigen::Vector3f line = offset / distance;
  const float c1 = line.dot(d.n1);
  const float c2 = line.dot(d.n2);
  if (d.n1.dot(d.n2) > 1 - 0.5F * kFlatCosine * kFlatCosine && std::abs(c1) < kFlatCosine) return std::nullopt;
  constexpr float kPi = std::numbers::pi_v<float>;
  const float a1 = std::acos(std::clamp(c1, -1.0F, 1.0F));
  const float a2 = std::acos(std::clamp(c2, -1.0F, 1.0F));
  const Eigen::Vector3f q1 = d.n1 - line * c1;
  const Eigen::Vector3f q2 = d.n2 - line * c2;
  const float torsion = std::atan2(line.dot(q1.cross(q2)), q1.dot(q2)) + kPi;
  const std::uint32_t distance_bin = static_cast<std::uint32_t>(distance / static_cast<float>(kDistanceBin_m));
  return ((distance_bin * kAngleBins + bin_of(a1, kPi, kAngleBins)) * kAngleBins + bin_of(a2, kPi, kAngleBins)) *
             kTorsionBins +
         bin_of(torsion, 2 * kPi, kTorsionBins);
}

std::optional<Rigid3f> align(const OrientedPointPair& from, const OrientedPointPair& onto) {
  const auto a = frame_of(from);
  const auto b = frame_of(onto);
  if (!a || !b) return std::nullopt;
  Rigid3f motion{Rigid3{}};
  motion.rotation = *b * a->transpose();
  motion.translation = 0.5F * (onto.p1 + onto.p2) - motion.rotation * (0.5F * (from.p1 + from.p2));
  return motion;
}

PointPairTable::PointPairTable(std::span<const Samples> objects) {
  require(objects.size() <= std::numeric_limits<std::uint16_t>::max(), "PointPairTable: too many objects");
  for (const Samples& s : objects) max_length_m_ = std::max(max_length_m_, s.max_length_m);
  std::vector<std::pair<std::uint32_t, PointPairEntry>> found;
  for (std::size_t o = 0; o < objects.size(); ++o) {
    const Samples& s = objects[o];
    require(s.points.size() <= std::numeric_limits<std::uint16_t>::max() && s.points.size() == s.normals.size(),
            "PointPairTable: too many samples, or not as many normals");
    for (std::size_t i = 0; i < s.points.size(); ++i)
      for (std::size_t j = 0; j < s.points.size(); ++j) {
        const double distance = (s.points[i] - s.points[j]).norm();
        if (i == j || distance < s.min_length_m || distance > s.max_length_m) continue;
        if (const auto bin = point_pair_bin({s.points[i], s.normals[i], s.points[j], s.normals[j]}, max_length_m_))
          found.push_back(
              {*bin, {static_cast<std::uint16_t>(o), static_cast<std::uint16_t>(i), static_cast<std::uint16_t>(j)}});
      }
  }
  begin_.assign(num_point_pair_bins(max_length_m_) + 1, 0);
  for (const auto& [bin, entry] : found) ++begin_[bin + 1];
  for (std::size_t b = 1; b < begin_.size(); ++b) begin_[b] += begin_[b - 1];
  entries_.resize(found.size());
  std::vector<std::uint32_t> next(begin_.begin(), begin_.end() - 1);
  for (const auto& [bin, entry] : found) entries_[next[bin]++] = entry;
}

std::span<const PointPairEntry> PointPairTable::find(std::uint32_t bin) const {
  return std::span(entries_).subspan(begin_[bin], begin_[bin + 1] - begin_[bin]);
}

}  // namespace resight
