// SPDX-License-Identifier: Apache-2.0
#include "demo_scene.hpp"

#include <algorithm>

#include "../quality/arguments.hpp"
#include "resight/features/shot.hpp"
#include "resight/features/sift.hpp"
#include "resight/recognition/stage_options.hpp"
#include "resight/recognition/view_hypothesis_generator.hpp"
#include "resight/simulation/presets.hpp"
#include "resight/simulation/simulation.hpp"
#include "resight/training/training.hpp"

namespace resight::bench {
namespace {

constexpr int kNumViews = 7;  // Six before the current one.

DemoScene make_demo() {
  DemoScene demo;
  demo.config = RecognizerConfig::from_preset("default");
  Simulation simulation = value_or_exit(Simulation::create(make_demo_scene(3), 3, {.num_threads = 2}));
  demo.objects = simulation.library();
  TrainOptions training;
  training.num_threads = 2;
  for (const ProceduralObject& object : demo.objects)
    demo.library.objects.push_back(value_or_exit(train_object(object.name, object.mesh, training)));
  for (int v = 0; v < std::min(kNumViews, simulation.num_views()); ++v)
    demo.views.push_back(prepare_view(simulation.render_view(v).frame, demo.config.prepare));

  demo.scene = std::make_unique<DynamicScene>(scene_options(demo.config));
  for (std::size_t v = 0; v + 1 < demo.views.size(); ++v) (void)demo.scene->add_view(demo.views[v]);
  const PreparedView& view = demo.views.back();
  demo.sift = extract_sift(view, demo.config.features.sift);
  demo.shot = extract_shot(view, demo.config.features.shot);
  return demo;
}

/// Adds members that refer to the library, after it has reached its final address.
void add_searches(DemoScene& demo) {
  demo.index = std::make_unique<ModelFeatureIndex>(demo.library, demo.config.features.match);
  demo.shapes = std::make_unique<ShapeSearch>(demo.library, demo.config.shape, match_criteria(demo.config.verify));
  demo.correspondences = demo.index->match(demo.sift, demo.shot);
  demo.hypotheses = generate_hypotheses(demo.correspondences, demo.views.back().frame.world_from_camera,
                                        static_cast<int>(demo.views.size()) - 1, 0, demo.config.hypotheses.generate);
}

}  // namespace

const DemoScene& demo_scene() {
  static DemoScene demo = make_demo();
  if (!demo.shapes) add_searches(demo);
  return demo;
}

}  // namespace resight::bench
