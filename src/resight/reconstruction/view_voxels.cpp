// SPDX-License-Identifier: Apache-2.0
#include "resight/reconstruction/view_voxels.hpp"

#include <algorithm>
#include <numeric>

#include "resight/core/check.hpp"

namespace resight {
namespace {

constexpr int kNoSlot = -1;

/// Not inlined: a point must round identically when its voxel is found and when it is stored.
[[gnu::noinline]] Eigen::Vector3f point_in_world(const Rigid3f& world_from_camera, const OrganizedCloud& cloud,
                                                 std::size_t i) {
  return world_from_camera * cloud.point(i);
}

/// Keys of the voxels that contain the points of a view.
class PixelKeys {
 public:
  PixelKeys(const PreparedView& view, const IntegrateOptions& options)
      : cloud_(view.cloud),
        world_from_camera_(view.frame.world_from_camera),
        inverse_size_(static_cast<float>(1.0 / options.voxel_m)) {}
  [[nodiscard]] std::uint64_t operator()(std::size_t i) const {
    return voxel_key(point_in_world(world_from_camera_, cloud_, i), inverse_size_);
  }

 private:
  const OrganizedCloud& cloud_;
  Rigid3f world_from_camera_;
  float inverse_size_;
};

bool takes_part(const PreparedView& view, std::size_t i, float min_edge_distance_px) {
  return view.cloud.has_normal(i) && view.cloud.has_point(i) && !(view.edge_distance_px[i] < min_edge_distance_px);
}

/// Selects the best pixel of each slot.
class Winners {
 public:
  Winners(const PreparedView& view, ViewVoxels& voxels) : view_(view), voxels_(voxels) {}

  /// Makes room for new slots.
  void grow() {
    const std::size_t size = voxels_.keys.size();
    voxels_.noise.resize(size);
    voxels_.num_points.resize(size);
    voxels_.first_pixels.resize(size);
    pixels_.resize(size);
  }
  /// Pixels of one slot must be added in ascending order.
  void add(std::size_t slot, std::size_t pixel) {
    const float lateral_m = view_.noise.lateral_m[pixel];
    const float noise = lateral_m * lateral_m * view_.noise.axial_m[pixel];
    const bool is_first = voxels_.num_points[slot]++ == 0;
    if (is_first) voxels_.first_pixels[slot] = static_cast<int>(pixel);
    if (!is_first && !(noise < voxels_.noise[slot])) return;
    voxels_.noise[slot] = noise;
    pixels_[slot] = static_cast<int>(pixel);
  }
  /// Not inlined: a normal must round identically in reduce_to_voxels() and in update_voxels().
  [[gnu::noinline]] void keep(std::size_t slot) {
    const auto i = static_cast<std::size_t>(pixels_[slot]);
    voxels_.cloud_in_world.points[slot] = point_in_world(world_from_camera_, view_.cloud, i);
    voxels_.cloud_in_world.normals[slot] = world_from_camera_.rotation * view_.cloud.normal(i);
    voxels_.cloud_in_world.colors[slot] = view_.surface_color()[i];
  }

