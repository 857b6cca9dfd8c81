// SPDX-License-Identifier: Apache-2.0
#include "resight/modelling/internal/distance_volume.hpp"

#include <cmath>

#include "resight/core/parallel.hpp"

namespace resight {
namespace {

using Eigen::Vector3f;
using Eigen::Vector3i;

// Weight of a view that looks past the object, where depth need not be accurate.
constexpr float kBackgroundWeight = 0.3F;

class BlockAllocator {
 public:
  explicit BlockAllocator(DistanceVolume& volume)
      : volume_(volume), inverse_size_(static_cast<float>(1 / (volume.voxel_m * DistanceVolume::kSide))) {}

  // Adds all blocks that the truncation band around a point reaches.
  void touch(const Vector3f& p) {
    const auto reach = static_cast<float>(volume_.truncation_m);
    const Vector3i low = voxel_index(p - Vector3f::Constant(reach), inverse_size_);
    const Vector3i high = voxel_index(p + Vector3f::Constant(reach), inverse_size_);
    if (low == last_low_ && high == last_high_) return;
    last_low_ = low;
    last_high_ = high;
    for (int z = low.z(); z <= high.z(); ++z)
      for (int y = low.y(); y <= high.y(); ++y)
        for (int x = low.x(); x <= high.x(); ++x) add({x, y, z});
  }

 private:
  void add(const Vector3i& index) {
    const int i = volume_.map.insert(voxel_key(index.x(), index.y(), index.z()));
    if (i < static_cast<int>(volume_.blocks.size())) return;
    volume_.blocks.emplace_back();
    volume_.blocks.back().index = index;
  }

  DistanceVolume& volume_;
  float inverse_size_;
  Vector3i last_low_ = Vector3i::Constant(1 << 30);
  Vector3i last_high_ = Vector3i::Constant(1 << 30);
};

// Integrates one view into one block.
class BlockIntegrator {
 public:
  BlockIntegrator(const FusionView& view, double voxel_m, double truncation_m)
      : view_(view),
        camera_from_object_(view.camera_from_object),
        voxel_m_(static_cast<float>(voxel_m)),
        truncation_m_(static_cast<float>(truncation_m)) {}

  void integrate(DistanceVolume::Block& block) const {
    if (!is_before_camera(block)) return;
    constexpr int kSide = DistanceVolume::kSide;
    const Vector3f step = voxel_m_ * camera_from_object_.rotation.col(0);
    for (int z = 0; z < kSide; ++z)
      for (int y = 0; y < kSide; ++y) {
        const Vector3i first = kSide * block.index + Vector3i(0, y, z);
        Vector3f p = camera_from_object_ * (voxel_m_ * first.cast<float>());
        for (int x = 0; x < kSide; ++x, p += step) observe(p, block, DistanceVolume::offset(x, y, z));
      }
  }

 private:
  // Rejects blocks that lie entirely outside the image.
  [[nodiscard]] bool is_before_camera(const DistanceVolume::Block& block) const {
    const float size_m = voxel_m_ * DistanceVolume::kSide;
    const Vector3f center = camera_from_object_ * (size_m * (block.index.cast<float>() + Vector3f::Constant(0.5F)));
    if (center.z() < 2 * size_m) return false;
    const Eigen::Vector2d pixel = view_.camera.project(center.cast<double>());
    const double margin_px = view_.camera.fx * size_m / (center.z() - size_m);
    return pixel.x() > -margin_px && pixel.y() > -margin_px && pixel.x() < view_.camera.width + margin_px &&
           pixel.y() < view_.camera.height + margin_px;
  }

  void observe(const Vector3f& p, DistanceVolume::Block& block, int voxel) const {
    const Camera& camera = view_.camera;
    const float inverse_z = 1 / p.z();
    const auto u = static_cast<float>(camera.fx) * p.x() * inverse_z + static_cast<float>(camera.cx) + 0.5F;
    const auto v = static_cast<float>(camera.fy) * p.y() * inverse_z + static_cast<float>(camera.cy) + 0.5F;
    if (!(u >= 0 && v >= 0 && u < static_cast<float>(camera.width) && v < static_cast<float>(camera.height))) return;
    const std::size_t pixel = view_.depth_m.index(static_cast<int>(u), static_cast<int>(v));
    const float depth = view_.depth_m[pixel];
    if (std::isnan(depth)) return;
    const float weight = view_.weight[pixel];
    if (weight <= 0) {
      if (depth - p.z() > 2 * truncation_m_) block.free[voxel] += kBackgroundWeight;
      return;
    }
    const float distance = (depth - p.z()) * view_.slope[pixel];
    if (distance > truncation_m_) {
      block.free[voxel] += weight;
    } else if (distance > -truncation_m_) {
      // The weight decreases behind the surface, where the other side of a thin wall may begin.
      const float w = distance >= 0 ? weight : weight * (1 + distance / truncation_m_);
      block.distance_m[voxel] += w * distance;  // Weighted sum; divided at the end.
      block.weight[voxel] += w;
      block.seen[voxel] += weight;
    }
  }

  const FusionView& view_;
  Rigid3f camera_from_object_;
  float voxel_m_;
  float truncation_m_;
};

}  // namespace

void allocate_blocks(DistanceVolume& volume, std::span<const FusionView> views) {
  BlockAllocator allocator(volume);
  for (const FusionView& view : views) {
    const Rigid3f object_from_camera(view.camera_from_object.inverse());
    for (int v = 0; v < view.depth_m.height(); ++v)
      for (int u = 0; u < view.depth_m.width(); ++u)
        if (view.weight(u, v) > 0)
          allocator.touch(object_from_camera * view.camera.unproject(u, v, view.depth_m(u, v)).cast<float>().eval());
  }
}

void integrate_views(DistanceVolume& volume, std::span<const FusionView> views, int num_threads) {
  std::vector<BlockIntegrator> integrators;
  for (const FusionView& view : views) integrators.emplace_back(view, volume.voxel_m, volume.truncation_m);
  parallel_for_blocks(volume.blocks.size(), 32, num_threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      DistanceVolume::Block& block = volume.blocks[i];
      for (const BlockIntegrator& integrator : integrators) integrator.integrate(block);
      for (int k = 0; k < DistanceVolume::kVoxels; ++k)
        if (block.weight[k] > 0) block.distance_m[k] /= block.weight[k];
    }
  });
}

}  // namespace resight
