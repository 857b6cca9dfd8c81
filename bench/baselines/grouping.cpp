// SPDX-License-Identifier: Apache-2.0
// Hypotheses from the same correspondences, object by object.
#include <fmt/format.h>

#include "contest.hpp"
#include "found_objects.hpp"
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
           group_correspondences(input.correspondences[o], input.config.generate.grouping))
        found.push_back({static_cast<int>(o), group.scene_from_object});
  });
}

double group_peer(const StageInput& input, Posed& found) {
  const GroupCorrespondencesOptions& options = input.config.generate.grouping;
  double cpu_s = 0;
  found.clear();
  for (std::size_t o = 0; o < input.correspondences.size(); ++o) {
    std::vector<Eigen::Vector3f> model, scene;
    std::vector<float> distances;
    for (const Correspondence& c : input.correspondences[o]) {
      model.push_back(c.model_point);
      scene.push_back(c.scene_point);
      distances.push_back(c.distance_sq);
    }
    const auto poses =
        pcl_peers::group_correspondences(to_plain(model), to_plain(scene), distances,
                                         static_cast<float>(options.max_distance_difference_m), options.min_group_size);
    cpu_s += poses.cpu_s;
    for (const pcl_peers::Pose& pose : poses.value) found.push_back({static_cast<int>(o), from_plain(pose)});
  }
  return cpu_s;
}

}  // namespace

void compare_grouping(const StageInput& input) {
  std::size_t num_correspondences = 0;
  for (const auto& of_object : input.correspondences) num_correspondences += of_object.size();
  Posed ours, peer;
  compare(fmt::format("grouping of {} correspondences", num_correspondences),
          {{"resight", [&] { return group_ours(input, ours); }, [&] { return rate_proposals(input, ours); }},
           {"PCL GeometricConsistencyGrouping", [&] { return group_peer(input, peer); },
            [&] { return rate_proposals(input, peer); }}});
}

}  // namespace resight::bench
