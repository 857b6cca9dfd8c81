// SPDX-License-Identifier: Apache-2.0
#include "resight/modelling/internal/surface_nets.hpp"

#include <array>
#include <cmath>
#include <limits>

namespace resight {
namespace {

using Eigen::Vector3f;
using Eigen::Vector3i;

constexpr int kSide = DistanceVolume::kSide;
constexpr int kPadded = kSide + 1;  // A block and the first voxels of its neighbours.
constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();

using PaddedBlock = std::array<float, static_cast<std::size_t>(kPadded) * kPadded * kPadded>;

int padded(int x, int y, int z) { return (z * kPadded + y) * kPadded + x; }
int padded(const Vector3i& p) { return padded(p.x(), p.y(), p.z()); }

class SurfaceNets {
 public:
  SurfaceNets(const DistanceVolume& volume, const KnownVoxelRule& rule) : volume_(volume), rule_(rule) {}

  TriangleMesh extract() {
    PaddedBlock values;
    for (const DistanceVolume::Block& block : volume_.blocks)
      if (gather(block, values)) add_vertices(block.index, values);
    for (const DistanceVolume::Block& block : volume_.blocks)
      if (gather(block, values)) add_faces(block.index, values);
    return std::move(mesh_);
  }

 private:
  [[nodiscard]] float value(const DistanceVolume::Block& block, int voxel) const {
    if (block.seen[voxel] < rule_.min_weight) {
      // No surface nearby: free if free space was observed with sufficient weight.
      return block.free[voxel] >= rule_.min_weight ? static_cast<float>(volume_.truncation_m) : kUnknown;
    }
    if (block.free[voxel] > rule_.max_free_share * block.seen[voxel])
      return std::max(block.distance_m[voxel], 0.5F * static_cast<float>(volume_.voxel_m));
    return block.distance_m[voxel];
  }

  // Copies a block and its margin. False if all known values have the same sign.
  bool gather(const DistanceVolume::Block& block, PaddedBlock& values) const {
    bool has_inside = false;
    bool has_outside = false;
    for (int corner = 0; corner < 8; ++corner) {
      const Vector3i shift(corner & 1, (corner >> 1) & 1, corner >> 2);
      const DistanceVolume::Block* source = corner == 0 ? &block : volume_.find(block.index + shift);
      const Vector3i begin = kSide * shift;
      const Vector3i end = begin + Vector3i(shift.x() ? 1 : kSide, shift.y() ? 1 : kSide, shift.z() ? 1 : kSide);
      for (int z = begin.z(); z < end.z(); ++z)
        for (int y = begin.y(); y < end.y(); ++y)
          for (int x = begin.x(); x < end.x(); ++x) {
            const float d = source == nullptr
                                ? kUnknown
                                : value(*source, DistanceVolume::offset(x - begin.x(), y - begin.y(), z - begin.z()));
            values[padded(x, y, z)] = d;
            has_inside |= d < 0;
            has_outside |= d >= 0;
          }
    }
    return has_inside && has_outside;
  }

  void add_vertices(const Vector3i& block, const PaddedBlock& values) {
    for (int z = 0; z < kSide; ++z)
      for (int y = 0; y < kSide; ++y)
        for (int x = 0; x < kSide; ++x) add_vertex(block, {x, y, z}, values);
  }

  void add_vertex(const Vector3i& block, const Vector3i& cell, const PaddedBlock& values) {
    std::array<float, 8> d;
    int inside = 0;
    for (int corner = 0; corner < 8; ++corner) {
      d[corner] = values[padded(cell + Vector3i(corner & 1, (corner >> 1) & 1, corner >> 2))];
      if (std::isnan(d[corner])) return;
      inside += d[corner] < 0;
    }
    if (inside == 0 || inside == 8) return;
    Vector3f sum = Vector3f::Zero();
    int crossings = 0;
    for (int a = 0; a < 8; ++a)
      for (int axis = 0; axis < 3; ++axis) {
        const int b = a | (1 << axis);
        if (b == a || (d[a] < 0) == (d[b] < 0)) continue;
        Vector3f p(static_cast<float>(a & 1), static_cast<float>((a >> 1) & 1), static_cast<float>(a >> 2));
        p[axis] += d[a] / (d[a] - d[b]);
        sum += p;
        ++crossings;
      }
    const Vector3i voxel = kSide * block + cell;
    vertex_of_cell_.insert(voxel_key(voxel.x(), voxel.y(), voxel.z()));
    mesh_.vertices.push_back(static_cast<float>(volume_.voxel_m) *
                             (voxel.cast<float>() + sum / static_cast<float>(crossings)));
  }

  void add_faces(const Vector3i& block, const PaddedBlock& values) {
    for (int z = 0; z < kSide; ++z)
      for (int y = 0; y < kSide; ++y)
        for (int x = 0; x < kSide; ++x)
          for (int axis = 0; axis < 3; ++axis) {
            const Vector3i a(x, y, z);
            const float from = values[padded(a)];
            const float to = values[padded(a + Vector3i::Unit(axis))];
            if (std::isnan(from) || std::isnan(to) || (from < 0) == (to < 0)) continue;
            add_quad(kSide * block + a, axis, from < 0);
          }
  }

  // Adds the quad of the four cells around the edge from `voxel` along `axis`. `is_outward`: the edge points outwards.
  void add_quad(const Vector3i& voxel, int axis, bool is_outward) {
    const Vector3i side = Vector3i::Unit((axis + 1) % 3);
    const Vector3i up = Vector3i::Unit((axis + 2) % 3);
    std::array<int, 4> q{};
    const std::array<Vector3i, 4> cells{voxel - side - up, voxel - up, voxel, voxel - side};
    for (int k = 0; k < 4; ++k) {
      q[k] = vertex_of_cell_.find(voxel_key(cells[k].x(), cells[k].y(), cells[k].z()));
      if (q[k] == VoxelMap::kNotFound) return;
    }
    if (!is_outward) std::swap(q[1], q[3]);
    // Split along the shorter diagonal.
    const auto length = [&](int a, int b) { return (mesh_.vertices[q[a]] - mesh_.vertices[q[b]]).squaredNorm(); };
    if (length(0, 2) <= length(1, 3)) {
      mesh_.faces.push_back({q[0], q[1], q[2]});
      mesh_.faces.push_back({q[0], q[2], q[3]});
    } else {
      mesh_.faces.push_back({q[0], q[1], q[3]});
      mesh_.faces.push_back({q[1], q[2], q[3]});
    }
  }

  const DistanceVolume& volume_;
  KnownVoxelRule rule_;
  TriangleMesh mesh_;
  VoxelMap vertex_of_cell_;
};

}  // namespace

TriangleMesh extract_surface_nets(const DistanceVolume& volume, const KnownVoxelRule& rule) {
  return SurfaceNets(volume, rule).extract();
}

}  // namespace resight
