// SPDX-License-Identifier: Apache-2.0
// Verifies the same hypotheses in one view.
#include <fmt/format.h>

#include "contest.hpp"
#include "found_objects.hpp"
#include "plain_points.hpp"
#include "resight/verification/hypothesis_verifier.hpp"
#include "resight/verification/scene_preparation.hpp"
#include "stages.hpp"

namespace resight::bench {
namespace {

using Posed = std::vector<PosedObject>;

struct VerificationContest {
  const StageInput& input;
  PointCloud scene_in_world;
  Rigid3 camera_from_world;
  std::vector<PreparedModel> models;  // Downsampled as in our verification.
  std::vector<Eigen::Vector3f> pixels;
};

// Before verification, a recogniser already has the view as a cloud in the world frame.
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
  HypothesisVerifier verifier(contest.input.library, contest.input.config.verify);
  const auto verify = [&] { result = verifier.verify(contest.input.hypotheses, contest.scene_in_world, views, {}); };
  verify();  // Models are prepared once, as for the peer.
  return cpu_time_s(verify);
}

Posed accepted_of(const VerificationContest& contest, const VerifyResult& result) {
  Posed accepted;
  for (std::size_t h = 0; h < result.evidence.size(); ++h)
    if (result.evidence[h].accepted)
      accepted.push_back(
          {contest.input.hypotheses[h].object, contest.camera_from_world * result.evidence[h].world_from_object});
  return accepted;
}

// Per hypothesis, camera frame.
std::vector<std::vector<float>> posed_models(const VerificationContest& contest) {
  std::vector<std::vector<float>> models;
  for (const Hypothesis& h : contest.input.hypotheses) {
    const Rigid3f camera_from_object(contest.camera_from_world * h.world_from_object);
    std::vector<Eigen::Vector3f> points;
    for (const Eigen::Vector3f& p : contest.models[static_cast<std::size_t>(h.object)].points)
      points.push_back(camera_from_object * p);
    const auto plain = to_plain(points);
    models.emplace_back(plain.begin(), plain.end());
  }
  return models;
}

// The peer's annealing is random, so every run is kept.
double verify_peer(const VerificationContest& contest, const pcl_peers::VerifyOptions& options,
                   std::vector<Posed>& accepted) {
  const OrganizedCloud& cloud = contest.input.view.cloud;
  const auto mask = pcl_peers::verify_hypotheses({to_plain(contest.pixels), cloud.width(), cloud.height()},
                                                 posed_models(contest), options);
  accepted.emplace_back();
  for (std::size_t h = 0; h < mask.value.size(); ++h)
    if (mask.value[h] != 0)
      accepted.back().push_back({contest.input.hypotheses[h].object,
                                 contest.camera_from_world * contest.input.hypotheses[h].world_from_object});
  return mask.cpu_s;
}

// The best of 24 parameter sets on the demo scene: inliers within 5, 10 or 15 mm, normals of 2 or 5 cm, weights 1 or 3
// of outliers, 1 or 5 of clutter.
pcl_peers::VerifyOptions peer_options(const StageInput& input) {
  return {.resolution_m = static_cast<float>(input.config.verify.resolution_m),
          .inlier_distance_m = 0.015F,
          .clutter_radius_m = static_cast<float>(input.config.verify.clutter.radius_m),
          .clutter_regularizer = 5,
          .regularizer = 3,
          .normal_radius_m = 0.05F};
}

// Values of PCL's tutorial.
pcl_peers::VerifyOptions tutorial_options() {
  return {.inlier_distance_m = 0.005F, .clutter_regularizer = 5, .regularizer = 3, .normal_radius_m = 0.05F};
}

std::string rate_runs(const StageInput& input, const std::vector<Posed>& accepted) {
  std::string rates = "run by run:";
  for (const Posed& of_run : accepted) rates += fmt::format(" {};", rate_detections(input, of_run));
  rates.pop_back();
  return rates;
}

}  // namespace

void compare_verification(const StageInput& input) {
  const VerificationContest contest = make_contest(input);
  VerifyResult ours;
  std::vector<Posed> peer, of_tutorial;
  compare(fmt::format("verification of {} hypotheses", input.hypotheses.size()),
          {{"resight, refinement of poses included", [&] { return verify_ours(contest, ours); },
            [&] { return rate_detections(input, accepted_of(contest, ours)); }},
           {"PCL GlobalHypothesesVerification, inliers within 15 mm",
            [&] { return verify_peer(contest, peer_options(input), peer); }, [&] { return rate_runs(input, peer); }},
           {"PCL GlobalHypothesesVerification, 5 mm as in its tutorial",
            [&] { return verify_peer(contest, tutorial_options(), of_tutorial); },
            [&] { return rate_runs(input, of_tutorial); }}});
}

}  // namespace resight::bench
