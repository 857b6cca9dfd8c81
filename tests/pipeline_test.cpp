// SPDX-License-Identifier: Apache-2.0
// The whole pipeline on simulated scenes without sensor noise and with exact ground truth: views in, objects and
// changes out.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <sstream>

#include "resight/evaluation/loss.hpp"
#include "resight/evaluation/match_detections.hpp"
#include "resight/evaluation/match_view.hpp"
#include "resight/recognition/recognize_sequence.hpp"
#include "resight/report/results.hpp"
#include "resight/report/view_record.hpp"
#include "resight/sensor/testing/memory_sequence.hpp"
#include "resight/simulation/presets.hpp"
#include "resight/simulation/simulation.hpp"
#include "resight/training/training.hpp"

namespace resight {
namespace {

constexpr int kThreads = 2;
constexpr double kHalfVisible = 0.5;

// Simulated and trained once, shared by all tests.
struct World {
  ModelLibrary library;
  std::vector<SimulatedView> views;
  std::vector<ScriptedEvent> events;
};

World make_world() {
  SceneScript script = make_demo_scene(1);
  script.sensor.noise_free = true;
  auto simulation = Simulation::create(script, 1, {.num_threads = kThreads});
  World world;
  if (!simulation.ok()) throw std::runtime_error(simulation.error().message);
  TrainOptions options;
  options.num_threads = kThreads;
  for (const ProceduralObject& object : simulation->library()) {
    auto model = train_object(object.name, object.mesh, options);
    if (!model.ok()) throw std::runtime_error(model.error().message);
    model->symmetries = object.symmetries;
    model->bop_id = static_cast<int>(world.library.objects.size()) + 1;
    world.library.objects.push_back(std::move(*model));
  }
  for (int v = 0; v < simulation->num_views(); ++v) world.views.push_back(simulation->render_view(v));
  world.events = simulation->events();
  return world;
}

const World& world() {
  static const World instance = make_world();
  return instance;
}

std::vector<SceneUpdate> recognize(const std::string& preset, int num_previous_views, int num_threads,
                                   std::size_t num_views, std::vector<RecognitionTrace>* traces = nullptr) {
  RecognizerConfig config = RecognizerConfig::from_preset(preset);
  config.num_previous_views = num_previous_views;
  config.set_num_threads(num_threads);
  SceneRecognizer recognizer(world().library, config);
  std::vector<RgbdFrame> frames;
  for (std::size_t v = 0; v < num_views; ++v) frames.push_back(world().views[v].frame);
  std::vector<SceneUpdate> updates;
  RecognitionTrace trace;
  const auto on_view = [&](const RgbdFrame&, SceneUpdate& update) {
    updates.push_back(std::move(update));
    if (traces != nullptr) traces->push_back(trace);
  };
  auto events = recognize_sequence(recognizer, test::MemorySequence(std::move(frames)), on_view,
                                   traces != nullptr ? &trace : nullptr)
                    .value();
  for (std::size_t v = 0; v < num_views; ++v) updates[v].events = std::move(events[v]);
  return updates;
}

struct PresetRun {
  std::vector<SceneUpdate> updates;
  std::vector<RecognitionTrace> traces;
};

const PresetRun& run_of(const std::string& preset) {
  static std::map<std::string, PresetRun> runs;
  const auto [found, is_new] = runs.try_emplace(preset);
  if (is_new) found->second.updates = recognize(preset, 5, kThreads, world().views.size(), &found->second.traces);
  return found->second;
}

// Describes where an object was lost, for the messages of failing tests.
std::string describe_loss(std::size_t view, const GroundTruthObject& truth, const RecognitionTrace& trace,
                          const MatchDetectionsOptions& match) {
  FindLossOptions options;
  options.match = match;
  const Loss loss = find_loss(truth, world().views[view].frame.world_from_camera, trace, world().library, options);
  std::ostringstream text;
  text << "view " << view << " " << truth.object << ": " << to_string(loss.stage);
  if (loss.best) text << ", best " << 1e3 * loss.best->center_distance_m << " mm " << loss.best->rotation_rad << " rad";
  if (loss.evidence)
    text << ", " << to_string(loss.evidence->verdict) << ", explained " << loss.evidence->explained_share
         << ", unary cost " << loss.evidence->costs.unary;
  text << "\n";
  return text.str();
}

// Required results of a preset. `default` may lose or add one object in a hundred, because different last bits of
// floating-point results can affect one. The paper's system loses untextured objects and confuses parts of unknown ones
// with them.
struct Goal {
  std::string preset;
  double min_recall;
  double min_precision;
  int max_false_changes;
};
void PrintTo(const Goal& goal, std::ostream* out) { *out << goal.preset; }

class PipelineTest : public ::testing::TestWithParam<Goal> {};

// Within 5 mm and 3 deg.
TEST_P(PipelineTest, HalfVisibleObjectsAreFoundExactly) {
  MatchDetectionsOptions exact;
  exact.max_center_distance_m = 0.005;
  exact.max_rotation_rad = 3.0 * 0.0174533;
  exact.min_visible_share = kHalfVisible;
  const PresetRun& run = run_of(GetParam().preset);
  RecognitionScore score;
  std::string missed;
  for (std::size_t v = 0; v < world().views.size(); ++v) {
    const auto detections = to_detected_objects(run.updates[v], world().library);
    const auto& truth = world().views[v].ground_truth;
    const auto result = match_detections(truth, detections, world().library, exact);
    score += result.score;
    for (const int t : result.false_negatives)
      missed += describe_loss(v, truth[static_cast<std::size_t>(t)], run.traces[v], exact);
  }
  EXPECT_GT(score.true_positives + score.false_negatives, 60);
  EXPECT_GE(score.recall(), GetParam().min_recall) << missed;
  EXPECT_GE(score.precision(), GetParam().min_precision);
}

TEST_P(PipelineTest, EveryScriptedChangeIsReportedOnce) {
  const std::map<ChangeKind, ObjectEventKind> kinds{{ChangeKind::kAdded, ObjectEventKind::kAdded},
                                                    {ChangeKind::kMoved, ObjectEventKind::kMoved},
                                                    {ChangeKind::kRemoved, ObjectEventKind::kRemoved}};
  std::vector<ObjectEvent> reported;
  for (const SceneUpdate& update : run_of(GetParam().preset).updates)
    for (const ObjectEvent& event : update.events)
      if (is_change(event.kind)) reported.push_back(event);
  int num_scripted = 0;
  for (const ScriptedEvent& scripted : world().events) {
    if (!scripted.known) continue;
    ++num_scripted;
    const auto same = std::count_if(reported.begin(), reported.end(), [&](const ObjectEvent& e) {
      return world().library.objects[static_cast<std::size_t>(e.object)].name == scripted.object &&
             e.kind == kinds.at(scripted.kind) && e.view >= scripted.view && e.view <= scripted.view + 2;
    });
    EXPECT_EQ(same, 1) << to_string(scripted.kind) << " " << scripted.object << " at view " << scripted.view;
  }
  EXPECT_GE(num_scripted, 4);
  EXPECT_LE(static_cast<int>(reported.size()), num_scripted + GetParam().max_false_changes)
      << "changes were reported that did not happen";
}

INSTANTIATE_TEST_SUITE_P(Presets, PipelineTest,
                         ::testing::Values(Goal{"mvr-chd", 0.85, 0.7, 5}, Goal{"default", 0.98, 0.98, 0}),
                         [](const auto& goal) {
                           return goal.param.preset == "default" ? std::string("best") : std::string("chd");
                         });

// From the third view on, a confirmed object yields keypoints in one of four views only, unless the required explained
// share is never reached.
TEST(Pipeline, WhatIsKnownAndConfirmedIsNotSearchedForInEachView) {
  constexpr std::size_t kViews = 3;
  RecognizerConfig config = RecognizerConfig::from_preset("default");
  config.search.place_interval.reset();
  config.search.max_new_share.reset();  // Every view is searched.
  config.set_num_threads(kThreads);
  SceneRecognizer everywhere(world().library, config);
  config.search.place_interval = 4;
  config.search.min_explained_share = 0;
  SceneRecognizer attentive(world().library, config);
  config.search.min_explained_share = 1;
  SceneRecognizer tentative(world().library, config);
  for (std::size_t v = 0; v < kViews; ++v) {
    RecognitionTrace all, less, again;
    const SceneUpdate a = everywhere.add_view(world().views[v].frame, &all);
    const SceneUpdate b = attentive.add_view(world().views[v].frame, &less);
    (void)tentative.add_view(world().views[v].frame, &again);
    EXPECT_EQ(a.detections.size(), b.detections.size()) << v;
    EXPECT_EQ(all.sift.size(), again.sift.size()) << v;
    if (v + 1 < kViews) {
      EXPECT_EQ(all.shot.size(), less.shot.size()) << v;
    } else {
      EXPECT_LT(2 * less.sift.size(), all.sift.size()) << "most of the texture is on known objects";
      EXPECT_LT(less.shot.size(), all.shot.size());
    }
  }
}

TEST_P(PipelineTest, OneAndTwoThreadsGiveTheSameBytes) {
  constexpr std::size_t kViews = 5;
  std::vector<std::string> texts;
  for (const int num_threads : {1, 2}) {
    ReportRun run;
    for (SceneUpdate& update : recognize(GetParam().preset, 2, num_threads, kViews)) {
      ViewRecord record;
      record.update = std::move(update);
      record.update.times = {};
      run.views.push_back(std::move(record));
    }
    texts.push_back(format_detections_json(run, world().library) + format_changes_json(run, world().library) +
                    format_detections_csv(run, world().library));
  }
  EXPECT_EQ(texts[0], texts[1]);
  EXPECT_GT(texts[0].size(), 2000U);
}

TEST(Pipeline, ASingleViewIsRecognizedToo) {
  const auto updates = recognize("mvr-chd", 0, kThreads, 2);
  EXPECT_FALSE(updates[0].detections.empty());
  EXPECT_FALSE(updates[1].detections.empty());
  EXPECT_TRUE(updates[1].changes.removed_in_world.empty());
}

TEST(Pipeline, AViewWithoutAnyDepthIsAnHonestNothing) {
  RecognizerConfig config = RecognizerConfig::from_preset("mvr-chd");
  SceneRecognizer recognizer(world().library, config);
  RgbdFrame blind = world().views[0].frame;
  for (float& z : blind.depth_m.data()) z = std::numeric_limits<float>::quiet_NaN();
  EXPECT_TRUE(recognizer.add_view(blind).detections.empty());
  const SceneUpdate next = recognizer.add_view(world().views[1].frame);
  EXPECT_FALSE(next.detections.empty());
  const SceneUpdate after = recognizer.add_view(blind);
  EXPECT_TRUE(after.changes.removed_in_world.empty());
  EXPECT_EQ(std::count_if(after.events.begin(), after.events.end(), [](const auto& e) { return is_change(e.kind); }),
            0);
}

TEST(Pipeline, WithoutModelsNothingIsRecognizedButChangesAreSeen) {
  const ModelLibrary empty;
  SceneRecognizer recognizer(empty, RecognizerConfig::from_preset("mvr-chd"));
  std::size_t num_removed = 0;
  for (const SimulatedView& view : world().views) {
    const SceneUpdate update = recognizer.add_view(view.frame);
    EXPECT_TRUE(update.detections.empty());
    num_removed += update.changes.removed_in_world.size();
  }
  EXPECT_GT(num_removed, 100U);
}

TEST(Pipeline, ABadFrameIsRefusedAndNothingIsLost) {
  SceneRecognizer recognizer(world().library, RecognizerConfig::from_preset("mvr-chd"));
  RgbdFrame bad = world().views[0].frame;
  bad.world_from_camera.rotation.setConstant(std::numeric_limits<double>::quiet_NaN());
  EXPECT_THROW((void)recognizer.add_view(bad), std::invalid_argument);
  const SceneUpdate update = recognizer.add_view(world().views[0].frame);
  EXPECT_EQ(update.view, 0);
  EXPECT_FALSE(update.detections.empty());
}

}  // namespace
}  // namespace resight
