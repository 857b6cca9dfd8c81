// SPDX-License-Identifier: Apache-2.0
#include "resight/reconstruction/dynamic_scene.hpp"

#include <algorithm>
#include <iterator>
#include <utility>
#include <vector>

#include "resight/core/check.hpp"
#include "resight/core/parallel.hpp"

namespace resight {
namespace {

// Sensor noise adds voxels beside surfaces in every view, and a moving camera leaves voxels behind. Numbering restarts
// when the number of blocks exceeds this growth, which bounds the memory.
constexpr std::size_t kMaxBlockGrowth = 2;
constexpr std::size_t kFewBlocks = 1 << 15;

/// Clears removed points from an earlier view. In large scenes, most views do not see the place at all.
void clear(const PointCloud& removed_in_world, const DynamicSceneOptions& options, DynamicScene::View& view) {
  const std::size_t num_before = count_valid(view.cleared.frame.depth_m);
  view.cleared =
      clear_removed_points(std::move(view.cleared), removed_in_world, options.clear_tolerance_m, options.prepare);
  if (count_valid(view.cleared.frame.depth_m) != num_before)
    update_voxels(view.cleared, view.voxels, options.integrate);
}

/// A single view has nothing to be aligned to.
CorrectCameraOptions correction_options(const DynamicSceneOptions& options) {
  CorrectCameraOptions correction = options.poses;
  correction.correct &= options.num_previous_views > 0;
  return correction;
}

}  // namespace

void DynamicSceneOptions::check() const {
  check_not_negative("DynamicSceneOptions.num_previous_views", num_previous_views);
  check_positive("DynamicSceneOptions.clear_tolerance_m", clear_tolerance_m);
  poses.check();
  prepare.check();
  changes.check();
  integrate.check();
}

DynamicScene::DynamicScene(const DynamicSceneOptions& options)
    : options_(options), corrector_(correction_options(options)) {
  options_.check();
}

std::vector<int> DynamicScene::view_numbers() const {
  std::vector<int> numbers;
  for (const View& view : window_) numbers.push_back(view.number);
  return numbers;
}

ChangeResult DynamicScene::add_view(PreparedView view, StageTimes* times) {
  check_prepared(view);  // Before it changes anything.
  StageTimes own;
  StageTimes& measured = times != nullptr ? *times : own;
  CorrectedCamera camera;
  {
    const ScopedTimer timer(measured, "poses");
    camera = corrector_.add_view(view);
    view.frame.world_from_camera = camera.world_from_camera;
  }
  const ScopedTimer timer(measured, "changes and reconstruction");
  ChangeResult changes = add_at_pose(std::move(view), is_known_still(camera));
  window_.back().pose_correction = camera.correction;
  return changes;
}

void DynamicScene::forget_views() {
  corrector_ = CameraCorrector(correction_options(options_));
  window_.clear();
  reconstruct();
}

// Whether the camera stands where it was: the user says so, or what has not changed before it confirms that.
bool DynamicScene::is_known_still(const CorrectedCamera& camera) const {
  const auto known = std::find_if(window_.rbegin(), window_.rend(), [](const View& v) { return !v.is_suspect; });
  return (options_.poses.fixed || camera.correction.is_measured) && known != window_.rend() &&
         is_same_pose(known->raw.world_from_camera, camera.world_from_camera);
}

// Psi_{k-1} is reconstructed from the views before. With K = 0 there is nothing to compare with. Before a still camera,
// most of the scene may change, or be hidden by a hand.
ChangeResult DynamicScene::find_changes(const PreparedView& view, bool is_still) {
  if (!options_.detect_changes || options_.num_previous_views == 0 || window_.empty()) return {};
  ChangeResult changes = compare_with(false, view, is_still);
  if (!window_.back().is_suspect) return changes;
  if (changes.pose_suspect) {
    ChangeResult confirmed = compare_with(true, view, false);
    if (!confirmed.pose_suspect) {
      window_.erase(window_.begin(), std::prev(window_.end()));
      window_.back().is_suspect = false;
      return confirmed;
    }
  }
  window_.pop_back();
  return changes;
}

// With the suspect view of the window, or with the others.
ChangeResult DynamicScene::compare_with(bool is_suspect, const PreparedView& view, bool is_still) {
  std::vector<const PreparedView*> earlier_views;
  std::vector<const ViewVoxels*> voxels;
  for (const View& earlier : window_) {
    if (earlier.is_suspect != is_suspect) continue;
    earlier_views.push_back(&earlier.cleared);
    voxels.push_back(&earlier.voxels);
  }
  Reconstruction part;
  const bool is_whole = voxels.size() == window_.size();
  if (!is_whole) merger_.merge(voxels, options_.integrate, part);
  DetectChangesOptions options = options_.changes;
  if (is_still) options.max_changed_share = 1;
  return detect_changes((is_whole ? reconstruction_ : part).cloud_in_world, view, options, earlier_views,
                        options_.integrate.voxel_m);
}

void DynamicScene::clear_from_window(const PointCloud& removed_in_world) {
  while (static_cast<int>(window_.size()) > options_.num_previous_views) window_.pop_front();
  if (removed_in_world.empty()) return;
  parallel_for(window_.size(), options_.integrate.num_threads,
               [&](std::size_t i) { clear(removed_in_world, options_, window_[i]); });
}

ChangeResult DynamicScene::add_at_pose(PreparedView view, bool is_still) {
  ChangeResult changes;
  ViewVoxels voxels;
  // Runs both at once: change detection and clearing number no voxels, and clearing does not affect the new view.
  run_both(
      options_.integrate.num_threads, [&] { voxels = reduce_to_voxels(view, numbers_, options_.integrate); },
      [&] {
        changes = find_changes(view, is_still);
        clear_from_window(changes.removed_in_world);
      });
  RgbdFrame raw = view.frame;
  window_.push_back({num_views_++, std::move(raw), std::move(view), changes.removed_in_world, changes.novel_in_world,
                     std::move(voxels)});
  window_.back().is_suspect = changes.pose_suspect;
  reconstruct();
  return changes;
}

void DynamicScene::reconstruct() {
  const bool starts_anew = numbers_.num_blocks() > kMaxBlockGrowth * num_blocks_at_start_ + kFewBlocks;
  if (starts_anew) {
    numbers_ = {};
    for (View& view : window_) view.voxels.numbers.clear();
  }
  std::vector<const ViewVoxels*> views;
  for (View& view : window_) {
    numbers_.assign_to(view.voxels);
    views.push_back(&view.voxels);
  }
  if (starts_anew) num_blocks_at_start_ = numbers_.num_blocks();
  merger_.merge(views, options_.integrate, reconstruction_);
}

}  // namespace resight
