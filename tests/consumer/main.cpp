// SPDX-License-Identifier: Apache-2.0
// Uses two modules of the installed library; the exit status tells whether their results are right.
#include <cstdio>
#include <vector>

#include "resight/changes/difference.hpp"
#include "resight/evaluation/match_detections.hpp"

int main() {
  const std::vector<Eigen::Vector3f> before = {{0, 0, 1}, {0.1F, 0, 1}, {0.2F, 0, 1}};
  const std::vector<Eigen::Vector3f> now = {{0.001F, 0, 1}, {0.2F, 0.001F, 1}};
  const std::vector<int> gone = resight::subtract_clouds(before, now, 0.02);

  resight::ModelLibrary library;
  library.objects.resize(1);
  library.objects[0].name = "mug";
  resight::GroundTruthObject truth;
  truth.object = "mug";
  truth.camera_from_object = resight::Rigid3::from_translation({0, 0, 1});
  const std::vector<resight::GroundTruthObject> truths = {truth};
  const std::vector<resight::DetectedObject> detections = {{"mug", truth.camera_from_object, 1.0}};
  const auto result = resight::match_detections(truths, detections, library);

  const bool right = gone == std::vector<int>{1} && result.score.true_positives == 1;
  std::printf("consumer: %s\n", right ? "right" : "wrong");
  return right ? 0 : 1;
}
