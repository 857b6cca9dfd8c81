// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "resight/modelling/recorded_object_test_util.hpp"
#include "resight/modelling/track_object.hpp"

namespace resight {
namespace {

TrackObjectOptions join_on_two_threads() {
  TrackObjectOptions options;
  options.num_threads = 2;
  return options;
}

// An error-free track of a recording, in the frame `frame_from_object`.
ObjectTrack follow_truly(const std::string& object, double step_deg, bool upside_down,
                         const Rigid3& frame_from_object) {
  ObjectTrack track;
  std::optional<ObjectRegion> region;
  for (RecordedView& recorded : test::record(object, step_deg, upside_down)) {
    const Rigid3 object_from_camera = recorded.camera_from_object.inverse();
    PreparedView view = prepare_view(std::move(recorded.frame));
    if (!region) region = find_object_region(view);
    Image<std::uint8_t> mask = segment_object(view.cloud, *region);
    view.frame.world_from_camera = frame_from_object * object_from_camera;
    track.views.push_back({std::move(view.frame), std::move(mask)});
  }
  return track;
}

const Rigid3 kOther{Rigid3::from_axis_angle({1, 0.3, 0.2}, 2.8).rotation, {0.02, -0.01, 0.12}};

TEST(JoinTracks, AnObjectWithLittleTextureByItsShape) {
  ObjectTrack second = follow_truly("duck", 36, true, kOther);
  std::vector<Rigid3> camera_from_object;
  for (const TrainingView& view : second.views)
    camera_from_object.push_back(view.frame.world_from_camera.inverse() * kOther);
  const auto joined = join_tracks(follow_truly("duck", 36, false, {}), std::move(second), join_on_two_threads());
  ASSERT_TRUE(joined.ok()) << joined.error().message;
  ASSERT_EQ(joined->views.size(), 20U);
  for (std::size_t v = 0; v < camera_from_object.size(); ++v) {
    const Rigid3 off = joined->views[10 + v].frame.world_from_camera * camera_from_object[v];
    const Eigen::Vector3d middle(0, 0, 0.05);
    EXPECT_LT((off * middle - middle).norm(), 0.003) << v;
    EXPECT_LT(rotation_angle_rad(off.rotation, Eigen::Matrix3d::Identity()), 0.05) << v;
  }
}

// Only its handle tells how a round mug has been turned. The bottom, which one side alone shows, pulls the fits away.
TEST(JoinTracks, ARoundObjectByItsShape) {
  ObjectTrack second = follow_truly("plain_mug", 24, true, kOther);
  std::vector<Rigid3> camera_from_object;
  for (const TrainingView& view : second.views)
    camera_from_object.push_back(view.frame.world_from_camera.inverse() * kOther);
  const auto joined = join_tracks(follow_truly("plain_mug", 24, false, {}), std::move(second), join_on_two_threads());
  ASSERT_TRUE(joined.ok()) << joined.error().message;
  for (std::size_t v = 0; v < camera_from_object.size(); ++v) {
    const Rigid3 off = joined->views[15 + v].frame.world_from_camera * camera_from_object[v];
    const Eigen::Vector3d middle(0, 0, 0.05);
    EXPECT_LT((off * middle - middle).norm(), 0.01) << v;
    EXPECT_LT(rotation_angle_rad(off.rotation, Eigen::Matrix3d::Identity()), 0.05) << v;
  }
}

TEST(JoinTracks, AnotherObjectIsRefused) {
  const auto joined = join_tracks(follow_truly("duck", 60, false, {}), follow_truly("plain_box", 60, true, kOther),
                                  join_on_two_threads());
  ASSERT_FALSE(joined.ok());
  EXPECT_THAT(joined.error().message, testing::HasSubstr("no common shape"));
}

}  // namespace
}  // namespace resight
