// SPDX-License-Identifier: Apache-2.0
// The recogniser with hypotheses that are given, view by view: what it makes of them over time.
#include "resight/recognition/scene_recognizer.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <set>

#include "resight/recognition/box_scene_test_util.hpp"

namespace resight {
namespace {

using namespace analytic;
using test::BoxScene;

TEST(SceneRecognizer, RemembersObjectsBeyondTheLastViews) {
  BoxScene c;
  c.config.num_previous_views = 1;
  for (const SceneUpdate& update : c.run()) {
    ASSERT_EQ(update.detections.size(), 1U) << update.view;
    EXPECT_EQ(update.detections[0].object, kBox);
    EXPECT_EQ(update.detections[0].track, 0);
  }
  c.config.remember_objects = false;
  c.config.search = {};
  const std::vector<SceneUpdate> forgetful = c.run();
  EXPECT_EQ(forgetful[1].detections.size(), 1U);
  EXPECT_TRUE(forgetful[2].detections.empty());
}

TEST(SceneRecognizer, AnInaccuratePoseIsCorrected) {
  BoxScene c;
  const Rigid3 truth = c.cameras[1];
  RgbdFrame second = render(c.world, truth).frame;
  second.world_from_camera =
      truth * Rigid3{Rigid3::from_axis_angle({1, 2, 0}, 0.015).rotation, Eigen::Vector3d(0.008, -0.004, 0.003)};
  for (const bool correct : {true, false}) {
    c.config.camera.poses.correct = correct;
    SceneRecognizer recognizer(c.library, c.config, c.store);
    recognizer.add_view(render(c.world, c.cameras[0]).frame);
    const SceneUpdate update = recognizer.add_view(second);
    const double off_m = (update.world_from_camera.translation - truth.translation).norm();
    EXPECT_EQ(off_m < 0.005, correct) << off_m;  // given: 9 mm off; little but the box tells along the table
    EXPECT_LT(update.changes.removed_in_world.size(), 20U);
  }
}

TEST(SceneRecognizer, AViewWithASuspectPoseLeavesNoTrace) {
  BoxScene c;
  SceneRecognizer recognizer(c.library, c.config, c.store);
  recognizer.add_view(render(c.world, c.cameras[0]).frame);
  recognizer.add_view(render(c.world, c.cameras[1]).frame);
  RgbdFrame wrong = render(c.world, c.cameras[2]).frame;
  wrong.world_from_camera = Rigid3::from_translation({0.1, 0.1, 0.25}) * wrong.world_from_camera;
  const SceneUpdate suspect = recognizer.add_view(wrong);
  EXPECT_TRUE(suspect.changes.pose_suspect);
  EXPECT_TRUE(suspect.events.empty());
  const SceneUpdate last = recognizer.add_view(render(c.world, c.cameras[3]).frame);
  for (const ObjectEvent& event : last.events) EXPECT_FALSE(is_change(event.kind));
  EXPECT_LT(last.changes.removed_in_world.size(), 20U);
  ASSERT_EQ(last.detections.size(), 1U);
  EXPECT_EQ(last.detections[0].track, 0);
}

TEST(SceneRecognizer, SingleViewsAreSingle) {
  BoxScene c;
  c.config.num_previous_views = 0;
  const std::vector<SceneUpdate> updates = c.run();
  EXPECT_EQ(updates[0].detections.size(), 1U);
  EXPECT_TRUE(updates[1].detections.empty());
}

TEST(SceneRecognizer, ATrackedObjectTakenAwayIsNotDetected) {
  BoxScene c;
  SceneRecognizer recognizer(c.library, c.config, c.store);
  EXPECT_EQ(recognizer.add_view(render(c.world, c.cameras[0]).frame).detections.size(), 1U);
  EXPECT_EQ(recognizer.add_view(render(c.world, c.cameras[1]).frame).detections.size(), 1U);
  c.world.solids.clear();
  EXPECT_TRUE(recognizer.add_view(render(c.world, c.cameras[2]).frame).detections.empty());
  const SceneUpdate last = recognizer.add_view(render(c.world, c.cameras[3]).frame);
  EXPECT_TRUE(last.detections.empty());
  ASSERT_EQ(last.events.size(), 1U);
  EXPECT_EQ(last.events[0].kind, ObjectEventKind::kRemoved);
}

TEST(SceneRecognizer, APlaceThatHasChangedIsSearched) {
  BoxScene c;
  c.config.search.max_new_share = 0.5;  // So that the free place alone is not new enough.
  SceneRecognizer recognizer(c.library, c.config, c.store);
  const auto is_searched = [&] { return recognizer.add_view(render(c.world, c.cameras[0]).frame).searched; };
  EXPECT_TRUE(is_searched());
  EXPECT_FALSE(is_searched());
  c.world.solids.clear();
  EXPECT_TRUE(is_searched());
  EXPECT_FALSE(is_searched());
}

// What a search finds: every n-th point of the surface has a partner in the scene.
ViewHypotheses found_by_search(const BoxScene& c, int view, std::size_t stride) {
  const Rigid3& pose = c.world.solids[0].world_from_object;
  ViewHypotheses found;
  found.world_from_camera = c.cameras[0];
  Hypothesis& hypothesis = found.hypotheses.emplace_back(make_hypothesis(kBox, pose));
  hypothesis.origin_view = view;
  const std::vector<Eigen::Vector3f>& points = c.library.objects[kBox].surface.points;
  for (std::size_t i = 0; i < points.size(); i += stride) {
    Correspondence& match = hypothesis.correspondences.emplace_back();
    match.model_point = points[i];
    match.scene_point = Rigid3f(pose) * points[i];
  }
  return found;
}

TEST(SceneRecognizer, CorrespondencesDoNotHoldAnObjectThatIsPushed) {
  BoxScene c;
  c.config.camera.poses.correct = false;  // Little but the box tells where the camera is.
  c.store = std::make_shared<ViewHypothesisStore>();
  c.store->add(0, found_by_search(c, 0, 1));
  c.store->add(1, {});
  BoxScene pushed = c;
  pushed.world.solids[0].world_from_object.translation += Eigen::Vector3d(0.012, 0.008, 0);
  c.store->add(2, found_by_search(pushed, 2, 50));
  c.store->add(3, {});
  SceneRecognizer recognizer(c.library, c.config, c.store);
  for (int view = 0; view < 2; ++view) recognizer.add_view(render(c.world, c.cameras[0]).frame);
  for (int view = 2; view < 4; ++view) {
    const SceneUpdate update = recognizer.add_view(render(pushed.world, c.cameras[0]).frame);
    ASSERT_EQ(update.detections.size(), 1U) << view;
    const Rigid3& pose = pushed.world.solids[0].world_from_object;
    EXPECT_LT((update.detections[0].world_from_object.translation - pose.translation).norm(), 0.004) << view;
  }
}

TEST(SceneRecognizer, AnObjectOutOfSightIsTrackedButNotDetected) {
  BoxScene c;
  const Eigen::Vector3d eye = c.cameras[0].translation;
  c.cameras[1] = look_at(eye, eye + Eigen::Vector3d(eye.x(), eye.y(), -0.6));  // The other way.
  const std::vector<SceneUpdate> updates = c.run();
  EXPECT_EQ(updates[0].detections.size(), 1U);
  EXPECT_TRUE(updates[1].detections.empty());
  ASSERT_EQ(updates[1].events.size(), 1U);
  EXPECT_EQ(updates[1].events[0].kind, ObjectEventKind::kStillThere);
  EXPECT_EQ(updates[2].detections.size(), 1U);
  c.config.detections.min_reported_share = 0;
  EXPECT_EQ(c.run()[1].detections.size(), 1U);
}

TEST(SceneRecognizer, AnUnlikelyObjectIsTrackedButNotDetected) {
  BoxScene c;
  const std::vector<SceneUpdate> all = c.run();
  ASSERT_EQ(all[1].detections.size(), 1U);
  const double score = all[1].detections[0].score;
  ASSERT_LT(score, 1);
  c.config.detections.min_score = 0.5 * (1 + score);
  const std::vector<SceneUpdate> few = c.run();
  EXPECT_TRUE(few[1].detections.empty());
  ASSERT_EQ(few[1].events.size(), all[1].events.size());
  for (std::size_t e = 0; e < all[1].events.size(); ++e) EXPECT_EQ(few[1].events[e].kind, all[1].events[e].kind);
}

TEST(SceneRecognizer, ASecondInstanceNeedsMoreEvidence) {
  BoxScene c;
  Solid second = c.world.solids[0];
  second.world_from_object.translation += Eigen::Vector3d(0.25, 0.1, 0);
  c.world.solids.push_back(second);
  ViewHypotheses both;
  both.world_from_camera = c.cameras[0];
  for (const Solid& box : c.world.solids) {
    Hypothesis& hypothesis = both.hypotheses.emplace_back(make_hypothesis(kBox, box.world_from_object));
    hypothesis.id = both.hypotheses.size();
    hypothesis.origin_view = 0;
    hypothesis.origin_views = {0};
  }
  const auto scores = [&](double further_instance_odds) {
    c.config.detections.further_instance_odds = further_instance_odds;
    c.store = std::make_shared<ViewHypothesisStore>();
    c.store->add(0, ViewHypotheses(both));
    SceneRecognizer recognizer(c.library, c.config, c.store);
    std::vector<double> found;
    for (const Detection& d : recognizer.add_view(render(c.world, c.cameras[0]).frame).detections)
      found.push_back(d.score);
    return found;
  };
  const std::vector<double> alone = scores(1);
  const std::vector<double> together = scores(0.2);
  ASSERT_EQ(alone.size(), 2U);
  ASSERT_EQ(together.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) EXPECT_LT(together[i], alone[i]);
}

TEST(SceneRecognizer, AnObjectWithoutDepthIsConfirmedByItsTexture) {
  const BoxScene c;
  for (const bool has_colors : {true, false}) {
    SceneRecognizer recognizer(c.library, c.config, c.store);
    EXPECT_EQ(recognizer.add_view(render(c.world, c.cameras[0]).frame).detections.size(), 1U);
    RgbdFrame blind = render(c.world, c.cameras[1]).frame;
    for (std::size_t i = 0; i < blind.depth_m.size(); ++i) blind.depth_m[i] = std::numeric_limits<float>::quiet_NaN();
    if (!has_colors)
      for (std::size_t i = 0; i < blind.color.size(); ++i) blind.color[i] = {128, 128, 128};
    const SceneUpdate update = recognizer.add_view(std::move(blind));
    ASSERT_EQ(update.detections.size(), has_colors ? 1U : 0U);
    for (const Detection& detection : update.detections) EXPECT_GT(detection.views.back().color_share, 0.1);
  }
}

TEST(SceneRecognizer, RefutedHypothesesAreNotCarriedOver) {
  BoxScene c;
  ViewHypotheses first;
  first.world_from_camera = c.cameras[0];
  const Rigid3& right = c.world.solids[0].world_from_object;
  first.hypotheses = {make_hypothesis(kBox, right), make_hypothesis(kBox, right)};
  first.hypotheses[1].world_from_object.translation += Eigen::Vector3d(0.2, 0.1, 0.05);  // Over the empty table.
  for (std::size_t h = 0; h < 2; ++h) {
    first.hypotheses[h].id = h;
    first.hypotheses[h].origin_view = 0;
    first.hypotheses[h].origin_views = {0};
  }
  c.store->add(0, std::move(first));
  c.config.remember_objects = false;
  c.config.search = {};
  c.config.hypotheses.min_carried_share = 0.4;
  for (const SceneUpdate& update : c.run()) {
    EXPECT_EQ(update.counts.merged, update.view == 0 ? 2 : 1) << update.view;
    EXPECT_EQ(update.detections.size(), 1U) << update.view;
  }
  c.config.hypotheses.min_carried_share = 0;
  for (const SceneUpdate& update : c.run()) EXPECT_EQ(update.counts.merged, 2) << update.view;
}

TEST(SceneRecognizer, LateHypothesesAreVerifiedInTheNextView) {
  BoxScene c;
  ViewHypotheses first = *c.store->find(0);
  const Hypothesis right = first.hypotheses[0];
  first.hypotheses.clear();
  for (int i = 0; i < 13; ++i) {  // All but the last over the empty table.
    first.hypotheses.push_back(right);
    first.hypotheses.back().id = static_cast<std::uint64_t>(i);
    if (i < 12) first.hypotheses.back().world_from_object.translation += Eigen::Vector3d(0, 0.1, 0.1 + 0.1 * i);
  }
  c.store->add(0, std::move(first));
  c.config.run.deadline_ms = 500;
  double now_s = 0;
  int num_calls = 0;  // When the view comes, before its verification, ...
  SceneRecognizer recognizer(c.library, c.config, c.store, [&] { return now_s += ++num_calls == 2 ? 1 : 0; });
  const SceneUpdate late = recognizer.add_view(render(c.world, c.cameras[0]).frame);
  EXPECT_TRUE(late.detections.empty());
  EXPECT_EQ(late.left_out, std::vector<std::string>{"verification of 3 of 13 hypotheses"});
  const SceneUpdate in_time = recognizer.add_view(render(c.world, c.cameras[1]).frame);
  EXPECT_EQ(in_time.detections.size(), 1U);
  EXPECT_TRUE(in_time.left_out.empty());
  // What is known is looked at, however late it is.
  num_calls = 0;
  EXPECT_EQ(recognizer.add_view(render(c.world, c.cameras[2]).frame).detections.size(), 1U);
}

TEST(SceneRecognizer, ALateViewIsNotSearched) {
  BoxScene c;
  double now_s = 0;
  c.config.run.deadline_ms = 500;
  SceneRecognizer late(c.library, c.config, nullptr, [&] { return now_s += 1; });
  const SceneUpdate update = late.add_view(render(c.world, c.cameras[0]).frame);
  EXPECT_EQ(update.left_out, std::vector<std::string>{"search"});
  EXPECT_EQ(update.counts.generated, 0);
  c.config.run.deadline_ms.reset();
  SceneRecognizer patient(c.library, c.config, nullptr, [&] { return now_s += 1; });
  EXPECT_TRUE(patient.add_view(render(c.world, c.cameras[0]).frame).left_out.empty());
}

TEST(SceneRecognizer, TheShapeSearchIsNotBegunTooLate) {
  BoxScene c;
  c.config.run.deadline_ms = 500;
  int num_calls = 0;
  // Asked when the view comes, before the search, and before the shape search.
  SceneRecognizer recognizer(c.library, c.config, nullptr, [&] { return ++num_calls < 3 ? 0.0 : 1.0; });
  const SceneUpdate update = recognizer.add_view(render(c.world, c.cameras[0]).frame);
  ASSERT_FALSE(update.left_out.empty());
  EXPECT_EQ(update.left_out[0], "shape search");
}

TEST(SceneRecognizer, HypothesesHaveUniqueIds) {
  BoxScene c;
  SceneRecognizer recognizer(c.library, c.config);
  std::set<std::uint64_t> ids;
  for (std::size_t view = 0; view < c.cameras.size(); ++view) {
    RecognitionTrace trace;
    (void)recognizer.add_view(render(c.world, c.cameras[view]).frame, &trace);
    std::set<std::uint64_t> of_view;
    for (const Hypothesis& h : trace.merged) EXPECT_TRUE(of_view.insert(h.id).second) << h.id;
    ids.merge(of_view);
  }
  EXPECT_GT(ids.size(), 3U);
}

}  // namespace
}  // namespace resight