 private:
  const PreparedView& view_;
  ViewVoxels& voxels_;
  Rigid3f world_from_camera_{view_.frame.world_from_camera};
  std::vector<int> pixels_;
};

void resize_cloud(ViewVoxels& voxels) {
  voxels.cloud_in_world.points.resize(voxels.keys.size());
  voxels.cloud_in_world.normals.resize(voxels.keys.size());
  voxels.cloud_in_world.colors.resize(voxels.keys.size());
}

/// Assigns slots to pixels that have joined, in existing or new voxels.
void place_joined(const std::vector<std::size_t>& joined, const PixelKeys& key_of, ViewVoxels& voxels) {
  if (joined.empty()) return;
  VoxelMap map(joined.size());
  for (const std::size_t i : joined) map.insert(key_of(i));
  std::vector<int> slots(map.size(), kNoSlot);
  for (std::size_t slot = 0; slot < voxels.keys.size(); ++slot)
    if (const int n = map.find(voxels.keys[slot]); n != VoxelMap::kNotFound)
      slots[static_cast<std::size_t>(n)] = static_cast<int>(slot);
  for (const std::size_t i : joined) {
    const std::uint64_t key = key_of(i);
    int& slot = slots[static_cast<std::size_t>(map.find(key))];
    if (slot == kNoSlot) {
      slot = static_cast<int>(voxels.keys.size());
      voxels.keys.push_back(key);
    }
    voxels.slot_of_pixel[i] = slot;
  }
}

/// Slots whose pixels have changed, without duplicates. Updates slot_of_pixel.
std::vector<int> find_changed_slots(const PreparedView& view, ViewVoxels& voxels, const IntegrateOptions& options) {
  const auto min_edge_distance_px = static_cast<float>(options.min_edge_distance_px);
  std::vector<int> changed;
  std::vector<std::size_t> joined;
  for (std::size_t i = 0; i < voxels.slot_of_pixel.size(); ++i) {
    int& slot = voxels.slot_of_pixel[i];
    const bool is_in = takes_part(view, i, min_edge_distance_px);
    if (is_in == (slot != kNoSlot)) continue;
    if (is_in) {
      joined.push_back(i);
    } else {
      changed.push_back(slot);
      slot = kNoSlot;
    }
  }
  place_joined(joined, PixelKeys(view, options), voxels);
  for (const std::size_t i : joined) changed.push_back(voxels.slot_of_pixel[i]);
  std::sort(changed.begin(), changed.end());
  changed.erase(std::unique(changed.begin(), changed.end()), changed.end());
  return changed;
}

/// `is_changed` per slot: these slots may have moved in the order, appeared or become empty.
void update_order(const std::vector<int>& changed, const std::vector<std::uint8_t>& is_changed, ViewVoxels& voxels) {
  const auto earlier = [&](int a, int b) { return voxels.first_pixels[a] < voxels.first_pixels[b]; };
  std::vector<int> moved;
  for (const int slot : changed)
    if (voxels.num_points[slot] > 0) moved.push_back(slot);
  std::sort(moved.begin(), moved.end(), earlier);
  std::erase_if(voxels.order, [&](int slot) { return is_changed[slot] != 0; });
  std::vector<int> order(voxels.order.size() + moved.size());
  std::merge(voxels.order.begin(), voxels.order.end(), moved.begin(), moved.end(), order.begin(), earlier);
  voxels.order = std::move(order);
}

}  // namespace

void check_prepared(const PreparedView& view) {
  const std::size_t size = view.cloud.z.size();
  require(view.cloud.nx.size() == size && view.frame.color.size() == size && view.edge_distance_px.size() == size &&
              view.noise.lateral_m.size() == size && view.noise.axial_m.size() == size,
          "integrate_views: a view is not prepared (its images differ in size from its cloud, or it has no normals)");
}

int VoxelNumbers::number_of(std::uint64_t key) {
  constexpr std::uint64_t kWithin = (3ULL << 42U) | (3ULL << 21U) | 3ULL;  // Two bits per axis; see voxel_key().
  const std::uint64_t block_key = key & ~kWithin;
  if (blocks_.empty() || block_key != last_block_key_) {
    last_block_key_ = block_key;
    last_block_ = static_cast<std::size_t>(block_map_.insert(block_key));
    if (last_block_ == blocks_.size()) blocks_.emplace_back().fill(kNone);
  }
  const std::uint64_t within = ((key >> 38U) & 48U) | ((key >> 19U) & 12U) | (key & 3U);
  int& number = blocks_[last_block_][within];
  if (number == kNone) number = num_voxels_++;
  return number;
}

int VoxelNumbers::slot_of(std::uint64_t key, ViewVoxels& view) {
  const auto number = static_cast<std::size_t>(number_of(key));
  if (number >= slot_of_number_.size()) slot_of_number_.resize(std::max(number + 1, 2 * slot_of_number_.size()));
  int& slot = slot_of_number_[number];
  // The entry may stem from another view. It is valid only if this view has the same number at that slot.
  const bool is_known =
      static_cast<std::size_t>(slot) < view.numbers.size() && view.numbers[slot] == static_cast<int>(number);
  if (!is_known) {
    slot = static_cast<int>(view.numbers.size());
    view.keys.push_back(key);
    view.numbers.push_back(static_cast<int>(number));
  }
  return slot;
}

void VoxelNumbers::assign_to(ViewVoxels& view) {
  for (std::size_t slot = view.numbers.size(); slot < view.keys.size(); ++slot)
    view.numbers.push_back(number_of(view.keys[slot]));
}

ViewVoxels reduce_to_voxels(const PreparedView& view, VoxelNumbers& numbers, const IntegrateOptions& options) {
  options.check();
  check_prepared(view);
  const PixelKeys key_of(view, options);
  const auto min_edge_distance_px = static_cast<float>(options.min_edge_distance_px);
  ViewVoxels voxels;
  voxels.slot_of_pixel.assign(view.cloud.z.size(), kNoSlot);
  std::uint64_t last_key = 0;
  // Neighbouring pixels often share a voxel, which saves the look-up.
  int slot = kNoSlot;
  for (std::size_t i = 0; i < view.cloud.z.size(); ++i) {
    if (!takes_part(view, i, min_edge_distance_px)) continue;
    const std::uint64_t key = key_of(i);
    if (slot == kNoSlot || key != last_key) slot = numbers.slot_of(key, voxels);
    last_key = key;
    voxels.slot_of_pixel[i] = slot;
  }
  Winners winners(view, voxels);
  winners.grow();
  resize_cloud(voxels);
  for (std::size_t i = 0; i < voxels.slot_of_pixel.size(); ++i)
    if (voxels.slot_of_pixel[i] != kNoSlot) winners.add(static_cast<std::size_t>(voxels.slot_of_pixel[i]), i);
  for (std::size_t s = 0; s < voxels.keys.size(); ++s) winners.keep(s);
  voxels.order.resize(voxels.keys.size());
  std::iota(voxels.order.begin(), voxels.order.end(), 0);  // Slots were created in the order of their first pixels.
  return voxels;
}

void update_voxels(const PreparedView& view, ViewVoxels& voxels, const IntegrateOptions& options) {
  options.check();
  check_prepared(view);
  require(voxels.slot_of_pixel.size() == view.cloud.z.size(),
          "update_voxels: the view differs in size from the one that was reduced");
  const std::vector<int> changed = find_changed_slots(view, voxels, options);
  if (changed.empty()) return;
  Winners winners(view, voxels);
  winners.grow();
  resize_cloud(voxels);
  std::vector<std::uint8_t> is_changed(voxels.keys.size());
  for (const int slot : changed) {
    is_changed[slot] = 1;
    voxels.num_points[slot] = 0;
  }
  for (std::size_t i = 0; i < voxels.slot_of_pixel.size(); ++i) {
    const int slot = voxels.slot_of_pixel[i];
    if (slot != kNoSlot && is_changed[slot] != 0) winners.add(static_cast<std::size_t>(slot), i);
  }
  for (const int slot : changed)
    if (voxels.num_points[slot] > 0) winners.keep(static_cast<std::size_t>(slot));
  update_order(changed, is_changed, voxels);
}

}  // namespace resight
