// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <vector>

#include "resight/recognition/recognizer_config.hpp"
#include "resight/sensor/sequence.hpp"

namespace resight::bench {

/// Ground truth of one view per pixel; images are empty if it is unknown.
struct ViewTruth {
  Image<Eigen::Vector3f> normals_in_camera;  ///< Of the surface at the pixel centre; NaN = none.
  Image<std::uint8_t> is_thing;              ///< Non-zero: neither room nor furniture.
  /// Non-zero: an object that is absent from the other view, or at another place.
  Image<std::uint8_t> is_changed;
};

/// Two views of a scene, and the input of each stage of preset `default` for the second one. One thread.
struct StageInput {
  RecognizerConfig config;
  PreparedView before, view;
  ViewTruth truth_before, truth;
  std::vector<GroundTruthObject> objects;  ///< Of `view`; empty if unknown.
  /// If empty, the stages that need models are skipped, and the fields below stay empty.
  ModelLibrary library;
  FeatureSet sift, shot;
  std::vector<std::vector<Correspondence>> correspondences;  ///< Per object; scene side in the camera frame.
  std::vector<Hypothesis> hypotheses;
};

/// Two views of the generated demo scene, a seventh of its arc apart: a tea box appears, a can disappears.
[[nodiscard]] StageInput make_demo_input();

/// Two views of a recorded sequence; `library_file` may be empty.
[[nodiscard]] StageInput read_input(const std::filesystem::path& sequence, int before, int view,
                                    const std::filesystem::path& library_file);

}  // namespace resight::bench
