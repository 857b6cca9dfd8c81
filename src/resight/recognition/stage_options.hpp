// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "resight/recognition/recognizer_config.hpp"
#include "resight/recognition/search_planner.hpp"
#include "resight/reconstruction/dynamic_scene.hpp"

namespace resight {

/// The config with its seeds set to RecognizerConfig::run.seed. Throws std::invalid_argument if it fails check().
[[nodiscard]] RecognizerConfig checked_and_seeded(RecognizerConfig config);

/// Options of single stages that depend on several settings of the recogniser.
[[nodiscard]] DynamicSceneOptions scene_options(const RecognizerConfig& config);
/// Searches every view everywhere unless objects are remembered.
[[nodiscard]] SearchPlanner make_search_planner(const ModelLibrary& library, const RecognizerConfig& config);

}  // namespace resight
