// SPDX-License-Identifier: Apache-2.0
// The same hypotheses before one view.
#include "resight/verification/verification.hpp"

#include <fmt/format.h>

#include "contest.hpp"
#include "found_objects.hpp"
#include "plain_points.hpp"
#include "resight/verification/scene_preparation.hpp"
#include "stages.hpp"

namespace resight::bench {
namespace {

using Posed = std::vector<PosedObject>;

struct VerificationContest {
  const StageInput& input;
  PointCloud scene_in_world;
  Rigid3 camera_from_world;
  std::vector<PreparedModel> models;  // Thinned as ours thins them.
  std::vector<Eigen::Vector3f> pixels;
};

// A recogniser has the view as a cloud of the world before it verifies anything.
VerificationContest make_contest(const StageInput& input) {
  VerificationContest contest{
      .input = input, .scene_in_world = {}, .camera_from_world = {}, .models = {}, .pixels = {}};
  const Rigid3& world_from_camera = input.view.frame.world_from_camera;
  contest.scene_in_world =
      transform(world_from_camera, to_point_cloud(input.view.cloud, &input.view.frame.color, true));
  contest.camera_from_world = world_from_camera.inverse();
  for (const ObjectModel& model : input.library.objects)
    contest.models.push_back(prepare_model(model, input.config.verify));
  contest.pixels = points_of_pixels(input.view.cloud);
  return contest;
}

double verify_ours(const VerificationContest& contest, VerifyResult& result) {
  const std::vector<VerificationView> views{{&contest.input.view}};
  return cpu_time_s([&] {
    result = verify_hypotheses(contest.input.hypotheses, contest.input.library, contest.scene_in_world, views, {},
                               contest.input.config.verify);
  });
}

Posed accepted_of(const VerificationContest& contest, const VerifyResult& result) {
  Posed accepted;
  for (std::size_t h = 0; h < result.evidence.size(); ++h)
    if (result.evidence[h].accepted)
      accepted.push_back(
          {contest.input.hypotheses[h].object, contest.camera_from_world * result.evidence[h].world_from_object});
  return accepted;
}

double verify_peer(const VerificationContest& contest, const Posed& hypotheses, Posed& accepted) {
  std::vector<std::vector<float>> models;
  for (const PosedObject& h : hypotheses) {
    const Rigid3f camera_from_object(h.camera_from_object);
    std::vector<Eigen::Vector3f> points;
    for (const Eigen::Vector3f& p : contest.models[static_cast<std::size_t>(h.object)].points)
      points.push_back(camera_from_object * p);
    const auto plain = to_plain(points);
    models.emplace_back(plain.begin(), plain.end());
  }
  const VerifyOptions& ours = contest.input.config.verify;
  const pcl_peers::VerifyOptions options{.resolution_m = static_cast<float>(ours.resolution_m),
                                         .inlier_distance_m = static_cast<float>(ours.inlier_distance_m),
                                         .clutter_radius_m = static_cast<float>(ours.clutter_radius_m)};
  const auto mask = pcl_peers::verify_hypotheses(
      {to_plain(contest.pixels), contest.input.view.cloud.width(), contest.input.view.cloud.height()}, models, options);
  accepted.clear();
  for (std::size_t h = 0; h < hypotheses.size(); ++h)
    if (mask.value[h] != 0) accepted.push_back(hypotheses[h]);
  return mask.cpu_s;
}

// The hypotheses as they are, or at the poses that ours has moved them to.
Posed posed_hypotheses(const VerificationContest& contest, const VerifyResult* refined) {
  Posed posed;
  for (std::size_t h = 0; h < contest.input.hypotheses.size(); ++h) {
    const Hypothesis& hypothesis = contest.input.hypotheses[h];
    posed.push_back({hypothesis.object, contest.camera_from_world * (refined ? refined->evidence[h].world_from_object
                                                                             : hypothesis.world_from_object)});
  }
  return posed;
}

}  // namespace

void compare_verification(const StageInput& input) {
  const VerificationContest contest = make_contest(input);
  VerifyResult ours;
  Posed peer, peer_refined;
  compare(fmt::format("verification of {} hypotheses", input.hypotheses.size()),
          {{"resight, refinement of poses included", [&] { return verify_ours(contest, ours); },
            [&] { return rate_detections(input, accepted_of(contest, ours)); }},
           {"PCL GlobalHypothesesVerification",
            [&] { return verify_peer(contest, posed_hypotheses(contest, nullptr), peer); },
            [&] { return rate_detections(input, peer); }},
           {"PCL GlobalHypothesesVerification, of our refined poses",
            [&] { return verify_peer(contest, posed_hypotheses(contest, &ours), peer_refined); },
            [&] { return rate_detections(input, peer_refined); }}});
}

}  // namespace resight::bench
