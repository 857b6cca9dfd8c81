// SPDX-License-Identifier: Apache-2.0
#include "resight/cameras/common_objects.hpp"

#include <gtest/gtest.h>

#include "resight/sensor/testing/ball_scene.hpp"

namespace resight {
namespace {

// Two groups of three views of the same three objects, from opposite sides.
struct TwoSides {
  ModelLibrary library;
  std::vector<Rigid3> world_from_object;
  std::vector<Rigid3> world_from_camera;
  CameraTrack track;
  std::vector<ObservedObject> observed;
  Rng rng{7};

  TwoSides() {
    for (int o = 0; o < 3; ++o) {
      ObjectModel model;
      model.name = std::to_string(o);
      model.diameter_m = 0.2F;
      model.center = {0.01F, 0, 0.05F};
      library.objects.push_back(model);
      world_from_object.push_back(
          {Rigid3::from_axis_angle({0, 0.3, 1}, 0.7 * o).rotation, {0.3 * o - 0.3, 0.1 * o * o, 0}});
    }
    library.objects[1].symmetries.continuous.push_back({});
    library.objects[2].symmetries.discrete.push_back(Rigid3::from_axis_angle(Eigen::Vector3d::UnitZ(), 3.14159265));
    for (int v = 0; v < 6; ++v) {
      world_from_camera.push_back(test::look_at_point({0.2 * (v % 3) - 0.2, v < 3 ? -0.9 : 1.1, 0.6}, {0, 0.1, 0}));
      const Rigid3& first = world_from_camera[v < 3 ? 0 : 3];
      TrackedView view;
      view.component = v / 3;
      view.world_from_camera = first.inverse() * world_from_camera.back();
      track.views.push_back(view);
      if (v % 3 != 0)
        track.edges.push_back({v < 3 ? 0 : 3, v, view.world_from_camera, Eigen::Matrix<double, 6, 6>::Identity()});
    }
    track.num_components = 2;
  }

