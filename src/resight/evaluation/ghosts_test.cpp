// SPDX-License-Identifier: Apache-2.0
#include "resight/evaluation/ghosts.hpp"

#include <gtest/gtest.h>

#include <numbers>
#include <stdexcept>

#include "resight/evaluation/pose_at_test.hpp"

namespace resight {
namespace {

ModelLibrary library_of_ghosts() {
  ModelLibrary library;
  library.objects.resize(2);
  library.objects[0].name = "mug";
  library.objects[1].name = "tin";
  return library;
}

GroundTruthObject object_at(const std::string& name, const Rigid3& camera_from_object) {
  GroundTruthObject object;
  object.object = name;
  object.camera_from_object = camera_from_object;
  return object;
}

/// A camera at x = `camera_x` that looks along the world's z axis, and objects given in the world frame.
TruthView view_at(double camera_x, const std::vector<std::pair<std::string, double>>& object_x_in_world) {
  TruthView view;
  view.world_from_camera = Rigid3::from_translation({camera_x, 0, 0});
  for (const auto& [name, x] : object_x_in_world) view.objects.push_back(object_at(name, pose_at(x - camera_x)));
  return view;
}

std::vector<Ghost> ghosts_of(const std::vector<FormerPlace>& places, const TruthView& truth, int view,
                             const std::vector<DetectedObject>& detections) {
  return find_ghosts(places, truth, view, detections, make_kinect_camera(), library_of_ghosts());
}

const std::vector<FormerPlace> kMugLeft = {{"mug", pose_at(0.1), 2}};

TEST(FindGhosts, CountsADetectionAtTheOldPlace) {
  const auto ghosts = ghosts_of(kMugLeft, view_at(0, {}), 3, {{"mug", pose_at(0.5), 1}, {"mug", pose_at(0.12), 1}});
  ASSERT_EQ(ghosts.size(), 1U);
  EXPECT_EQ(ghosts[0].detection, 1);
  EXPECT_EQ(ghosts[0].place, 0);
  EXPECT_NEAR(ghosts[0].difference.center_distance_m, 0.02, 1e-9);
}

TEST(FindGhosts, FindsTheOldPlaceFromAMovedCamera) {
  const auto ghosts = ghosts_of(kMugLeft, view_at(0.3, {}), 3, {{"mug", pose_at(-0.2), 1}});
  EXPECT_EQ(ghosts.size(), 1U);
}

TEST(FindGhosts, AnotherObjectOrAnotherPoseIsNoGhost) {
  const Rigid3 upside_down = pose_at(0.1) * Rigid3::from_axis_angle(Eigen::Vector3d::UnitX(), std::numbers::pi);
  EXPECT_TRUE(ghosts_of(kMugLeft, view_at(0, {}), 3, {{"tin", pose_at(0.1), 1}}).empty());
  EXPECT_TRUE(ghosts_of(kMugLeft, view_at(0, {}), 3, {{"mug", upside_down, 1}}).empty());
  EXPECT_TRUE(ghosts_of(kMugLeft, view_at(0, {}), 3, {{"mug", pose_at(0.16), 1}}).empty());
}

TEST(FindGhosts, APlaceIsFormerOnlyAfterItsLastView) {
  EXPECT_TRUE(ghosts_of(kMugLeft, view_at(0, {}), 2, {{"mug", pose_at(0.1), 1}}).empty());
  EXPECT_EQ(ghosts_of(kMugLeft, view_at(0, {}), 3, {{"mug", pose_at(0.1), 1}}).size(), 1U);
}

TEST(FindGhosts, APresentObjectExplainsTheDetection) {
  EXPECT_TRUE(ghosts_of(kMugLeft, view_at(0, {{"mug", 0.13}}), 3, {{"mug", pose_at(0.1), 1}}).empty())
      << "moved by 3 cm: the same detection is right";
  TruthView hidden = view_at(0, {{"mug", 0.1}});
  hidden.objects[0].visible_share = 0;
  EXPECT_TRUE(ghosts_of(kMugLeft, hidden, 3, {{"mug", pose_at(0.1), 1}}).empty());
  EXPECT_EQ(ghosts_of(kMugLeft, view_at(0, {{"tin", 0.1}}), 3, {{"mug", pose_at(0.1), 1}}).size(), 1U)
      << "a tin in its place does not explain a mug";
}

TEST(FindGhosts, PlacesOutOfViewSayNothing) {
  const TruthView looks_elsewhere = view_at(3, {});
  EXPECT_TRUE(ghosts_of(kMugLeft, looks_elsewhere, 3, {{"mug", pose_at(0.1 - 3), 1}}).empty());
  TruthView turned_away = view_at(0, {});
  turned_away.world_from_camera = Rigid3::from_axis_angle(Eigen::Vector3d::UnitY(), std::numbers::pi);
  const Rigid3 behind = turned_away.world_from_camera.inverse() * pose_at(0.1);
  EXPECT_TRUE(ghosts_of(kMugLeft, turned_away, 3, {{"mug", behind, 1}}).empty());
}

TEST(FindGhosts, ChoosesTheNearestOfSeveralPlaces) {
  const std::vector<FormerPlace> places = {{"mug", pose_at(0.10), 0}, {"mug", pose_at(0.14), 1}};
  const auto ghosts = ghosts_of(places, view_at(0, {}), 2, {{"mug", pose_at(0.13), 1}});
  ASSERT_EQ(ghosts.size(), 1U);
  EXPECT_EQ(ghosts[0].place, 1);
}

TEST(CountDetectedFormerPlaces, CountsOutsideTheImageAndUnderTheSameObject) {
  const auto count = [](double camera_x, int view, const std::vector<DetectedObject>& detections) {
    return count_detected_former_places(kMugLeft, Rigid3::from_translation({camera_x, 0, 0}), view, detections,
                                        library_of_ghosts());
  };
  EXPECT_EQ(count(0, 3, {{"mug", pose_at(0.12), 1}, {"mug", pose_at(0.11), 1}}), 1) << "one place, twice detected";
  EXPECT_EQ(count(0, 2, {{"mug", pose_at(0.1), 1}}), 0) << "the mug is still there";
  EXPECT_EQ(count(0, 3, {{"tin", pose_at(0.1), 1}, {"mug", pose_at(0.3), 1}}), 0);
  EXPECT_EQ(count(5, 3, {{"mug", pose_at(-4.9), 1}}), 1) << "outside the image";
}

TEST(FindGhosts, RefusesNonsense) {
  EXPECT_THROW((void)ghosts_of({}, view_at(0, {}), 0, {{"lamp", pose_at(0), 1}}), std::invalid_argument);
  EXPECT_THROW((void)find_ghosts({}, {}, 0, {}, Camera{}, library_of_ghosts()), std::invalid_argument);
}

TEST(FindFormerPlaces, AMoveLeavesOnePlaceBehind) {
  const std::vector<TruthView> views = {view_at(0, {{"mug", 0.1}, {"tin", 0.4}}),
                                        view_at(0.2, {{"mug", 0.1}, {"tin", 0.4}}),
                                        view_at(0.1, {{"mug", 0.3}, {"tin", 0.4}})};
  const auto places = find_former_places(views, library_of_ghosts());
  ASSERT_EQ(places.size(), 1U);
  EXPECT_EQ(places[0].object, "mug");
  EXPECT_EQ(places[0].last_view, 1);
  EXPECT_NEAR(places[0].world_from_object.translation.x(), 0.1, 1e-9);
}

TEST(FindFormerPlaces, AnnotationJitterIsNoMove) {
  const std::vector<TruthView> views = {view_at(0, {{"mug", 0.1}}), view_at(0, {{"mug", 0.104}}),
                                        view_at(0, {{"mug", 0.097}})};
  EXPECT_TRUE(find_former_places(views, library_of_ghosts()).empty());
}

TEST(FindFormerPlaces, ADriftingCameraLeavesNoPlaces) {
  std::vector<TruthView> views;
  for (int v = 0; v < 10; ++v) views.push_back(view_at(0, {{"mug", 0.1 + 0.01 * v}, {"mug", 0.14 + 0.01 * v}}));
  EXPECT_TRUE(find_former_places(views, library_of_ghosts()).empty());
}

TEST(FindFormerPlaces, AGapIsNoDeparture) {
  const std::vector<TruthView> views = {view_at(0, {{"mug", 0.1}}), view_at(0, {}), view_at(0, {{"mug", 0.1}})};
  EXPECT_TRUE(find_former_places(views, library_of_ghosts()).empty());
  const std::vector<TruthView> gone = {view_at(0, {{"mug", 0.1}}), view_at(0, {}), view_at(0, {})};
  const auto places = find_former_places(gone, library_of_ghosts());
  ASSERT_EQ(places.size(), 1U);
  EXPECT_EQ(places[0].last_view, 0);
}

TEST(FindFormerPlaces, TwoOfAKindAreDistinguished) {
  const std::vector<TruthView> views = {view_at(0, {{"mug", 0.1}, {"mug", 0.3}}), view_at(0, {{"mug", 0.3}}),
                                        view_at(0, {{"mug", 0.3}})};
  const auto places = find_former_places(views, library_of_ghosts());
  ASSERT_EQ(places.size(), 1U);
  EXPECT_NEAR(places[0].world_from_object.translation.x(), 0.1, 1e-9);
}

TEST(FindFormerPlaces, UnknownObjectsAreLeftOut) {
  const std::vector<TruthView> views = {view_at(0, {{"lamp", 0.1}}), view_at(0, {})};
  EXPECT_TRUE(find_former_places(views, library_of_ghosts()).empty());
  EXPECT_THROW((void)find_former_places(views, library_of_ghosts(), {.max_rotation_rad = 0}), std::invalid_argument);
}

}  // namespace
}  // namespace resight
