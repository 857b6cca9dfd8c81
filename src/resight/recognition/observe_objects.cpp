// SPDX-License-Identifier: Apache-2.0
#include "resight/recognition/observe_objects.hpp"

#include "resight/recognition/recognize_sequence.hpp"

namespace resight {

Result<std::vector<ObservedObject>> observe_objects(const Sequence& sequence, const ModelLibrary& library,
                                                    int num_threads, const ObserveProgress& progress) {
  RecognizerConfig config = RecognizerConfig::from_preset("default");
  config.num_previous_views = 0;
  config.camera.depth_bias.correct = false;  // It is measured with the given poses.
  config.set_num_threads(num_threads);
  SceneRecognizer recognizer(library, config);
  std::vector<ObservedObject> observed;
  const auto done = recognize_sequence(recognizer, sequence, [&](const RgbdFrame&, const SceneUpdate& update) {
    const Rigid3 camera_from_world = update.world_from_camera.inverse();
    for (const Detection& d : update.detections)
      observed.push_back({update.view, d.object, camera_from_world * d.world_from_object});
    if (progress) progress(update.view, update);
  });
  if (!done) return done.error();
  return observed;
}

}  // namespace resight
