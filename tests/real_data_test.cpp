// SPDX-License-Identifier: Apache-2.0
// The whole pipeline on external data: real and path-traced views, scanned models. Skipped if the data sets are
// missing. Limits are values that were reached, not goals.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "resight/io/model_source.hpp"
#include "resight/io/sequence.hpp"
#include "resight/recognition/recognize_sequence.hpp"
#include "resight/report/view_record.hpp"
#include "resight/training/train_library.hpp"

namespace resight {
namespace {

constexpr int kThreads = 2;

std::filesystem::path shared_data(const std::string& name) {
  return std::filesystem::path(RESIGHT_SHARED_DATA_DIR) / name;
}

#define RESIGHT_NEEDS_DATA(name) \
  if (!std::filesystem::exists(shared_data(name))) GTEST_SKIP() << "no data set " << (name)

ModelLibrary train(const std::vector<std::string>& paths) {
  std::vector<std::filesystem::path> inputs;
  for (const std::string& path : paths) inputs.push_back(shared_data(path));
  TrainOptions options;
  options.num_threads = kThreads;
  const auto locations = find_models(inputs);
  if (!locations.ok()) throw std::runtime_error(locations.error().message);
  auto library = train_library(*locations, options);
  if (!library.ok()) throw std::runtime_error(library.error().message);
  return *std::move(library);
}

// A sequence recognised from first to last view, with its scores (5 cm, 30 deg).
struct Recognition {
  std::vector<SceneUpdate> updates;
  std::vector<ViewEvaluation> evaluations;  // Per view; empty without ground truth.
  [[nodiscard]] RecognitionScore score() const {
    RecognitionScore sum;
    for (const ViewEvaluation& evaluation : evaluations) sum += evaluation.matching.score;
    return sum;
  }
};

Recognition recognize(const ModelLibrary& library, const std::string& dataset, const std::string& preset) {
  const auto sequence = open_sequence(shared_data(dataset));
  if (!sequence.ok()) throw std::runtime_error(sequence.error().message);
  RecognizerConfig config = RecognizerConfig::from_preset(preset);
  config.set_num_threads(kThreads);
  SceneRecognizer recognizer(library, config);
  std::vector<TruthView> truth;
  Recognition run;
  const auto events = recognize_sequence(recognizer, **sequence, [&](const RgbdFrame& frame, SceneUpdate& update) {
    run.updates.push_back(std::move(update));
    if (!(*sequence)->has_ground_truth()) return;
    truth.push_back({frame.world_from_camera, (*sequence)->read_ground_truth(run.updates.back().view).value()});
    run.evaluations.push_back(
        evaluate_view(run.updates.back(), truth.back(), find_former_places(truth, library), frame.camera, library));
  });
  if (!events.ok()) throw std::runtime_error(events.error().message);
  return run;
}

// Two real views of one table, between which all objects were exchanged.
TEST(RealData, BoxesOnATableAndTheirExchange) {
  RESIGHT_NEEDS_DATA("table-two-states");
  RESIGHT_NEEDS_DATA("ycb-meshes");
  const ModelLibrary library = train({"ycb-meshes/003_cracker_box", "ycb-meshes/009_gelatin_box"});
  const Recognition run = recognize(library, "table-two-states", "default");
  ASSERT_EQ(run.evaluations.size(), 2U);
  for (const ViewEvaluation& evaluation : run.evaluations) {
    EXPECT_EQ(evaluation.matching.score.true_positives, 1);
    EXPECT_EQ(evaluation.matching.score.false_negatives, 0);
    EXPECT_EQ(evaluation.matching.score.false_positives, 0);
    EXPECT_TRUE(evaluation.ghosts.empty());
  }
  EXPECT_GT(run.updates[1].changes.removed_in_world.size(), 1000U);
}

TEST(RealData, ScannedObjectsOnARenderedTable) {
  RESIGHT_NEEDS_DATA("table-rendered");
  const ModelLibrary library = train({"table-rendered/models"});
  const RecognitionScore score = recognize(library, "table-rendered", "default").score();
  RecordProperty("precision", std::to_string(score.precision()));
  RecordProperty("recall", std::to_string(score.recall()));
  EXPECT_GE(score.precision(), 0.92);
  EXPECT_GE(score.recall(), 0.86);
}

// All annotated objects in the two real views, with additional models of absent objects.
TEST(RealData, NineObjectsOnATableAndTheirExchange) {
  RESIGHT_NEEDS_DATA("table-two-states");
  RESIGHT_NEEDS_DATA("ycb-meshes");
  const Recognition run = recognize(train({"ycb-meshes"}), "table-two-states", "default");
  EXPECT_GE(run.score().true_positives, 7);
  EXPECT_LE(run.score().false_positives, 0);
  for (const ViewEvaluation& evaluation : run.evaluations) EXPECT_TRUE(evaluation.ghosts.empty());
}

// The bowl stands upright in its file, off the origin. The others have texture or a handle.
TEST(RealData, SymmetriesOfScannedObjects) {
  RESIGHT_NEEDS_DATA("ycb-meshes");
  const auto find = [](const std::string& name) {
    const ModelSource source = read_model(find_models({shared_data("ycb-meshes/" + name)}).value().front()).value();
    return find_symmetries(train_surface(name, *source.mesh).value());
  };
  const ObjectSymmetries bowl = find("024_bowl");
  EXPECT_TRUE(bowl.discrete.empty());
  ASSERT_EQ(bowl.continuous.size(), 1U);
  EXPECT_LT(bowl.continuous[0].direction.cross(Eigen::Vector3d::UnitZ()).norm(), 0.05);
  for (const char* name : {"003_cracker_box", "005_tomato_soup_can", "006_mustard_bottle", "025_mug"})
    EXPECT_TRUE(find(name).none()) << name;
}

// Share of the camera-facing, unoccluded surface that agrees with the measured depth.
double agreement(const ObjectModel& model, const Detection& detection, const RgbdFrame& frame) {
  const Rigid3 camera_from_object = frame.world_from_camera.inverse() * detection.world_from_object;
  int close = 0;
  int all = 0;
  for (std::size_t i = 0; i < model.surface.size(); ++i) {
    const Eigen::Vector3d p = camera_from_object * model.surface.points[i].cast<double>();
    const Eigen::Vector3d n = camera_from_object.rotation * model.surface.normals[i].cast<double>();
    const Eigen::Vector2d pixel = frame.camera.project(p);
    if (n.dot(p) > 0 || !frame.camera.contains(pixel)) continue;
    const double z = frame.depth_m(static_cast<int>(pixel.x() + 0.5), static_cast<int>(pixel.y() + 0.5));
    if (!(p.z() < z + 0.03)) continue;  // Occluded, or no return.
    ++all;
    close += std::abs(p.z() - z) < 0.01 ? 1 : 0;
  }
  return all == 0 ? 0.0 : static_cast<double>(close) / all;
}

// A carton known from one view without colours, at another place among other objects.
TEST(RealData, AMilkCartonByItsShapeAlone) {
  RESIGHT_NEEDS_DATA("pcl-milk");
  const ModelLibrary library = train({"pcl-milk"});
  ASSERT_EQ(library.objects.size(), 1U);
  EXPECT_TRUE(library.objects[0].surface.colors.empty());
  const Recognition run = recognize(library, "pcl-milk", "default");
  ASSERT_EQ(run.updates.at(0).detections.size(), 1U);
  const RgbdFrame frame = open_sequence(shared_data("pcl-milk")).value()->read_view(0).value();
  EXPECT_GT(agreement(library.objects[0], run.updates[0].detections[0], frame), 0.8);
}

}  // namespace
}  // namespace resight
