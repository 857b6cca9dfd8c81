// SPDX-License-Identifier: Apache-2.0
#include "resight/evaluation/loss.hpp"

#include <algorithm>
#include <array>
#include <span>

#include "resight/core/check.hpp"
#include "resight/geometry/kd_tree.hpp"

namespace resight {
namespace {

// A hypothesis is "at the place" within this multiple of the allowed centre distance.
constexpr double kNearFactor = 2;

int count_keypoints(const FeatureSet& features, const KdTree& surface, const Rigid3& object_from_camera,
                    double max_distance_m) {
  const Rigid3f motion(object_from_camera);
  const float max_sq = static_cast<float>(max_distance_m * max_distance_m);
  int count = 0;
  for (const Eigen::Vector3f& p : features.points) {
    const PointNeighbor nearest = surface.nearest(motion * p);
    count += nearest.index >= 0 && nearest.distance_sq <= max_sq ? 1 : 0;
  }
  return count;
}

int count_right(std::span<const Correspondence> correspondences, const Rigid3& camera_from_object,
                double max_distance_m) {
  const Rigid3f motion(camera_from_object);
  int count = 0;
  for (const Correspondence& c : correspondences)
    count += (motion * c.model_point - c.scene_point).norm() <= max_distance_m ? 1 : 0;
  return count;
}

// The hypothesis of the object with the best pose: the larger of centre distance and rotation, relative to their
// limits.
struct Nearest {
  int index = -1;
  PoseDifference difference;
  bool is_right = false;
  bool is_near = false;
};

struct Candidate {
  int index;
  Rigid3 world_from_object;
};

std::vector<Candidate> candidates_of(std::span<const Hypothesis> hypotheses, int object) {
  std::vector<Candidate> candidates;
  for (std::size_t h = 0; h < hypotheses.size(); ++h)
    if (hypotheses[h].object == object) candidates.push_back({static_cast<int>(h), hypotheses[h].world_from_object});
  return candidates;
}

Nearest find_nearest(std::span<const Candidate> candidates, const Rigid3& world_from_object, const ObjectModel& model,
                     const MatchDetectionsOptions& options) {
  Nearest nearest;
  double best = 0;
  for (const Candidate& candidate : candidates) {
    const PoseDifference d = compare_poses(candidate.world_from_object, world_from_object, model);
    const double cost =
        std::max(d.center_distance_m / options.max_center_distance_m, d.rotation_rad / options.max_rotation_rad);
    nearest.is_near = nearest.is_near || d.center_distance_m <= kNearFactor * options.max_center_distance_m;
    if (nearest.index >= 0 && cost >= best) continue;
    best = cost;
    nearest.index = candidate.index;
    nearest.difference = d;
    nearest.is_right = is_within(d, options);
  }
  return nearest;
}

}  // namespace

const char* to_string(LossStage stage) {
  switch (stage) {
    case LossStage::kNoKeypoints:
      return "no keypoints";
    case LossStage::kNoMatches:
      return "no matches";
    case LossStage::kNoGroup:
      return "no group";
    case LossStage::kWrongPose:
      return "wrong pose";
    case LossStage::kClusteredOut:
      return "clustered out";
    case LossStage::kCalledAbsent:
      return "called absent";
    case LossStage::kRefinedAway:
      return "refined away";
    case LossStage::kRejected:
      return "rejected";
  }
  return "unknown";
}

Loss find_loss(const GroundTruthObject& truth, const Rigid3& world_from_camera, const RecognitionTrace& trace,
               const ModelLibrary& library, const FindLossOptions& options) {
  const int object = library.find(truth.object);
  require(object >= 0, "find_loss: object '" + truth.object + "' is not in the library");
  const ObjectModel& model = library.objects[static_cast<std::size_t>(object)];
  const Rigid3 world_from_object = world_from_camera * truth.camera_from_object;
  const auto nearest_of = [&](std::span<const Candidate> candidates) {
    return find_nearest(candidates, world_from_object, model, options.match);
  };
  Loss loss;
  const KdTree surface(model.surface.points);
  for (const FeatureSet* features : {&trace.sift, &trace.shot})
    loss.num_keypoints +=
        count_keypoints(*features, surface, truth.camera_from_object.inverse(), options.keypoint_distance_m);
  if (!trace.correspondences.empty()) {
    const auto& correspondences = trace.correspondences[static_cast<std::size_t>(object)];
    loss.num_correspondences = static_cast<int>(correspondences.size());
    loss.num_right = count_right(correspondences, truth.camera_from_object, options.keypoint_distance_m);
  }

  const auto lost_at = [&](LossStage stage, const Nearest& nearest) {
    loss.stage = stage;
    if (nearest.index >= 0) loss.best = nearest.difference;
    return loss;
  };
  const auto refined = [&](Candidate c) {
    c.world_from_object = trace.evidence[static_cast<std::size_t>(c.index)].world_from_object;
    return c;
  };
  const auto is_accepted = [&](const Candidate& c) {
    return trace.evidence[static_cast<std::size_t>(c.index)].accepted;
  };
  // What was accepted at a right pose belongs to another ground-truth object, because this one was missed.
  std::vector<Candidate> verified = candidates_of(trace.verified, object);
  std::erase_if(verified,
                [&](const Candidate& c) { return is_accepted(c) && nearest_of(std::array{refined(c)}).is_right; });
  std::vector<Candidate> rejected;
  for (const Candidate& c : verified)
    if (!is_accepted(c)) rejected.push_back(refined(c));
  const auto keep_evidence_of = [&](int index) {
    loss.verified = index;
    loss.evidence = trace.evidence[static_cast<std::size_t>(index)];
  };
  if (const Nearest judged = nearest_of(rejected); judged.is_right) {
    keep_evidence_of(judged.index);
    return lost_at(LossStage::kRejected, judged);
  }
  if (const Nearest start = nearest_of(verified); start.is_right) {
    keep_evidence_of(start.index);
    return lost_at(LossStage::kRefinedAway, nearest_of(std::array{refined({start.index, {}})}));
  }
  if (const Nearest clustered = nearest_of(candidates_of(trace.clustered, object)); clustered.is_right)
    return lost_at(LossStage::kCalledAbsent, clustered);
  const Nearest merged = nearest_of(candidates_of(trace.merged, object));
  if (merged.is_right) return lost_at(LossStage::kClusteredOut, merged);
  if (merged.is_near) return lost_at(LossStage::kWrongPose, merged);
  if (loss.num_right >= options.min_group_size) return lost_at(LossStage::kNoGroup, merged);
  return lost_at(loss.num_keypoints >= options.min_group_size ? LossStage::kNoMatches : LossStage::kNoKeypoints,
                 merged);
}

}  // namespace resight
