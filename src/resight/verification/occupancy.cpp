// SPDX-License-Identifier: Apache-2.0
#include "resight/verification/occupancy.hpp"

#include <algorithm>
#include <limits>

#include "resight/core/check.hpp"
#include "resight/core/parallel.hpp"
#include "resight/geometry/voxel_map.hpp"

namespace resight {
namespace {

constexpr float kContactDot = -0.5F;  // Normals more than 120 deg apart are those of two objects that touch.

struct Box {
  Eigen::Vector3f min = Eigen::Vector3f::Constant(std::numeric_limits<float>::infinity());
  Eigen::Vector3f max = Eigen::Vector3f::Constant(-std::numeric_limits<float>::infinity());
  [[nodiscard]] bool overlaps(const Box& other) const {
    return (min.array() <= other.max.array()).all() && (other.min.array() <= max.array()).all();
  }
};

// The voxels of one placed model with the sum of the normals in each.
struct Shell {
  VoxelMap map;
  std::vector<std::uint64_t> keys;
  std::vector<Eigen::Vector3f> normals;  // Unit; zero without normals.
};

Box find_box(const PlacedModel& model, double voxel_m) {
  const Rigid3f motion(model.world_from_object);
  Box box;
  for (const Eigen::Vector3f& p : model.surface_in_object->points) {
    const Eigen::Vector3f q = motion * p;
    box.min = box.min.cwiseMin(q);
    box.max = box.max.cwiseMax(q);
  }
  box.max.array() += static_cast<float>(voxel_m);  // Boxes a voxel apart may share one.
  return box;
}

Shell make_shell(const PlacedModel& model, double voxel_m) {
  const PointCloud& surface = *model.surface_in_object;
  const Rigid3f motion(model.world_from_object);
  const float inverse_voxel = static_cast<float>(1.0 / voxel_m);
  Shell shell{VoxelMap(surface.size() / 2), {}, {}};
  for (std::size_t i = 0; i < surface.size(); ++i) {
    const std::uint64_t key = voxel_key(motion * surface.points[i], inverse_voxel);
    const int v = shell.map.insert(key);
    if (static_cast<std::size_t>(v) == shell.keys.size()) {
      shell.keys.push_back(key);
      shell.normals.emplace_back(Eigen::Vector3f::Zero());
    }
    if (surface.has_normals()) shell.normals[v] += motion.rotation * surface.normals[i];
  }
  for (Eigen::Vector3f& n : shell.normals) n.normalize();
  return shell;
}

int count_shared(const Shell& a, const Shell& b) {
  int count = 0;
  for (std::size_t i = 0; i < a.keys.size(); ++i) {
    const int other = b.map.find(a.keys[i]);
    if (other != VoxelMap::kNotFound && a.normals[i].dot(b.normals[other]) >= kContactDot) ++count;
  }
  return count;
}

}  // namespace

std::vector<SharedVoxels> count_shared_voxels(std::span<const PlacedModel> models, double voxel_m, int num_threads) {
  check_positive("voxel_m", voxel_m);
  std::vector<Box> boxes(models.size());
  parallel_for(models.size(), num_threads, [&](std::size_t i) { boxes[i] = find_box(models[i], voxel_m); });
  std::vector<SharedVoxels> pairs;
  std::vector<std::uint8_t> needed(models.size(), 0);
  for (std::size_t a = 0; a < models.size(); ++a)
    for (std::size_t b = a + 1; b < models.size(); ++b)
      if (boxes[a].overlaps(boxes[b])) {
        pairs.push_back({static_cast<int>(a), static_cast<int>(b), 0});
        needed[a] = needed[b] = 1;
      }
  std::vector<Shell> shells(models.size());
  parallel_for(models.size(), num_threads, [&](std::size_t i) {
    if (needed[i] != 0) shells[i] = make_shell(models[i], voxel_m);
  });
  parallel_for(pairs.size(), num_threads,
               [&](std::size_t i) { pairs[i].count = count_shared(shells[pairs[i].a], shells[pairs[i].b]); });
  std::erase_if(pairs, [](const SharedVoxels& pair) { return pair.count == 0; });
  return pairs;
}

}  // namespace resight
