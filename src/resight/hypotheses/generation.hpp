// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "resight/core/options.hpp"
#include "resight/features/descriptor_index.hpp"
#include "resight/hypotheses/correspondence_grouping.hpp"
#include "resight/hypotheses/hypothesis.hpp"
#include "resight/models/object_model.hpp"

namespace resight {

struct MatchFeaturesOptions {
  int sift_neighbors = 3;
  int shot_neighbors = 1;
  DescriptorIndexOptions sift_index{};
  DescriptorIndexOptions shot_index{};
  void check() const { check_options("MatchFeaturesOptions", *this); }
};

inline void declare(OptionVisitor& v, MatchFeaturesOptions& o) {
  v.field("sift_neighbors", o.sift_neighbors, between(1, 1000),
          "Nearest SIFT descriptors of the models matched per keypoint.", "V4R");
  v.field("shot_neighbors", o.shot_neighbors, between(1, 1000),
          "Nearest SHOT descriptors of the models matched per keypoint.", "V4R");
  v.group("sift_index", o.sift_index);
  v.group("shot_index", o.shot_index);
}

/// Index over the descriptors of all objects. The library must outlive it and stay unchanged.
class ModelFeatureIndex {
 public:
  ModelFeatureIndex(const ModelLibrary& library, const MatchFeaturesOptions& options = {});
  ~ModelFeatureIndex();
  ModelFeatureIndex(ModelFeatureIndex&&) noexcept;
  ModelFeatureIndex& operator=(ModelFeatureIndex&&) noexcept;
  /// Correspondences per object (library order), SIFT and SHOT pooled. The scene side is in the frame of the given
  /// features. Order: scene features as given, nearest match first. Scene features without a match or with a NaN point
  /// are skipped. The k nearest descriptors are searched among all objects together (paper, V4R), so a scene feature
  /// matches few objects. Throws std::invalid_argument if feature types or descriptor dimensions do not match.
  [[nodiscard]] std::vector<std::vector<Correspondence>> match(const FeatureSet& sift, const FeatureSet& shot) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Converts a group of correspondences of one object (scene side in the camera frame) to a hypothesis in the WORLD
/// frame. Its id remains 0.
[[nodiscard]] Hypothesis make_hypothesis(const CorrespondenceGroup& group,
                                         std::span<const Correspondence> correspondences,
                                         const Rigid3& world_from_camera, int object, int view);

struct GenerateHypothesesOptions {
  GroupCorrespondencesOptions grouping{};
  int num_threads = 1;  ///< Same bits for any value >= 1.
  void check() const { check_options("GenerateHypothesesOptions", *this); }
};

inline void declare(OptionVisitor& v, GenerateHypothesesOptions& o) {
  v.group("grouping", o.grouping);
  v.num_threads(o.num_threads);
}

/// Generates the hypotheses of one view from its correspondences per object (scene side in the camera frame).
/// Hypotheses and their correspondences are in the WORLD frame. Ids start at `first_id`: by object, then largest group
/// first. Throws std::invalid_argument if `world_from_camera` is not a rigid motion.
[[nodiscard]] std::vector<Hypothesis> generate_hypotheses(
    std::span<const std::vector<Correspondence>> correspondences_per_object, const Rigid3& world_from_camera, int view,
    std::uint64_t first_id, const GenerateHypothesesOptions& options = {});

}  // namespace resight
