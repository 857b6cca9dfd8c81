// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <vector>

#include "resight/features/feature_set.hpp"
#include "resight/hypotheses/generation.hpp"
#include "resight/recognition/recognizer_config.hpp"
#include "resight/reconstruction/dynamic_scene.hpp"
#include "resight/shape_search/shape_search.hpp"
#include "resight/simulation/procedural_objects.hpp"

namespace resight::bench {

/// The simulated demo scene, its models, and the input of each stage of preset `default` for its last view. Created
/// once per run (some tens of seconds) from a seed: the same on every machine.
struct DemoScene {
  RecognizerConfig config;
  std::vector<ProceduralObject> objects;
  ModelLibrary library;
  std::vector<PreparedView> views;
  std::unique_ptr<DynamicScene> scene;  ///< State after all views but the last.
  FeatureSet sift;                      ///< Of the last view, like all fields below.
  FeatureSet shot;
  std::unique_ptr<ModelFeatureIndex> index;
  std::unique_ptr<ShapeSearch> shapes;
  std::vector<std::vector<Correspondence>> correspondences;
  std::vector<Hypothesis> hypotheses;  ///< From features.
};

[[nodiscard]] const DemoScene& demo_scene();

}  // namespace resight::bench
