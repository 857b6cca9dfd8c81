// SPDX-License-Identifier: Apache-2.0
#include "stage_input.hpp"

#include "../quality/arguments.hpp"
#include "generated_truth.hpp"
#include "resight/features/shot.hpp"
#include "resight/features/sift.hpp"
#include "resight/models/library_file.hpp"
#include "resight/simulation/presets.hpp"
#include "resight/simulation/simulation.hpp"
#include "resight/training/training.hpp"

namespace resight::bench {
namespace {

constexpr int kDemoBefore = 4;
constexpr int kDemoView = 6;

StageInput start_input() {
  StageInput input;
  input.config = RecognizerConfig::from_preset("default");
  input.config.set_num_threads(1);
  // The stages are compared with the fastest normals; wider windows are measured separately.
  input.config.prepare.normals.window_radius_px = 2;
  return input;
}

void add_features(StageInput& input) {
  input.sift = extract_sift(input.view, input.config.features.sift);
  input.shot = extract_shot(input.view, input.config.features.shot);
  if (input.library.objects.empty()) return;
  const ModelFeatureIndex index(input.library, input.config.features.match);
  input.correspondences = index.match(input.sift, input.shot);
  input.hypotheses = generate_hypotheses(input.correspondences, input.view.frame.world_from_camera, 0, 0,
                                         input.config.hypotheses.generate);
}

}  // namespace

StageInput make_demo_input() {
  StageInput input = start_input();
  Simulation simulation = value_or_exit(Simulation::create(make_demo_scene(3), 3, {.num_threads = 2}));
  TrainOptions training;
  training.num_threads = 2;
  for (const ProceduralObject& object : simulation.library())
    input.library.objects.push_back(value_or_exit(train_object(object.name, object.mesh, training)));
  SimulatedView before = simulation.render_view(kDemoBefore);
  SimulatedView view = simulation.render_view(kDemoView);
  input.truth_before = truth_of_view(simulation, before, kDemoBefore, kDemoView);
  input.truth = truth_of_view(simulation, view, kDemoView, kDemoBefore);
  input.objects = view.ground_truth;
  input.before = prepare_view(std::move(before.frame), input.config.prepare);
  input.view = prepare_view(std::move(view.frame), input.config.prepare);
  add_features(input);
  return input;
}

StageInput read_input(const std::filesystem::path& sequence, int before, int view,
                      const std::filesystem::path& library_file) {
  StageInput input = start_input();
  const auto opened = value_or_exit(open_sequence(sequence));
  if (before < 0 || view < 0 || std::max(before, view) >= opened->num_views())
    exit_with(fmt::format("{}: there are {} views", sequence.string(), opened->num_views()));
  input.before = prepare_view(value_or_exit(opened->read_view(before)), input.config.prepare);
  input.view = prepare_view(value_or_exit(opened->read_view(view)), input.config.prepare);
  if (!library_file.empty()) input.library = value_or_exit(load_library(library_file));
  if (opened->has_ground_truth()) input.objects = value_or_exit(opened->read_ground_truth(view));
  std::erase_if(input.objects, [&](const GroundTruthObject& o) { return input.library.find(o.object) < 0; });
  add_features(input);
  return input;
}

}  // namespace resight::bench
