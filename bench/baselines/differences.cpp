// SPDX-License-Identifier: Apache-2.0
// Points of the previous view that are missing in this one, and vice versa.
#include <fmt/format.h>

#include "contest.hpp"
#include "plain_points.hpp"
#include "resight/changes/change_detector.hpp"
#include "resight/changes/difference.hpp"
#include "resight/changes/view_difference.hpp"
#include "resight/evidence/surface_evidence.hpp"
#include "resight/geometry/kd_tree.hpp"
#include "stages.hpp"

namespace resight::bench {
namespace {

using Points = std::vector<Eigen::Vector3f>;

constexpr float kNear_m = 0.01F;  // A changed point with a reported one this near is found.
// A point is removed if a view measures a depth this far behind it.
constexpr float kSeenThrough_m = 0.04F;

/// Points of one view, world frame, and which of them changed.
struct Side {
  Points points;
  std::vector<int> pixels;
  std::vector<std::uint8_t> is_changed;  // Empty without ground truth.
  Points expected;                       // Changed, and seen through by the other view.
};

struct DifferenceContest {
  const StageInput& input;
  Side before, view;
};

bool is_seen_through(const Eigen::Vector3f& p_in_world, const PreparedView& by) {
  const Eigen::Vector3f p = (by.frame.world_from_camera.inverse() * p_in_world.cast<double>().eval()).cast<float>();
  return nearest_depth(p, {by.frame.camera, by.cloud.z}, 0) > p.z() + kSeenThrough_m;  // False for NaN.
}

Side make_side(const PreparedView& own, const ViewTruth& truth, const PreparedView& other) {
  Side side;
  const PointCloud cloud = to_point_cloud(own.cloud, nullptr, false, &side.pixels);
  side.points = transform(own.frame.world_from_camera, cloud).points;
  if (truth.is_changed.empty()) return side;
  for (std::size_t i = 0; i < side.points.size(); ++i) {
    side.is_changed.push_back(truth.is_changed[static_cast<std::size_t>(side.pixels[i])]);
    if (side.is_changed.back() != 0 && is_seen_through(side.points[i], other)) side.expected.push_back(side.points[i]);
  }
  return side;
}

std::string rate(const Side& side, const Points& reported) {
  if (side.is_changed.empty()) return fmt::format("{} points", reported.size());
  const KdTree own(side.points);
  const KdTree found(reported);
  std::size_t num_right = 0, num_found = 0;
  for (const Eigen::Vector3f& p : reported)
    num_right += side.is_changed[static_cast<std::size_t>(own.nearest(p).index)] != 0 ? 1 : 0;
  for (const Eigen::Vector3f& p : side.expected) {
    const PointNeighbor nearest = found.nearest(p);
    num_found += nearest.index >= 0 && nearest.distance_sq < kNear_m * kNear_m ? 1 : 0;
  }
  return fmt::format(
      "{} points, precision {:.3f}, recall {:.3f}", reported.size(),
      static_cast<double>(num_right) / static_cast<double>(std::max<std::size_t>(1, reported.size())),
      static_cast<double>(num_found) / static_cast<double>(std::max<std::size_t>(1, side.expected.size())));
}

Points select_points(const Points& points, const std::vector<int>& indices) {
  Points selected;
  for (const int i : indices) selected.push_back(points[static_cast<std::size_t>(i)]);
  return selected;
}

// Eq. (2), through the pixels of the view.
double subtract_by_pixels(const DifferenceContest& contest, Points& gone) {
  const PreparedView& view = contest.input.view;
  const Rigid3f camera_from_world(view.frame.world_from_camera.inverse());
  Points in_camera;
  for (const Eigen::Vector3f& p : contest.before.points) in_camera.push_back(camera_from_world * p);
  std::vector<std::uint8_t> is_explained;
  const double cpu_s = cpu_time_s([&] {
    is_explained = find_explained_points(in_camera, view.cloud, view.frame.camera, PointTestOptions{}.tolerance_m);
  });
  gone.clear();
  for (std::size_t i = 0; i < in_camera.size(); ++i)
    if (is_explained[i] == 0) gone.push_back(contest.before.points[i]);
  return cpu_s;
}

double subtract_by_grid(const DifferenceContest& contest, Points& gone) {
  std::vector<int> left;
  const double cpu_s = cpu_time_s(
      [&] { left = subtract_clouds(contest.before.points, contest.view.points, PointTestOptions{}.tolerance_m); });
  gone = select_points(contest.before.points, left);
  return cpu_s;
}

using PeerDifference = pcl_peers::Timed<std::vector<int>> (*)(pcl_peers::Points, pcl_peers::Points, float);

double subtract_by_peer(const DifferenceContest& contest, const Side& of, const Side& from, PeerDifference peer,
                        Points& left) {
  const auto result =
      peer(to_plain(of.points), to_plain(from.points), static_cast<float>(PointTestOptions{}.tolerance_m));
  left = select_points(of.points, result.value);
  return result.cpu_s;
}

void compare_one_way(const DifferenceContest& contest) {
  Points by_pixels, by_grid, by_tree, by_octree;
  compare("difference of two views, 2 cm",
          {{"resight, by pixels", [&] { return subtract_by_pixels(contest, by_pixels); },
            [&] { return "removed: " + rate(contest.before, by_pixels); }},
           {"resight, any two clouds", [&] { return subtract_by_grid(contest, by_grid); },
            [&] { return "removed: " + rate(contest.before, by_grid); }},
           {"PCL getPointCloudDifference",
            [&] {
              return subtract_by_peer(contest, contest.before, contest.view, pcl_peers::point_cloud_difference,
                                      by_tree);
            },
            [&] { return "removed: " + rate(contest.before, by_tree); }},
           {"PCL OctreePointCloudChangeDetector",
            [&] {
              return subtract_by_peer(contest, contest.before, contest.view, pcl_peers::octree_difference, by_octree);
            },
            [&] { return "removed: " + rate(contest.before, by_octree); }}});
}

double detect_ours(const DifferenceContest& contest, ChangeResult& changes) {
  PointCloud before;
  before.points = contest.before.points;
  const std::vector<const PreparedView*> earlier{&contest.input.before};
  return cpu_time_s(
      [&] { changes = detect_changes(before, contest.input.view, contest.input.config.changes.detection, earlier); });
}

std::string rate_both(const DifferenceContest& contest, const Points& removed, const Points& novel) {
  return "removed: " + rate(contest.before, removed) + "; novel: " + rate(contest.view, novel);
}

void compare_changes(const DifferenceContest& contest) {
  ChangeResult ours;
  Points removed, novel;
  const auto both_ways = [&] {
    return subtract_by_peer(contest, contest.before, contest.view, pcl_peers::point_cloud_difference, removed) +
           subtract_by_peer(contest, contest.view, contest.before, pcl_peers::point_cloud_difference, novel);
  };
  compare("changes between two views",
          {{"resight, detect_changes", [&] { return detect_ours(contest, ours); },
            [&] { return rate_both(contest, ours.removed_in_world.points, ours.novel_in_world.points); }},
           {"PCL getPointCloudDifference, both ways", both_ways, [&] { return rate_both(contest, removed, novel); }}});
}

}  // namespace

void compare_differences(const StageInput& input) {
  const DifferenceContest contest{.input = input,
                                  .before = make_side(input.before, input.truth_before, input.view),
                                  .view = make_side(input.view, input.truth, input.before)};
  compare_one_way(contest);
  compare_changes(contest);
}

}  // namespace resight::bench
