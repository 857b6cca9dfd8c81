// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "resight/hypotheses/generation.hpp"
#include "resight/io/sequence.hpp"
#include "resight/recognition/recognizer_config.hpp"

namespace resight::bench {

/// What the truth says of one view, pixel by pixel; images are empty where it is not known.
struct ViewTruth {
  Image<Eigen::Vector3f> normals_in_camera;  ///< Of the surface that the pixel's centre sees; NaN = none.
  Image<std::uint8_t> is_thing;              ///< Non-zero: neither room nor furniture.
  Image<std::uint8_t> is_changed;            ///< Non-zero: a thing that the other view has not, or not there.
};

/// Two views of a scene, and what each stage of preset `default` is given for the second one. One thread.
struct StageInput {
  RecognizerConfig config;
  PreparedView before, view;
  ViewTruth truth_before, truth;
  std::vector<GroundTruthObject> objects;  ///< Of `view`; empty where they are not known.
  ModelLibrary library;                    ///< Empty: the stages that need models are left out, and so is what follows.
  FeatureSet sift, shot;
  std::vector<std::vector<Correspondence>> correspondences;  ///< By object, scene side in the camera frame.
  std::vector<Hypothesis> hypotheses;
};

/// Two views of the generated demo scene, a seventh of its arc apart: a tea box comes, a can goes.
[[nodiscard]] StageInput make_demo_input();

/// Two views of a recorded sequence; `library_file` may be empty.
[[nodiscard]] StageInput read_input(const std::filesystem::path& sequence, int before, int view,
                                    const std::filesystem::path& library_file);

}  // namespace resight::bench
