// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "resight/geometry/rigid3.hpp"

namespace resight {

/// Two points with unit normals (Winkelbach, Molkenstruck and Wahl 2006).
struct OrientedPointPair {
  Eigen::Vector3f p1, n1, p2, n2;
};

/// Bin of the four numbers that a rigid motion leaves as they are: distance, the angles of both normals with the line
/// between the points, and the torsion of the normals about it. None for points nearer than a bin (1 cm) or farther
/// apart than `max_length_m`, and for what fixes no pose: both normals alike and square to the line (a plane).
[[nodiscard]] std::optional<std::uint32_t> point_pair_bin(const OrientedPointPair& pair, double max_length_m);
[[nodiscard]] std::uint32_t num_point_pair_bins(double max_length_m);

/// Rotation and translation that put `from` onto `onto`: middle on middle, line on line, and the mean of the normals as
/// near as that leaves. None if the normals have no part square to the line.
[[nodiscard]] std::optional<Rigid3f> align(const OrientedPointPair& from, const OrientedPointPair& onto);

/// A pair of samples of an object.
struct PointPairEntry {
  std::uint16_t object = 0;
  std::uint16_t first = 0;
  std::uint16_t second = 0;
};

/// Pairs of samples of all objects by bin.
class PointPairTable {
 public:
  struct Samples {
    std::span<const Eigen::Vector3f> points;
    std::span<const Eigen::Vector3f> normals;
    double min_length_m = 0;  ///< Of a pair: inclusive.
    double max_length_m = 0;  ///< Of a pair: inclusive.
  };
  PointPairTable() = default;
  /// At most 65,535 objects with as many samples each.
  explicit PointPairTable(std::span<const Samples> objects);

  /// In the order of objects.
  [[nodiscard]] std::span<const PointPairEntry> find(std::uint32_t bin) const;
  [[nodiscard]] double max_length_m() const { return max_length_m_; }
  [[nodiscard]] std::size_t size() const { return entries_.size(); }

 private:
  double max_length_m_ = 0;
  std::vector<std::uint32_t> begin_;  // Per bin, and one more.
  std::vector<PointPairEntry> entries_;
};

}  // namespace resight