  // As recognition would report them: slightly off, and rotated by any symmetry motion.
  void see(int view, int object, const Rigid3& world_from_this) {
    const double turn = object == 1 ? rng.uniform(0, 6) : object == 2 ? 3.14159265 * (view % 2) : 0;
    const Rigid3 symmetry = Rigid3::from_axis_angle(Eigen::Vector3d::UnitZ(), turn);
    const Eigen::Vector3d noise{rng.normal(), rng.normal(), rng.normal()};
    const Rigid3 error = {Rigid3::from_axis_angle(noise.cross(Eigen::Vector3d(1, 2, 3)), 0.01).rotation, 0.002 * noise};
    observed.push_back(
        {view, object,
         world_from_camera[static_cast<std::size_t>(view)].inverse() * world_from_this * symmetry * error});
  }
  void see_all(std::initializer_list<int> objects) {
    for (int v = 0; v < 6; ++v)
      for (const int o : objects) see(v, o, world_from_object[static_cast<std::size_t>(o)]);
  }
  [[nodiscard]] double error_m(const CameraTrack& joined) const {
    const Rigid3 truth = world_from_camera[0].inverse() * world_from_camera[4];
    return test::shift_m(joined.views[4].world_from_camera, truth);
  }
};

TEST(CommonObjects, JoinViewsThatDoNotOverlap) {
  TwoSides s;
  s.see_all({0, 1, 2});
  const CameraTrack joined = join_by_objects(s.track, s.observed, s.library);
  ASSERT_EQ(joined.num_components, 1);
  EXPECT_LT(s.error_m(joined), 0.02);
  EXPECT_LT(
      test::turn_rad(joined.views[4].world_from_camera, s.world_from_camera[0].inverse() * s.world_from_camera[4]),
      0.035);
  EXPECT_EQ(joined.edges.size(), s.track.edges.size() + 1);
  EXPECT_EQ(joined.views[0].world_from_camera.matrix(), Eigen::Matrix4d::Identity());
}

TEST(CommonObjects, TwoAreEnough) {
  TwoSides s;
  s.see_all({0, 2});
  const CameraTrack joined = join_by_objects(s.track, s.observed, s.library);
  ASSERT_EQ(joined.num_components, 1);
  EXPECT_LT(s.error_m(joined), 0.02);
}

TEST(CommonObjects, OneIsNot) {
  TwoSides s;
  s.see_all({0});
  EXPECT_EQ(join_by_objects(s.track, s.observed, s.library).num_components, 2);
  EXPECT_EQ(join_by_objects(s.track, {}, s.library).num_components, 2);
}

TEST(CommonObjects, OneAtSeveralPlacesIsNot) {
  TwoSides s;
  const auto see_at = [&](int view, double off_m) {
    const Rigid3 pose = Rigid3::from_translation({off_m, 0, 0}) * s.world_from_object[0];
    s.observed.push_back({view, 0, s.world_from_camera[static_cast<std::size_t>(view)].inverse() * pose});
  };
  see_at(0, 0);
  see_at(1, 0.028);
  see_at(2, 0.027);
  see_at(2, 0.04);  // Too far from the first one, but not from the medoid of the first three.
  see_at(3, 0.03);
  EXPECT_EQ(join_by_objects(s.track, s.observed, s.library).num_components, 2);
  see_at(4, 0.058);
  see_at(5, 0.057);
  see_at(5, 0.07);
  EXPECT_EQ(join_by_objects(s.track, s.observed, s.library).num_components, 2) << "it is split on both sides";
}

TEST(CommonObjects, OneThatHasMovedIsIgnored) {
  TwoSides s;
  for (int v = 0; v < 6; ++v) {
    Rigid3 moved = s.world_from_object[0];
    if (v >= 3) moved.translation += Eigen::Vector3d(0.2, 0.1, 0);
    s.see(v, 0, moved);
    s.see(v, 1, s.world_from_object[1]);
    s.see(v, 2, s.world_from_object[2]);
  }
  const CameraTrack joined = join_by_objects(s.track, s.observed, s.library);
  ASSERT_EQ(joined.num_components, 1);
  EXPECT_LT(s.error_m(joined), 0.02);
}

TEST(CommonObjects, ObjectsThatHaveAllMovedJoinNothing) {
  TwoSides s;
  for (int v = 0; v < 6; ++v)
    for (int o = 0; o < 3; ++o) {
      Rigid3 moved = s.world_from_object[static_cast<std::size_t>(o)];
      if (v >= 3) moved = moved * Rigid3{Rigid3::from_axis_angle({1, 0, 0}, 0.5 + o).rotation, {0.1 * o, 0.05, 0}};
      s.see(v, o, moved);
    }
  EXPECT_EQ(join_by_objects(s.track, s.observed, s.library).num_components, 2);
}

// Objects of one kind may be confused; only the surfaces show that the room is not rotated by 180 deg.
TEST(CommonObjects, SurfacesDecideBetweenWaysThatObjectsLeaveOpen) {
  TwoSides s;
  s.library.objects.resize(1);
  s.library.objects[0].symmetries.discrete.push_back(Rigid3::from_axis_angle(Eigen::Vector3d::UnitZ(), 3.14159265));
  s.track.views.resize(2);
  s.track.edges.clear();
  s.world_from_camera = {test::look_at_point({-0.5, -0.9, 0.6}, {0, 0.3, 0.1}),
                         test::look_at_point({0.9, -0.4, 0.5}, {0.1, 0.4, 0.1})};
  std::vector<AlignmentView> surfaces;
  for (int v = 0; v < 2; ++v) {
    s.track.views[static_cast<std::size_t>(v)].component = v;
    s.track.views[static_cast<std::size_t>(v)].world_from_camera = Rigid3::identity();
    const Rigid3& camera = s.world_from_camera[static_cast<std::size_t>(v)];
    surfaces.push_back(make_alignment_view(prepare_view(test::render_ball_scene({}, camera, 0.001))));
    for (const double x : {-0.2, 0.3})  // The objects themselves are not in the image.
      s.observed.push_back({v, 0, camera.inverse() * Rigid3::from_translation({v == 0 ? x : 0.1 - x, 0.2, 0})});
  }
  const Rigid3 truth = s.world_from_camera[0].inverse() * s.world_from_camera[1];
  const CameraTrack joined = join_by_objects(s.track, s.observed, s.library, surfaces);
  ASSERT_EQ(joined.num_components, 1);
  EXPECT_LT(test::shift_m(joined.views[1].world_from_camera, truth), 0.001);
  // The wrong candidate alone does not join.
  s.library.objects[0].symmetries.discrete.clear();
  for (std::size_t o = 2; o < 4; ++o)
    s.observed[o].camera_from_object =
        s.observed[o].camera_from_object * Rigid3::from_axis_angle(Eigen::Vector3d::UnitZ(), 3.14159265);
  EXPECT_EQ(join_by_objects(s.track, s.observed, s.library).num_components, 1);
  EXPECT_EQ(join_by_objects(s.track, s.observed, s.library, surfaces).num_components, 2);
}

TEST(CommonObjects, WhatDoesNotExistIsRefused) {
  TwoSides s;
  s.observed.push_back({6, 0, {}});
  EXPECT_THROW((void)join_by_objects(s.track, s.observed, s.library), std::invalid_argument);
  s.observed.back() = {0, 3, {}};
  EXPECT_THROW((void)join_by_objects(s.track, s.observed, s.library), std::invalid_argument);
  s.observed.clear();
  const std::vector<AlignmentView> too_few(2);
  EXPECT_THROW((void)join_by_objects(s.track, s.observed, s.library, too_few), std::invalid_argument);
}

}  // namespace
}  // namespace resight
