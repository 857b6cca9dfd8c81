// SPDX-License-Identifier: Apache-2.0
#include "resight/report/overlay.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/imgcodecs.hpp>
#include <stdexcept>
#include <tuple>

#include "resight/report/internal/drawing.hpp"
#include "resight/report/report_test_scene.hpp"

namespace resight {
namespace {

using namespace resight::test;

const DrawOverlayOptions kNoLabels{.show_labels = false};

int count_color(const Image<Rgb8>& picture, Rgb8 color) {
  return static_cast<int>(std::count(picture.data().begin(), picture.data().end(), color));
}

int count_different(const Image<Rgb8>& a, const Image<Rgb8>& b) {
  int different = 0;
  for (std::size_t i = 0; i < a.size(); ++i) different += a[i] == b[i] ? 0 : 1;
  return different;
}

Image<Rgb8> overlay_of(const std::vector<Detection>& detections, const std::vector<DetectionMark>& marks = {},
                       const DrawOverlayOptions& options = kNoLabels) {
  const RgbdFrame frame = make_frame();
  SceneUpdate update = make_update(frame, 0);
  update.detections = detections;
  return draw_overlay(frame, make_library(), update, marks, {}, options);
}

TEST(DrawOverlay, OutlineOfABallIsItsCircle) {
  const RgbdFrame frame = make_frame();
  const double depth_m = 0.8;
  const double radius_m = 0.05;
  const Image<Rgb8> picture = overlay_of({make_detection(frame, 0, at(0, 0, depth_m))});
  // On the optical axis, the silhouette of a ball is a circle of this radius.
  const double circle_px = frame.camera.fx * radius_m / std::sqrt(depth_m * depth_m - radius_m * radius_m);
  int drawn = 0;
  std::vector<int> per_direction(36, 0);
  for (int v = 0; v < picture.height(); ++v) {
    for (int u = 0; u < picture.width(); ++u) {
      if (picture(u, v) == frame.color(u, v)) continue;
      const double du = u - frame.camera.cx;
      const double dv = v - frame.camera.cy;
      EXPECT_NEAR(std::hypot(du, dv), circle_px, 5.0) << "pixel " << u << " " << v;
      ++drawn;
      const double turn = (std::atan2(dv, du) + std::numbers::pi) / (2 * std::numbers::pi);
      per_direction[static_cast<std::size_t>(std::min(35.0, turn * 36))] += 1;
    }
  }
  EXPECT_GT(drawn, 100);
  EXPECT_GT(*std::min_element(per_direction.begin(), per_direction.end()), 0) << "the line has a gap";
}

TEST(ProjectOutline, LiesOnTheBorderOfTheObject) {
  const RgbdFrame frame = make_frame();
  const ModelLibrary library = make_library();
  for (const double depth_m : {0.4, 0.8, 2.0}) {
    const report::Outline outline =
        report::project_outline(frame.camera, at(0, 0, depth_m), library.objects[2].surface, library.surface_voxel_m);
    const double radius_m = 0.08;
    const double circle_px = frame.camera.fx * radius_m / std::sqrt(depth_m * depth_m - radius_m * radius_m);
    ASSERT_EQ(outline.size(), 1U) << "one component, without holes";
    double sum_px = 0;
    for (const cv::Point& point : outline[0]) {
      const double distance_px = std::hypot(point.x - frame.camera.cx, point.y - frame.camera.cy);
      EXPECT_NEAR(distance_px, circle_px, 1.6) << "depth " << depth_m;
      sum_px += distance_px;
    }
    EXPECT_GT(outline[0].size(), 30U);
    EXPECT_NEAR(sum_px / static_cast<double>(outline[0].size()), circle_px, 0.8) << "depth " << depth_m;
  }
}

// Intrinsics come from files.
TEST(ProjectOutline, AFocalLengthBeyondAllPixelsHasAnOutline) {
  Camera camera = make_frame().camera;
  camera.fx = camera.fy = 1e12;
  const ModelLibrary library = make_library();
  EXPECT_NO_THROW(std::ignore = report::project_outline(camera, at(0, 0, 0.8), library.objects[2].surface,
                                                        library.surface_voxel_m));
}

TEST(DrawOverlay, NothingDetectedLeavesThePictureAlone) { EXPECT_EQ(overlay_of({}), make_frame().color); }

TEST(DrawOverlay, ObjectsBehindOrBesideTheCameraAreNotDrawn) {
  const RgbdFrame frame = make_frame();
  EXPECT_EQ(overlay_of({make_detection(frame, 0, at(0, 0, -0.8))}), frame.color);
  EXPECT_EQ(overlay_of({make_detection(frame, 0, at(5, 0, 0.8))}), frame.color);
  EXPECT_EQ(overlay_of({make_detection(frame, 0, at(1e30, 0, 0.8))}), frame.color);
  EXPECT_GT(count_different(overlay_of({make_detection(frame, 0, at(0.48, 0, 0.8))}), frame.color), 20)
      << "half of it is in the picture";
}

TEST(DrawOverlay, MarksChangeTheLine) {
  const RgbdFrame frame = make_frame();
  const std::vector<Detection> ball = {make_detection(frame, 0, at(0, 0, 0.8))};
  const auto inked = [&](DetectionMark mark) { return count_different(overlay_of(ball, {mark}), frame.color); };
  const int solid = inked(DetectionMark::kCorrect);
  EXPECT_EQ(solid, inked(DetectionMark::kUnjudged));
  EXPECT_LT(inked(DetectionMark::kFalsePositive), 0.8 * solid);
  EXPECT_GT(inked(DetectionMark::kFalsePositive), 0.3 * solid);
  EXPECT_GT(inked(DetectionMark::kGhost), inked(DetectionMark::kFalsePositive)) << "the cross";
  EXPECT_LT(inked(DetectionMark::kIgnored), solid);
}

TEST(DrawOverlay, MissedTruthIsDottedWhite) {
  const RgbdFrame frame = make_frame();
  GroundTruthObject missed;
  missed.object = "ball";
  missed.camera_from_object = at(0, 0, 0.8);
  const std::vector<GroundTruthObject> truth = {missed};
  const Image<Rgb8> picture = draw_overlay(frame, make_library(), make_update(frame, 0), {}, truth, kNoLabels);
  EXPECT_GT(count_different(picture, frame.color), 50);
  EXPECT_GT(count_color(picture, {255, 255, 255}), 10);
}

TEST(DrawOverlay, LabelsAddText) {
  const RgbdFrame frame = make_frame();
  const std::vector<Detection> ball = {make_detection(frame, 0, at(0, 0, 0.8))};
  EXPECT_GT(count_color(overlay_of(ball, {}, {}), object_color(0)),
            300 + count_color(overlay_of(ball), object_color(0)));
}

TEST(DrawOverlay, TintsNovelPixelsGreenAndRemovedPointsRed) {
  const RgbdFrame frame = make_frame();
  SceneUpdate update = make_updates(frame)[1];
  update.detections.clear();
  const Image<Rgb8> picture = draw_overlay(frame, make_library(), update, {}, {}, kNoLabels);
  const Rgb8 novel = picture(100, 200);
  EXPECT_GT(novel.g, novel.r + 50);
  EXPECT_EQ(picture(100, 203), frame.color(100, 203)) << "beside the mask";
  const Eigen::Vector2d slab_center = frame.camera.project({0.2, 0.05, 1.1});
  const Rgb8 removed = picture(static_cast<int>(slab_center.x()), static_cast<int>(slab_center.y()));
  EXPECT_GT(removed.r, removed.g + 50);
  EXPECT_EQ(draw_overlay(frame, make_library(), update, {}, {}, {.show_changes = false}), frame.color);
}

TEST(DrawOverlay, TintsNovelPixelsOfAReducedView) {
  const RgbdFrame frame = make_frame();
  SceneUpdate update;
  update.changes.novel_mask = Image<std::uint8_t>(frame.camera.width / 2, frame.camera.height / 2, 0);
  update.changes.novel_mask(50, 100) = 1;
  const Image<Rgb8> picture = draw_overlay(frame, make_library(), update, {}, {}, kNoLabels);
  EXPECT_GT(picture(101, 201).g, picture(101, 201).r + 50);
  EXPECT_EQ(picture(102, 200), frame.color(102, 200)) << "beside the mask";
}

TEST(DrawChanges, IsGreyButForTheChanges) {
  RgbdFrame frame = make_frame();
  frame.color(10, 10) = {250, 20, 90};
  const Image<Rgb8> picture = draw_changes(frame, make_updates(frame)[1].changes);
  int coloured = 0;
  for (const Rgb8& pixel : picture.data()) coloured += pixel.r == pixel.g && pixel.g == pixel.b ? 0 : 1;
  EXPECT_EQ(picture(10, 10).r, picture(10, 10).b);
  EXPECT_GT(coloured, 30 + 500);
  EXPECT_LT(coloured, 6000);
  EXPECT_GT(picture(100, 200).g, picture(100, 200).r + 50);
}

TEST(DrawOverlay, SameInputSameBytes) {
  const RgbdFrame frame = make_frame();
  const SceneUpdate update = make_updates(frame)[0];
  const Image<Rgb8> once = draw_overlay(frame, make_library(), update);
  EXPECT_EQ(once, draw_overlay(frame, make_library(), update));
  EXPECT_EQ(encode_jpeg(once), encode_jpeg(once));
}

TEST(DrawOverlay, RefusesNonsense) {
  const RgbdFrame frame = make_frame();
  EXPECT_THROW((void)overlay_of({make_detection(frame, 3, at(0, 0, 1))}), std::invalid_argument);
  EXPECT_THROW((void)overlay_of({make_detection(frame, -1, at(0, 0, 1))}), std::invalid_argument);
  EXPECT_THROW((void)overlay_of({}, {DetectionMark::kGhost}), std::invalid_argument);
  EXPECT_THROW((void)overlay_of({}, {}, {.change_opacity = 1.5}), std::invalid_argument);
  EXPECT_THROW((void)overlay_of({}, {}, {.outline_px = 0}), std::invalid_argument);
  EXPECT_THROW((void)draw_overlay(RgbdFrame{}, make_library(), {}), std::invalid_argument);
  EXPECT_THROW((void)draw_changes(RgbdFrame{}, {}), std::invalid_argument);
}

TEST(LabelPainter, LabelsDoNotCoverEachOtherAndStayInside) {
  Image<Rgb8> picture(320, 240, {0, 0, 0});
  cv::Mat canvas = report::as_mat(picture);
  report::LabelPainter painter(canvas);
  const int num_labels = 8;
  std::vector<int> alone;
  for (int i = 0; i < num_labels; ++i) {
    const auto shade = static_cast<std::uint8_t>(20 + 10 * i);
    painter.draw("name", {310, 2, 30, 30}, {shade, 0, 0});
    alone.push_back(count_color(picture, {shade, 0, 0}));
  }
  for (int i = 0; i < num_labels; ++i) {
    const auto shade = static_cast<std::uint8_t>(20 + 10 * i);
    EXPECT_EQ(count_color(picture, {shade, 0, 0}), alone[static_cast<std::size_t>(i)])
        << "label " << i << " is covered";
    EXPECT_EQ(alone[static_cast<std::size_t>(i)], alone[0]) << "label " << i << " is cut off";
  }
  EXPECT_GT(alone[0], 200);
}

TEST(EncodeJpeg, DecodesToAboutTheSamePicture) {
  Image<Rgb8> picture(64, 32, {200, 40, 90});
  const std::vector<std::uint8_t> bytes = encode_jpeg(picture, 95);
  const cv::Mat decoded = cv::imdecode(bytes, cv::IMREAD_COLOR);
  ASSERT_EQ(decoded.cols, 64);
  ASSERT_EQ(decoded.rows, 32);
  const cv::Vec3b bgr = decoded.at<cv::Vec3b>(10, 10);
  EXPECT_NEAR(bgr[2], 200, 6);
  EXPECT_NEAR(bgr[1], 40, 6);
  EXPECT_NEAR(bgr[0], 90, 6);
}

TEST(EncodeJpeg, ShrinksButNeverEnlarges) {
  const Image<Rgb8> picture(64, 32);
  EXPECT_EQ(cv::imdecode(encode_jpeg(picture, 80, 16), cv::IMREAD_COLOR).size(), cv::Size(16, 8));
  EXPECT_EQ(cv::imdecode(encode_jpeg(picture, 80, 640), cv::IMREAD_COLOR).size(), cv::Size(64, 32));
  EXPECT_THROW((void)encode_jpeg({}), std::invalid_argument);
  EXPECT_THROW((void)encode_jpeg(picture, 0), std::invalid_argument);
  EXPECT_THROW((void)encode_jpeg(picture, 80, -1), std::invalid_argument);
}

}  // namespace
}  // namespace resight
