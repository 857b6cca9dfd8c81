// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <utility>
#include <vector>

#include "resight/recognition/scene_recognizer.hpp"
#include "resight/verification/testing/verify_fixture.hpp"

namespace resight::test {

/// A box on a table, seen by four cameras. Only the first view has a hypothesis.
struct BoxScene {
  analytic::World world = analytic::one_box();
  ModelLibrary library = analytic::make_library();
  std::vector<Rigid3> cameras = analytic::circle_of_cameras(4, 0.8, 0.6, 0.6);
  std::shared_ptr<ViewHypothesisStore> store = std::make_shared<ViewHypothesisStore>();
  RecognizerConfig config = RecognizerConfig::from_preset("default");

  BoxScene() {
    for (int view = 0; view < 4; ++view) store->add(view, {});
    ViewHypotheses first;
    first.world_from_camera = cameras[0];
    first.hypotheses = {analytic::make_hypothesis(analytic::kBox, world.solids[0].world_from_object)};
    first.hypotheses[0].origin_view = 0;
    first.hypotheses[0].origin_views = {0};
    store->add(0, std::move(first));
  }

  std::vector<SceneUpdate> run() const {
    SceneRecognizer recognizer(library, config, store);
    std::vector<SceneUpdate> updates;
    for (const Rigid3& camera : cameras) updates.push_back(recognizer.add_view(analytic::render(world, camera).frame));
    return updates;
  }
};

}  // namespace resight::test
