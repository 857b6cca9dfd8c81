// SPDX-License-Identifier: Apache-2.0
#include "resight/cameras/joint_adjustment.hpp"

#include <gtest/gtest.h>

#include "resight/sensor/testing/ball_scene.hpp"

namespace resight {
namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6>;

// Eight cameras around a table with three objects: one is a solid of revolution, one has a two-fold symmetry.
struct Table {
  ModelLibrary library;
  std::vector<Rigid3> world_from_object;
  std::vector<Rigid3> world_from_camera;
  CameraTrack track;
  std::vector<ObservedObject> observed;
  Rng rng{3};

  Table() {
    for (int o = 0; o < 3; ++o) {
      ObjectModel model;
      model.name = std::to_string(o);
      model.diameter_m = 0.2F;
      model.center = {0, o == 1 ? 0.02F : 0, 0.05F};
      library.objects.push_back(model);
      world_from_object.push_back(
          {Rigid3::from_axis_angle({0, 0.3, 1}, 0.7 * o).rotation, {0.3 * o - 0.3, 0.1 * o * o, 0}});
    }
    library.objects[1].symmetries.continuous.push_back({{0, 0, 1}, {0, 0.02, 0}});
    library.objects[2].symmetries.discrete.push_back(Rigid3::from_axis_angle(Eigen::Vector3d::UnitZ(), 3.14159265));
    for (int v = 0; v < 8; ++v) {
      const double angle = 0.7 * v;
      world_from_camera.push_back(
          test::look_at_point({1.1 * std::cos(angle), 1.1 * std::sin(angle), 0.6}, {0, 0.1, 0}));
      // Every step is slightly off, so that the trajectory drifts.
      track.views.emplace_back();
      if (v == 0) continue;
      track.edges.push_back({v - 1, v, off(truth(v - 1).inverse() * truth(v), 0.003), Matrix6::Identity() * 1e5});
      track.views[static_cast<std::size_t>(v)].world_from_camera =
          track.views[static_cast<std::size_t>(v) - 1].world_from_camera * track.edges.back().a_from_b;
    }
    track.num_components = 1;
  }

  [[nodiscard]] Rigid3 truth(int view) const {
    return world_from_camera[0].inverse() * world_from_camera[static_cast<std::size_t>(view)];
  }
  Rigid3 off(const Rigid3& pose, double sigma) {
    Twist twist;
    for (int k = 0; k < 6; ++k) twist[k] = sigma * rng.normal();
    return pose * from_twist(twist);
  }
  // Observes the object up to any of its symmetries.
  void see(int view, int object) {
    const double turn = object == 1 ? rng.uniform(0, 6) : object == 2 ? 3.14159265 * (view % 2) : 0;
    const Rigid3 symmetry = Rigid3::from_translation({0, object == 1 ? 0.02 : 0, 0}) *
                            Rigid3::from_axis_angle(Eigen::Vector3d::UnitZ(), turn) *
                            Rigid3::from_translation({0, object == 1 ? -0.02 : 0, 0});
    observed.push_back({view, object,
                        off(world_from_camera[static_cast<std::size_t>(view)].inverse() *
                                world_from_object[static_cast<std::size_t>(object)] * symmetry,
                            0.002)});
  }
  [[nodiscard]] double mean_error_m(const CameraTrack& t) const {
    double sum = 0;
    for (int v = 0; v < 8; ++v) sum += test::shift_m(t.views[static_cast<std::size_t>(v)].world_from_camera, truth(v));
    return sum / 8;
  }
};

TEST(JointAdjustment, ObjectsSeenAllTheWayHoldTheCameras) {
  Table t;
  const double alone = t.mean_error_m(adjust_jointly(t.track, {}, t.library).track);
  for (int v = 0; v < 8; ++v)
    for (int o = 0; o < 3; ++o) t.see(v, o);
  const JointAdjustment together = adjust_jointly(t.track, t.observed, t.library);
  EXPECT_LT(t.mean_error_m(together.track), 0.5 * alone);
  ASSERT_EQ(together.objects.size(), 3U);
  for (const StaticObject& object : together.objects) {
    const ObjectModel& model = t.library.objects[static_cast<std::size_t>(object.object)];
    const Rigid3 truth =
        t.world_from_camera[0].inverse() * t.world_from_object[static_cast<std::size_t>(object.object)];
    const Eigen::Vector3d center = model.center.cast<double>();
    EXPECT_LT((object.world_from_object * center - truth * center).norm(), 0.006) << model.name;
    EXPECT_LT(symmetric_rotation_distance_rad(object.world_from_object, truth, model.symmetries), 0.01) << model.name;
    EXPECT_EQ(object.views, (std::vector<int>{0, 1, 2, 3, 4, 5, 6, 7}));
  }
  EXPECT_EQ(together.track.views[0].world_from_camera.matrix(), Eigen::Matrix4d::Identity());
}

TEST(JointAdjustment, AnObjectThatMovesStandsAtTwoPlaces) {
  Table t;
  for (int v = 0; v < 8; ++v) {
    if (v == 4) t.world_from_object[0].translation += Eigen::Vector3d(0.15, 0, 0);
    t.see(v, 0);
    t.see(v, 2);
  }
  const JointAdjustment together = adjust_jointly(t.track, t.observed, t.library);
  ASSERT_EQ(together.objects.size(), 3U);
  EXPECT_EQ(together.objects[0].views, (std::vector<int>{0, 1, 2, 3}));
  EXPECT_EQ(together.objects[2].views, (std::vector<int>{4, 5, 6, 7}));
  EXPECT_LT(t.mean_error_m(together.track), 0.01);
}

TEST(JointAdjustment, OneObservationIsIgnored) {
  Table t;
  t.see(3, 0);
  const JointAdjustment together = adjust_jointly(t.track, t.observed, t.library);
  EXPECT_TRUE(together.objects.empty());
  EXPECT_EQ(t.mean_error_m(together.track), t.mean_error_m(adjust_jointly(t.track, {}, t.library).track));
}

// A camera that orbits a solid of revolution always observes the same; the other information decides.
TEST(JointAdjustment, RotationAboutASymmetryAxisIsIgnored) {
  Table t;
  const Rigid3 world_from_object = t.world_from_camera[0].inverse() * t.world_from_object[1];
  const auto around = Rigid3::from_translation({0, 0.02, 0}) * Rigid3::from_axis_angle({0, 0, 1}, 0.1) *
                      Rigid3::from_translation({0, -0.02, 0});
  const Rigid3 measured = world_from_object * around * world_from_object.inverse() * t.truth(1);
  t.track.views.resize(2);
  t.track.views[1].world_from_camera = t.truth(1);
  t.track.edges = {{0, 1, measured, Matrix6::Identity() * 100}};
  t.observed = {{0, 1, world_from_object}, {1, 1, t.truth(1).inverse() * world_from_object}};
  const JointAdjustment together = adjust_jointly(t.track, t.observed, t.library);
  ASSERT_EQ(together.objects.size(), 1U);
  EXPECT_LT(test::turn_rad(together.track.views[1].world_from_camera, measured), 0.002);
  EXPECT_LT(test::shift_m(together.track.views[1].world_from_camera, measured), 0.002);
}

}  // namespace
}  // namespace resight
