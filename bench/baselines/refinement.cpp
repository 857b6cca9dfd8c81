// SPDX-License-Identifier: Apache-2.0
// Refines perturbed true poses by the surface alone, with the same visible model points and the same scene.
#include <fmt/format.h>

#include <algorithm>
#include <numbers>

#include "contest.hpp"
#include "plain_points.hpp"
#include "resight/core/random.hpp"
#include "resight/geometry/kd_tree.hpp"
#include "resight/verification/pose_refinement.hpp"
#include "resight/verification/scene_preparation.hpp"
#include "resight/verification/visibility.hpp"
#include "stages.hpp"

namespace resight::bench {
namespace {

constexpr int kNumStarts = 10;  // Per object.
constexpr double kShift_m = 0.01;
constexpr double kTurn_rad = 8 * std::numbers::pi / 180;
constexpr double kMinVisibleShare = 0.3;

struct Start {
  std::size_t object = 0;  // Index into the library.
  Rigid3 truth;            // world_from_object.
  Rigid3 start;
  std::vector<int> visible;  // Indices of the model points visible at the start pose.
};

struct RefinementContest {
  const StageInput& input;
  PreparedScene scene;
  std::vector<PreparedModel> models;
  std::vector<Start> starts;
  std::vector<pcl_peers::RefinementTask> tasks;
};

Eigen::Vector3d random_direction(Rng& rng) {
  return Eigen::Vector3d{rng.normal(), rng.normal(), rng.normal()}.normalized();
}

// Rotated about the centre of the object, then shifted.
Rigid3 perturb(const Rigid3& world_from_object, const Eigen::Vector3d& center, Rng& rng) {
  const Eigen::Vector3d center_in_world = world_from_object * center;
  const Rigid3 turn = Rigid3::from_axis_angle(random_direction(rng), kTurn_rad);
  const Rigid3 shift = Rigid3::from_translation(center_in_world + kShift_m * random_direction(rng));
  return shift * turn * Rigid3::from_translation(-center_in_world) * world_from_object;
}

std::vector<int> visible_points(const PreparedModel& model, const Rigid3& world_from_object,
                                const std::vector<DepthView>& views, const VerifyOptions& options) {
  const Rigid3f pose(world_from_object);
  std::vector<Eigen::Vector3f> points, normals;
  for (const Eigen::Vector3f& p : model.points) points.push_back(pose * p);
  for (const Eigen::Vector3f& n : model.normals) normals.push_back(pose.rotation * n);
  return find_visible_points(points, normals, views, std::vector<std::uint8_t>{1}, options.visibility,
                             options.resolution_m)
      .visible;
}

pcl_peers::RefinementTask task_of(const PreparedModel& model, const Start& start) {
  std::vector<Eigen::Vector3f> points, normals;
  for (const int i : start.visible) {
    points.push_back(model.points[static_cast<std::size_t>(i)]);
    normals.push_back(model.normals[static_cast<std::size_t>(i)]);
  }
  const auto xyz = to_plain(points);
  const auto directions = to_plain(normals);
  return {{xyz.begin(), xyz.end()}, {directions.begin(), directions.end()}, to_plain(start.start)};
}

void add_starts(RefinementContest& contest) {
  const VerifyOptions& options = contest.input.config.verify;
  const std::vector<VerificationView> view{{&contest.input.view}};
  const std::vector<DepthView> depth = prepare_depth_views(view, 0, 1);
  std::uint64_t stream = 0;
  for (const GroundTruthObject& object : contest.input.objects) {
    if (object.visible_share < kMinVisibleShare) continue;
    const auto number = static_cast<std::size_t>(contest.input.library.find(object.object));
    const PreparedModel& model = contest.models[number];
    Rng rng = Rng::stream(1, stream++);
    for (int s = 0; s < kNumStarts; ++s) {
      Start start{number, contest.input.view.frame.world_from_camera * object.camera_from_object, {}, {}};
      start.start = perturb(start.truth, model.center.cast<double>(), rng);
      start.visible = visible_points(model, start.start, depth, options);
      contest.tasks.push_back(task_of(model, start));
      contest.starts.push_back(std::move(start));
    }
  }
}

double refine_ours(const RefinementContest& contest, std::vector<Rigid3>& refined) {
  refined.clear();
  return cpu_time_s([&] {
    for (const Start& start : contest.starts)
      refined.push_back(refine_pose_on_scene(contest.models[start.object], start.start, start.visible, {},
                                             contest.scene, contest.input.config.verify.refine));
  });
}

double refine_peer(const RefinementContest& contest, pcl_peers::IcpKind kind, std::vector<Rigid3>& refined) {
  const RefinePoseOptions& options = contest.input.config.verify.refine;
  const auto result =
      pcl_peers::refine_poses({to_plain(contest.scene.points), to_plain(contest.scene.normals)}, contest.tasks, kind,
                              static_cast<float>(options.max_distance_m), *options.max_iterations);
  refined.clear();
  for (const pcl_peers::Pose& pose : result.value) refined.push_back(from_plain(pose));
  return result.cpu_s;
}

// Mean distance from the points of the moved model to the nearest points of the true model. Like ICP, it ignores
// displacements that leave the shape unchanged.
double surface_error_m(const PreparedModel& model, const KdTree& tree, const Rigid3& true_from_refined) {
  const Rigid3f moved(true_from_refined);
  double sum_m = 0;
  for (const Eigen::Vector3f& p : model.points) sum_m += std::sqrt(tree.nearest(moved * p).distance_sq);
  return sum_m / static_cast<double>(model.points.size());
}

std::string rate(const RefinementContest& contest, const std::vector<Rigid3>& refined) {
  std::vector<double> surface_mm, center_mm;
  for (std::size_t i = 0; i < refined.size(); ++i) {
    const Start& start = contest.starts[i];
    const PreparedModel& model = contest.models[start.object];
    const Eigen::Vector3d center = model.center.cast<double>();
    center_mm.push_back(1e3 * (refined[i] * center - start.truth * center).norm());
    // The whole surface, because the model downsampled to 5 mm would be 2 mm from itself.
    const KdTree tree(contest.input.library.objects[start.object].surface.points);
    surface_mm.push_back(1e3 * surface_error_m(model, tree, start.truth.inverse() * refined[i]));
  }
  std::sort(surface_mm.begin(), surface_mm.end());
  std::sort(center_mm.begin(), center_mm.end());
  const std::size_t middle = refined.size() / 2, ninth = refined.size() * 9 / 10;
  return fmt::format("centre off by {:.1f} / {:.1f} mm, surface by {:.1f} / {:.1f} mm", center_mm[middle],
                     center_mm[ninth], surface_mm[middle], surface_mm[ninth]);
}

}  // namespace

void compare_refinement(const StageInput& input) {
  RefinementContest contest{.input = input, .scene = {}, .models = {}, .starts = {}, .tasks = {}};
  contest.scene = prepare_scene(
      transform(input.view.frame.world_from_camera, to_point_cloud(input.view.cloud, &input.view.frame.color, true)),
      input.config.verify);
  for (const ObjectModel& model : input.library.objects)
    contest.models.push_back(prepare_model(model, input.config.verify));
  add_starts(contest);
  if (contest.starts.empty()) return;
  std::vector<Rigid3> ours, to_point, to_plane, untouched;
  for (const Start& start : contest.starts) untouched.push_back(start.start);
  compare(
      fmt::format("refinement of {} poses, {}", untouched.size(), rate(contest, untouched)),
      {{"resight", [&] { return refine_ours(contest, ours); }, [&] { return rate(contest, ours); }},
       {"PCL IterativeClosestPoint", [&] { return refine_peer(contest, pcl_peers::IcpKind::kPointToPoint, to_point); },
        [&] { return rate(contest, to_point); }},
       {"PCL IterativeClosestPointWithNormals",
        [&] { return refine_peer(contest, pcl_peers::IcpKind::kPointToPlane, to_plane); },
        [&] { return rate(contest, to_plane); }}});
}

}  // namespace resight::bench
