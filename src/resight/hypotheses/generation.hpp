// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "resight/features/descriptor_index.hpp"
#include "resight/hypotheses/correspondence_grouping.hpp"
#include "resight/models/object_model.hpp"

namespace resight {

struct MatchFeaturesOptions {
  int sift_neighbors = 3;  ///< k of the kNN search (V4R P branch: 3).
  int shot_neighbors = 1;
  double max_sift_distance = 0;  ///< L2 between unit descriptors; 0 = no limit (paper).
  double max_shot_distance = 0;
  DescriptorIndexOptions sift_index{};
  DescriptorIndexOptions shot_index{};
  void check() const;
};

/// The descriptors of all objects, ready to be searched. The library must outlive it, unchanged.
class ModelFeatureIndex {
 public:
  ModelFeatureIndex(const ModelLibrary& library, const MatchFeaturesOptions& options = {});
  ~ModelFeatureIndex();
  ModelFeatureIndex(ModelFeatureIndex&&) noexcept;
  ModelFeatureIndex& operator=(ModelFeatureIndex&&) noexcept;
  /// Correspondences of each object (library order), SIFT and SHOT pooled; scene side in the frame of the features
  /// given. In the order of the scene features, nearest match first; scene features without a match or with a NaN point
  /// are left out. The nearest k are searched among all objects together (paper, V4R), so a scene feature speaks for
  /// few of them.
  [[nodiscard]] std::vector<std::vector<Correspondence>> match(const FeatureSet& sift, const FeatureSet& shot) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// A group of correspondences of one object (scene side in the camera frame) as a hypothesis of a view, in the WORLD
/// frame; its id is left at 0.
[[nodiscard]] Hypothesis make_hypothesis(const CorrespondenceGroup& group,
                                         std::span<const Correspondence> correspondences,
                                         const Rigid3& world_from_camera, int object, int view);

struct GenerateHypothesesOptions {
  GroupCorrespondencesOptions grouping{};
  int num_threads = 1;  ///< Same bits for any value >= 1.
  void check() const;
};

/// Hypotheses of one view from its correspondences per object (scene side in the camera frame). Results and their
/// correspondences are in the WORLD frame; ids start at `first_id`, by object, then largest group first.
[[nodiscard]] std::vector<Hypothesis> generate_hypotheses(
    std::span<const std::vector<Correspondence>> correspondences_per_object, const Rigid3& world_from_camera, int view,
    std::uint64_t first_id, const GenerateHypothesesOptions& options = {});

}  // namespace resight
