// SPDX-License-Identifier: Apache-2.0
#pragma once
// A printed box on a table, a view of it, and what tests its poses.
#include "resight/shape_search/pose_scorer.hpp"
#include "resight/verification/testing/analytic_scene.hpp"

namespace resight::analytic {

struct BoxOnTable {
  Solid box{Shape::kBox, {0.1, 0.07, 0.12}, checks({200, 60, 50}, {50, 60, 200}, 0.03), on_table(0, 0, 0.06, 0.4)};
  PreparedView view = prepare_view(render({.solids = {box}}, circle_of_cameras(3)[0]).frame);
  ObjectModel model = make_model("box", box);
  SampledModel samples = make_sampled_model(model, 300);
  PoseScorer scorer{view, {}, 1};
  Rigid3 truth = view.frame.world_from_camera.inverse() * box.world_from_object;
};

}  // namespace resight::analytic
