// SPDX-License-Identifier: Apache-2.0
#include "change_run.hpp"

#include <utility>

#include "resight/recognition/stage_options.hpp"

namespace resight::bench {
namespace {

DynamicSceneOptions options_with_changes(const RecognizerConfig& config) {
  DynamicSceneOptions options = scene_options(config);
  options.detect_changes = true;
  return options;
}

}  // namespace

ChangeRun::ChangeRun(const RecognizerConfig& config, const Sequence& sequence)
    : prepare_(config.prepare),
      camera_errors_(
          measure_camera_errors(sequence, config.prepare, config.camera.color_offset, config.camera.depth_bias)),
      voxel_m_(config.changes.detection.voxel_m),
      scene_(options_with_changes(config)) {}

ChangeResult ChangeRun::add_view(RgbdFrame frame) {
  const Rigid3 given = frame.world_from_camera;
  ChangeResult changes = scene_.add_view(prepare_corrected(std::move(frame), camera_errors_, prepare_));
  if (this->frame().world_from_camera.matrix() != given.matrix()) ++num_corrected_;
  return changes;
}

}  // namespace resight::bench
