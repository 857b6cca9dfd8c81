// SPDX-License-Identifier: Apache-2.0
#include "resight/recognition/view_novelty.hpp"

#include <gtest/gtest.h>

#include "resight/recognition/scene_recognizer.hpp"
#include "resight/verification/testing/verify_fixture.hpp"

namespace resight {
namespace {

using namespace analytic;

// A table with a box, looked at from one place after another.
struct Watch {
  World world = one_box();
  std::vector<Rigid3> cameras = circle_of_cameras(12, 0.8, 0.6, 0.6);
  ViewNovelty novelty{{.max_new_share = 0.003, .full_interval = 5}};

  bool needs_search(const Rigid3& camera, const ChangeResult& changes = {}) {
    return novelty.needs_search(prepare_view(render(world, camera).frame), changes);
  }
};

TEST(ViewNovelty, AnUnchangedViewIsSearchedOncePerInterval) {
  Watch w;
  for (int view = 0; view < 12; ++view) EXPECT_EQ(w.needs_search(w.cameras[0]), view % 5 == 0) << view;
}

TEST(ViewNovelty, OffEveryViewIsSearched) {
  Watch w;
  w.novelty = ViewNovelty({});
  for (int view = 0; view < 3; ++view) EXPECT_TRUE(w.needs_search(w.cameras[0]));
}

TEST(ViewNovelty, AnotherSideIsNew) {
  Watch w;
  EXPECT_TRUE(w.needs_search(w.cameras[0]));
  EXPECT_TRUE(w.needs_search(w.cameras[1]));   // 30 deg on
  EXPECT_FALSE(w.needs_search(w.cameras[0]));  // back to what was searched
  EXPECT_FALSE(w.needs_search(w.cameras[1]));
}

TEST(ViewNovelty, WhatASearchLeftOutIsNew) {
  Watch w;
  EXPECT_TRUE(w.needs_search(w.cameras[0]));
  w.novelty.forget_last_search();
  EXPECT_TRUE(w.needs_search(w.cameras[1]));
  EXPECT_TRUE(w.needs_search(w.cameras[0]));
  EXPECT_FALSE(w.needs_search(w.cameras[0]));
}

TEST(ViewNovelty, FarSurfacesAreNewOnce) {
  Watch w;
  EXPECT_TRUE(w.needs_search(look_at({0, -2.6, 1.0}, {0, 0, 0})));
  EXPECT_FALSE(w.needs_search(look_at({0, -2.6, 1.0}, {0, 0, 0})));
  EXPECT_TRUE(w.needs_search(look_at({2.6, 0, 1.0}, {0, 0, 0})));
}

TEST(ViewNovelty, ANearerViewIsNew) {
  Watch w;
  const Eigen::Vector3d eye = w.cameras[0].translation;
  EXPECT_TRUE(w.needs_search(look_at(eye, {0, 0, 0})));
  EXPECT_FALSE(w.needs_search(look_at(0.95 * eye, {0, 0, 0})));
  EXPECT_TRUE(w.needs_search(look_at(0.6 * eye, {0, 0, 0})));
}

TEST(ViewNovelty, AddedAndUncoveredSurfacesAreNew) {
  Watch w;
  EXPECT_TRUE(w.needs_search(w.cameras[0]));
  w.world.solids.clear();
  EXPECT_TRUE(w.needs_search(w.cameras[0]));  // the table behind the box
  w.world = one_box();
  ChangeResult changes;
  changes.novel_mask = Image<std::uint8_t>(320, 240);
  EXPECT_FALSE(w.needs_search(w.cameras[0], changes));
  for (int v = 100; v < 140; ++v)
    for (int u = 140; u < 180; ++u) changes.novel_mask(u, v) = 1;
  EXPECT_TRUE(w.needs_search(w.cameras[0], changes));
}

TEST(ViewNovelty, DepthNoiseIsNotNew) {
  const auto shifted = [](const Watch& w, float by_m) {
    RgbdFrame frame = render(w.world, w.cameras[0]).frame;
    for (std::size_t i = 0; i < frame.depth_m.size(); ++i) frame.depth_m[i] += by_m;
    return prepare_view(std::move(frame));
  };
  Watch w;
  EXPECT_TRUE(w.needs_search(w.cameras[0]));
  EXPECT_FALSE(w.novelty.needs_search(shifted(w, 0.022F), {})) << "2 cm and half of three sigmas";
  EXPECT_TRUE(w.novelty.needs_search(shifted(w, 0.04F), {}));
}

TEST(ViewNovelty, AViewWithASuspectPoseIsSearched) {
  Watch w;
  EXPECT_TRUE(w.needs_search(w.cameras[0]));
  ChangeResult suspect;
  suspect.pose_suspect = true;
  EXPECT_TRUE(w.needs_search(w.cameras[0], suspect));
}

// From recognition on: a view that shows nothing new is not searched, and what is known is found in it all the same.
TEST(ViewNovelty, TrackedObjectsAreConfirmedWithoutASearch) {
  const World world = one_box();
  const ModelLibrary library = analytic::make_library();
  auto store = std::make_shared<ViewHypothesisStore>();
  ViewHypotheses first;
  const Rigid3 camera = circle_of_cameras(4, 0.8, 0.6, 0.6)[0];
  first.world_from_camera = camera;
  first.hypotheses = {make_hypothesis(kBox, world.solids[0].world_from_object)};
  store->add(0, std::move(first));
  SceneRecognizer recognizer(library, RecognizerConfig::from_preset("default"), store);
  for (int view = 0; view < 4; ++view) {
    const SceneUpdate update = recognizer.add_view(render(world, camera).frame);
    EXPECT_EQ(update.searched, view == 0) << view;
    EXPECT_EQ(update.detections.size(), 1U) << view;
    EXPECT_EQ(update.counts.generated, view == 0 ? 1 : 0) << view;
  }
}

// What remembers nothing has to search each view.
TEST(ViewNovelty, SingleViewsAreSearched) {
  const World world = one_box();
  const ModelLibrary library = analytic::make_library();
  for (const bool remember : {false, true}) {
    RecognizerConfig config = RecognizerConfig::from_preset("default");
    config.remember_objects = remember;
    if (!remember) config.search = {};
    config.num_previous_views = remember ? 0 : 2;
    SceneRecognizer recognizer(library, config, std::make_shared<ViewHypothesisStore>());
    const Rigid3 camera = circle_of_cameras(4, 0.8, 0.6, 0.6)[0];
    for (int view = 0; view < 3; ++view) EXPECT_TRUE(recognizer.add_view(render(world, camera).frame).searched) << view;
  }
}

TEST(ViewNovelty, RefusesInvalidOptions) {
  EXPECT_THROW(ViewNovelty({.max_new_share = 2}), std::invalid_argument);
  EXPECT_THROW(ViewNovelty({.full_interval = 0}), std::invalid_argument);
}

}  // namespace
}  // namespace resight
