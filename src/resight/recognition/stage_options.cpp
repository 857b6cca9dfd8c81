// SPDX-License-Identifier: Apache-2.0
#include "resight/recognition/stage_options.hpp"

namespace resight {

RecognizerConfig checked_and_seeded(RecognizerConfig config) {
  config.check();
  config.set_seed(config.run.seed);
  return config;
}

DynamicSceneOptions scene_options(const RecognizerConfig& config) {
  return {.num_previous_views = config.num_previous_views,
          .detect_changes = config.changes.enabled,
          .clear_tolerance_m = config.changes.clear_tolerance_m,
          .poses = config.camera.poses,
          .prepare = config.prepare,
          .changes = config.changes.detection,
          .integrate = config.integrate};
}

SearchPlanner make_search_planner(const ModelLibrary& library, const RecognizerConfig& config) {
  const auto max_searches = static_cast<std::size_t>(config.num_previous_views) + 1;
  return {library, config.remembers() ? config.search : SearchPlannerOptions{}, config.history.presence,
          TrackCorrespondences(max_searches, config.verify.support.max_distance_m)};
}

}  // namespace resight
