// SPDX-License-Identifier: Apache-2.0
#include "resight/report/worst_views.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "resight/report/report_test_scene.hpp"

namespace resight {
namespace {

EvaluatedRun make_run(const std::string& preset) {
  EvaluatedRun run;
  run.sequence = "set/000001";
  run.preset = preset;
  run.num_previous_views = 5;
  EvaluatedTruth missed;
  missed.object = "ball";
  missed.visible_share = 0.5;
  missed.lost_at = "no keypoints";
  EvaluatedView view;
  view.name = "000000";
  view.truth = {missed};
  view.detections = {{"slab", Rigid3::from_translation({0.2, 0, 1.5}), 0.5, DetectionVerdict::kGhost}};
  view.score = {3, 1, 1};
  EvaluatedView worse = view;
  worse.name = "000001";
  worse.score = {0, 1, 9};
  EvaluatedView good;
  good.name = "000002";
  good.score = {5, 0, 0};
  run.views = {view, worse, good};
  return run;
}

TEST(WorstViews, WorstViewsOfEachConfigurationComeFirst) {
  const std::vector<EvaluatedRun> runs = {make_run("mvr"), make_run("default")};
  const std::vector<WorstView> worst = find_worst_views(runs);
  ASSERT_EQ(worst.size(), 4U);
  EXPECT_EQ(worst[0].view, 1);
  EXPECT_EQ(worst[1].view, 0);
  EXPECT_EQ(worst[1].rank, 1);
  EXPECT_EQ(worst[2].run, &runs[1]);
  EXPECT_EQ(worst[2].rank, 0);
  EXPECT_EQ(find_worst_views(runs, 1).size(), 2U);
}

TEST(WorstViews, ThePageNamesWhatWasMissedAndWhatWasWrong) {
  const std::vector<EvaluatedRun> runs = {make_run("mvr")};
  const std::string text = format_worst_views(find_worst_views(runs), 1);
  const auto worse = text.find("set/000001 view 000001: 9 missed, 1 wrong");
  const auto better = text.find("set/000001 view 000000: 1 missed, 1 wrong");
  ASSERT_NE(worse, std::string::npos);
  ASSERT_NE(better, std::string::npos);
  EXPECT_LT(worse, better);
  EXPECT_NE(text.find("missed ball 0 (50 % visible, at 0.00 m): no keypoints"), std::string::npos);
  EXPECT_NE(text.find("ghost slab (score 0.50, at 1.51 m)"), std::string::npos);
  EXPECT_NE(text.find("![000001](worst/mvr_k5_1.jpg)"), std::string::npos);
  EXPECT_EQ(text.find("![000000]"), std::string::npos);
}

TEST(WorstViews, ThePictureShowsWhatWasMissedAndWhatWasDetected) {
  const ModelLibrary library = test::make_library();
  const RgbdFrame frame = test::make_frame();
  GroundTruthObject ball;
  ball.object = "ball";
  ball.camera_from_object = Rigid3::from_translation({-0.2, 0, 1.2});
  const EvaluatedView view = make_run("mvr").views[0];
  const auto differs_near = [&](const Image<Rgb8>& picture, const Eigen::Vector3d& p) {
    const int u = static_cast<int>(frame.camera.fx * p.x() / p.z() + frame.camera.cx);
    const int v = static_cast<int>(frame.camera.fy * p.y() / p.z() + frame.camera.cy);
    for (int dv = -25; dv <= 25; ++dv)
      for (int du = -25; du <= 25; ++du)
        if (!(picture(u + du, v + dv) == frame.color(u + du, v + dv))) return true;
    return false;
  };
  const Image<Rgb8> picture = draw_evaluated_view(frame, library, std::vector{ball}, view);
  EXPECT_TRUE(differs_near(picture, {-0.2, 0, 1.2}));
  EXPECT_TRUE(differs_near(picture, {0.2, 0, 1.5}));
  EvaluatedView found = view;
  found.truth[0].found = true;
  found.detections.clear();
  const Image<Rgb8> nothing = draw_evaluated_view(frame, library, std::vector{ball}, found);
  EXPECT_TRUE(std::ranges::equal(nothing.data(), frame.color.data()));
}

}  // namespace
}  // namespace resight
