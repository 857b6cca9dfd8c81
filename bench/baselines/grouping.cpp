// SPDX-License-Identifier: Apache-2.0
// Hypotheses from the same correspondences, object by object.
#include <fmt/format.h>

#include "contest.hpp"
#include "found_objects.hpp"
#include "pcl/pcl_votes.hpp"
#include "plain_points.hpp"
#include "stages.hpp"

namespace resight::bench {
namespace {

using Posed = std::vector<PosedObject>;

double group_ours(const StageInput& input, Posed& found) {
  found.clear();
  return cpu_time_s([&] {
    for (std::size_t o = 0; o < input.correspondences.size(); ++o)
      for (const CorrespondenceGroup& group :
           group_correspondences(input.correspondences[o], input.config.hypotheses.generate.grouping))
        found.push_back({static_cast<int>(o), group.scene_from_object});
  });
}

/// Correspondences of one object as separate arrays.
struct Pairs {
  std::vector<Eigen::Vector3f> model, scene;
  std::vector<float> distances;
};

Pairs pairs_of(const std::vector<Correspondence>& correspondences) {
  Pairs pairs;
  for (const Correspondence& c : correspondences) {
    pairs.model.push_back(c.model_point);
    pairs.scene.push_back(c.scene_point);
    pairs.distances.push_back(c.distance_sq);
  }
  return pairs;
}

// `group`: result of a peer for the correspondences of one object.
template <typename Group>
double group_peer(const StageInput& input, Posed& found, Group&& group) {
  double cpu_s = 0;
  found.clear();
  for (std::size_t o = 0; o < input.correspondences.size(); ++o) {
    const auto poses = group(pairs_of(input.correspondences[o]), input.library.objects[o]);
    cpu_s += poses.cpu_s;
    for (const pcl_peers::Pose& pose : poses.value) found.push_back({static_cast<int>(o), from_plain(pose)});
  }
  return cpu_s;
}

}  // namespace

void compare_grouping(const StageInput& input) {
  std::size_t num_correspondences = 0;
  for (const auto& of_object : input.correspondences) num_correspondences += of_object.size();
  const GroupCorrespondencesOptions& options = input.config.hypotheses.generate.grouping;
  const auto consistency_m = static_cast<float>(options.max_distance_difference_m);
  const ShotOptions& shot = input.config.features.shot;
  const PointCloud surface = voxel_downsample(to_point_cloud(input.view.cloud, nullptr, true), *shot.support_voxel_m);
  const auto by_consistency = [&](const Pairs& pairs, const ObjectModel&) {
    return pcl_peers::group_correspondences(to_plain(pairs.model), to_plain(pairs.scene), pairs.distances,
                                            consistency_m, options.min_group_size);
  };
  const auto by_votes = [&](const Pairs& pairs, const ObjectModel& model) {
    const PointCloud downsampled = voxel_downsample(model.surface, *shot.support_voxel_m);
    return pcl_peers::group_by_votes(to_plain(pairs.model), to_plain(pairs.scene), pairs.distances,
                                     to_plain(downsampled.points), to_plain(surface.points),
                                     static_cast<float>(shot.support_radius_m), consistency_m, options.min_group_size);
  };
  Posed ours, consistent, voted;
  compare(fmt::format("grouping of {} correspondences", num_correspondences),
          {{"resight", [&] { return group_ours(input, ours); }, [&] { return rate_proposals(input, ours); }},
           {"PCL GeometricConsistencyGrouping", [&] { return group_peer(input, consistent, by_consistency); },
            [&] { return rate_proposals(input, consistent); }},
           {"PCL Hough3DGrouping", [&] { return group_peer(input, voted, by_votes); },
            [&] { return rate_proposals(input, voted); }}});
}

}  // namespace resight::bench
