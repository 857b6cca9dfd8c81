// SPDX-License-Identifier: Apache-2.0
#include "resight/evaluation/match_view.hpp"

#include <gtest/gtest.h>

#include "resight/evaluation/pose_at_test.hpp"

namespace resight {
namespace {

ModelLibrary make_mug_library() {
  ModelLibrary library;
  library.objects.resize(1);
  library.objects[0].name = "mug";
  return library;
}

// The camera stands 2 m from the origin of the world, and pose correction moved it by 20 cm.
struct CorrectedView {
  Rigid3 world_from_camera = Rigid3::from_translation({2, 0, 0});
  SceneUpdate update;
  CorrectedView() {
    update.world_from_camera = Rigid3::from_translation({0, 0.2, 0}) * world_from_camera;
    update.detections.resize(1);
    update.detections[0].object = 0;
    update.detections[0].world_from_object = update.world_from_camera * pose_at(0.3);
    update.detections[0].score = 0.875;
  }
};

TEST(ToDetectedObjects, GivesCameraPosesByName) {
  const auto objects = to_detected_objects(CorrectedView().update, make_mug_library());
  ASSERT_EQ(objects.size(), 1U);
  EXPECT_EQ(objects[0].object, "mug");
  EXPECT_EQ(objects[0].score, 0.875);
  EXPECT_LT((objects[0].camera_from_object.translation - pose_at(0.3).translation).norm(), 1e-12);
}

TEST(MatchView, FormerPlacesAreInTheWorldOfTheTruth) {
  const CorrectedView view;
  const ModelLibrary library = make_mug_library();
  const std::vector<FormerPlace> places{{"mug", view.world_from_camera * pose_at(0.3), 0}};
  const MatchedView matched = match_view(1, {view.world_from_camera, {}}, to_detected_objects(view.update, library),
                                         places, make_kinect_camera(), library);
  EXPECT_EQ(matched.loose.score, (RecognitionScore{0, 1, 0}));
  EXPECT_EQ(matched.ghosts.size(), 1U);
}

TEST(MatchView, OnlyFalsePositivesAreGhosts) {
  const CorrectedView view;
  const ModelLibrary library = make_mug_library();
  const std::vector<FormerPlace> places{{"mug", view.world_from_camera * pose_at(0.3), 0}};
  GroundTruthObject present;
  present.object = "mug";
  present.camera_from_object = pose_at(0.3);
  for (const double visible_share : {1.0, 0.01}) {
    present.visible_share = visible_share;
    const MatchedView matched =
        match_view(1, {view.world_from_camera, {present}}, to_detected_objects(view.update, library), places,
                   make_kinect_camera(), library);
    EXPECT_TRUE(matched.ghosts.empty());
    EXPECT_EQ(matched.loose.false_positives.size(), 0U);
  }
}

}  // namespace
}  // namespace resight
