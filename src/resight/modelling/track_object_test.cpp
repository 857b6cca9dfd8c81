// SPDX-License-Identifier: Apache-2.0
#include "resight/modelling/track_object.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "resight/cameras/trajectory_error.hpp"
#include "resight/core/random.hpp"
#include "resight/modelling/build_model.hpp"
#include "resight/modelling/internal/object_edges.hpp"
#include "resight/modelling/recorded_object_test_util.hpp"

namespace resight {
namespace {

struct Recording {
  std::vector<RgbdFrame> frames;
  std::vector<Rigid3> object_from_camera;
};

Recording split(std::vector<RecordedView> views) {
  Recording recording;
  for (RecordedView& view : views) {
    recording.frames.push_back(std::move(view.frame));
    recording.object_from_camera.push_back(view.camera_from_object.inverse());
  }
  return recording;
}

TrackObjectOptions track_on_two_threads() {
  TrackObjectOptions options;
  options.num_threads = 2;
  return options;
}

std::vector<Rigid3> poses_of(const ObjectTrack& track) {
  std::vector<Rigid3> poses;
  for (const TrainingView& view : track.views) poses.push_back(view.frame.world_from_camera);
  return poses;
}

TEST(MedianError, AViewWithoutTheObjectMeasuresNothing) {
  TrainingView seen;
  seen.frame = test::record("milk_carton", 120).front().frame;
  seen.mask = Image<std::uint8_t>(seen.frame.depth_m.width(), seen.frame.depth_m.height(), 255);
  TrainingView unseen = seen;
  std::ranges::fill(unseen.mask.data(), 0);
  const std::vector<TrainingView> views{seen, seen, unseen};
  const Rigid3 shift = Rigid3::from_translation({0.01, 0, 0});
  const PoseEdge measured{.a = 0, .b = 1, .a_from_b = shift, .information = {}};
  const PoseEdge empty{.a = 0, .b = 2, .a_from_b = shift, .information = {}};
  EXPECT_NEAR(median_error_m(views, std::vector<PoseEdge>{empty, measured}), 0.01, 1e-6);
  EXPECT_TRUE(std::isnan(median_error_m(views, std::vector<PoseEdge>{empty})));
  EXPECT_TRUE(std::isnan(median_error_m(views, {})));
}

// The whole pipeline in memory: both sides of an object on a turntable, in front of a more textured background.
TEST(TrackObject, BothSidesOfATurntableRecordingMakeOneModel) {
  Recording first = split(test::record("milk_carton", 20));
  Recording second = split(test::record("milk_carton", 20, true));
  auto track = track_object(std::move(first.frames), track_on_two_threads());
  ASSERT_TRUE(track.ok()) << track.error().message;
  ASSERT_EQ(track->views.size(), 18U);
  EXPECT_TRUE(track->is_camera_still);
  EXPECT_FALSE(track->loops.empty());
  EXPECT_LT(track->closure_error_m, 0.003);
  const TrajectoryError one_side = find_trajectory_error(first.object_from_camera, poses_of(*track));
  EXPECT_LT(one_side.max_rad, 0.06);
  // z points up from the turntable, as in the frame of the generated object.
  EXPECT_LT(one_side.reference_from_estimate.rotation.col(2).head<2>().norm(), 0.05);

  auto other = track_object(std::move(second.frames), track_on_two_threads());
  ASSERT_TRUE(other.ok()) << other.error().message;
  const auto joined = join_tracks(std::move(*track), std::move(*other), track_on_two_threads());
  ASSERT_TRUE(joined.ok()) << joined.error().message;
  std::vector<Rigid3> truth = first.object_from_camera;
  truth.insert(truth.end(), second.object_from_camera.begin(), second.object_from_camera.end());
  const TrajectoryError both = find_trajectory_error(truth, poses_of(*joined));
  EXPECT_LT(both.max_rad, 0.06);

  BuildModelOptions build;
  build.num_threads = 2;
  const auto model = build_model(joined->views, build);
  ASSERT_TRUE(model.ok()) << model.error().message;
  EXPECT_LT(model->report.holes.open_share, 0.02);
  const TriangleMesh mesh = make_procedural_object("milk_carton")->mesh;
  EXPECT_NEAR(model->report.diameter_m, static_cast<double>(diameter(mesh.vertices)), 0.004);
}

// Largest error of the rotation of a recorded can without texture. The given poses are off by some mm and tenths of a
// degree.
double rotation_error_of_plain_can(bool is_given) {
  Recording recording = split(test::record("plain_can", 45));
  Rng rng(5);
  for (std::size_t v = 0; v < recording.frames.size(); ++v) {
    const Eigen::Vector3d axis = Eigen::Vector3d(rng.normal(), rng.normal(), rng.normal()).normalized();
    Rigid3 off = Rigid3::from_axis_angle(axis, 0.003 * rng.normal());
    off.translation = 0.003 * Eigen::Vector3d(rng.normal(), rng.normal(), rng.normal());
    Rigid3& given = recording.frames[v].world_from_camera;
    given = is_given ? recording.object_from_camera[v] * off : Rigid3::identity();
  }
  const auto track = track_object(std::move(recording.frames), track_on_two_threads());
  return track.ok() ? find_trajectory_error(recording.object_from_camera, poses_of(*track)).max_rad : 100;
}

TEST(TrackObject, GivenPosesFollowARoundObjectWithoutTexture) {
  EXPECT_LT(rotation_error_of_plain_can(true), 0.02);
  EXPECT_GT(rotation_error_of_plain_can(false), 0.5) << "nothing tells how far it has turned";
}

/// Largest error of the rotation of a recorded object, with positions of this size as given poses; 100 if it is lost.
double rotation_error(const char* object, RecordingKind kind, double size_m, const TrackObjectOptions& options) {
  Recording recording = split(test::record(object, 24, false, kind));
  Rng rng(6);
  for (RgbdFrame& frame : recording.frames)
    for (double& coordinate : frame.world_from_camera.translation) coordinate = size_m * rng.normal();
  const auto track = track_object(std::move(recording.frames), options);
  return track.ok() ? find_trajectory_error(recording.object_from_camera, poses_of(*track)).max_rad : 100;
}

TEST(TrackObject, GivenPosesOfSomethingElseDoNoHarm) {
  const TrackObjectOptions options = track_on_two_threads();
  EXPECT_LT(rotation_error("milk_carton", RecordingKind::kTurntable, 300, options), 0.06);
  EXPECT_LT(rotation_error("milk_carton", RecordingKind::kWalk, 300, options), 0.06);
  // The jitter of a tracker, though the camera stands still: matches refute it, unless the steps are too small.
  EXPECT_LT(rotation_error("soup_tomato", RecordingKind::kTurntable, 0.001, options), 0.06);
  TrackObjectOptions small_steps = options;
  small_steps.given.sigma_rad = 0.15;  // 24 deg: 2.8 sigma
  EXPECT_LT(rotation_error("milk_carton", RecordingKind::kTurntable, 0.001, small_steps), 0.06);
}

// A camera in the hand is held still for a moment before it goes around.
TEST(TrackObject, AStartWithoutMotionIsNoTurntable) {
  Recording walk = split(test::record("milk_carton", 24, false, RecordingKind::kWalk));
  walk.frames.resize(6);
  walk.frames.insert(walk.frames.begin(), 2, walk.frames[0]);
  const auto track = track_object(std::move(walk.frames), track_on_two_threads());
  ASSERT_TRUE(track.ok()) << track.error().message;
  EXPECT_FALSE(track->is_camera_still);
}

// The camera has stayed on one side of the object, however many views there are.
TEST(TrackObject, ManyViewsOfOneSideCloseNoLoop) {
  const Recording whole = split(test::record("milk_carton", 20));
  std::vector<RgbdFrame> frames;
  for (int view = 0; view < 2; ++view) frames.insert(frames.end(), 4, whole.frames[view]);
  const auto track = track_object(std::move(frames), track_on_two_threads());
  ASSERT_TRUE(track.ok()) << track.error().message;
  EXPECT_TRUE(track->loops.empty());
  EXPECT_TRUE(std::isnan(track->drift_m));
  EXPECT_TRUE(std::isnan(track->closure_error_m));
}

// A plain surface around the object has the same depths from all sides: to the camera, the object alone turns.
TEST(TrackObject, ACircleAboveAPlainSurfaceIsNoTurntable) {
  RecordingOptions options;
  options.step_deg = 15;
  options.elevation_deg = 60;
  options.off_axis_m = 0.1;
  options.num_threads = 2;
  std::vector<RecordedView> views = simulate_recording(make_procedural_object("milk_carton")->mesh, options);
  for (RecordedView& view : views) {
    const Eigen::Vector3d up = view.camera_from_object.rotation.col(2);
    const double offset_m = up.dot(view.camera_from_object.translation);
    RgbdFrame& frame = view.frame;
    for (int v = 0; v < frame.depth_m.height(); ++v)
      for (int u = 0; u < frame.depth_m.width(); ++u) {
        if (view.mask(u, v) != 0) continue;
        frame.depth_m(u, v) = static_cast<float>(offset_m / up.dot(frame.camera.unproject(u, v, 1)));
        frame.color(u, v) = {128, 128, 128};
      }
  }
  Recording circle = split(std::move(views));
  const auto track = track_object(std::move(circle.frames), track_on_two_threads());
  ASSERT_TRUE(track.ok()) << track.error().message;
  EXPECT_FALSE(track->is_camera_still);
  EXPECT_LT(find_trajectory_error(circle.object_from_camera, poses_of(*track)).max_rad, 0.1);
}

TEST(TrackObject, AViewOfAnotherSizeIsRefused) {
  Recording walk = split(test::record("milk_carton", 24, false, RecordingKind::kWalk));
  walk.frames.resize(3);
  RgbdFrame& small = walk.frames[1];
  small.camera = {320, 240, small.camera.fx / 2, small.camera.fy / 2, 159.5, 119.5};
  small.depth_m = Image<float>(320, 240, 1.0F);
  small.color = Image<Rgb8>(320, 240);
  EXPECT_THAT(track_object(std::move(walk.frames), track_on_two_threads()).error().message,
              testing::HasSubstr("00001: is 320x240, other than the first view"));
}

TEST(TrackObject, SaysWhereItIsLost) {
  const Recording whole = split(test::record("milk_carton", 40));
  // The object is rotated by hand between two views.
  std::vector<RgbdFrame> frames{whole.frames[0], whole.frames[1], whole.frames[5]};
  const auto lost = track_object(std::move(frames), track_on_two_threads());
  ASSERT_FALSE(lost.ok());
  EXPECT_THAT(lost.error().message, testing::MatchesRegex("lost at view 00005: [0-9]+ matches"));
  // The object is removed.
  frames = {whole.frames[0], whole.frames[0]};
  for (float& z : frames[1].depth_m.data()) z = std::isnan(z) ? z : 3.0F;
  const auto gone = track_object(std::move(frames), track_on_two_threads());
  ASSERT_FALSE(gone.ok());
  EXPECT_THAT(gone.error().message, testing::HasSubstr("lost at view 00000: nothing stands"));
  frames = {whole.frames[0], whole.frames[0]};
  for (RgbdFrame& frame : frames)
    for (float& z : frame.depth_m.data()) z = std::isnan(z) ? z : 3.0F;
  const auto nothing = track_object(std::move(frames), track_on_two_threads());
  ASSERT_FALSE(nothing.ok());
  EXPECT_THAT(nothing.error().message, testing::HasSubstr("no object stands"));
  EXPECT_FALSE(track_object({}, track_on_two_threads()).ok());
  frames = {whole.frames[0]};
  EXPECT_THAT(track_object(std::move(frames), track_on_two_threads()).error().message,
              testing::HasSubstr("at least two views"));
}

TEST(TrackObject, RefusesBadOptions) {
  TrackObjectOptions options;
  options.plausible.min_overlap = 2;
  EXPECT_THROW(options.check(), std::invalid_argument);
}

}  // namespace
}  // namespace resight
