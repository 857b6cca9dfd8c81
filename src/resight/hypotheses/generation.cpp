// SPDX-License-Identifier: Apache-2.0
#include "resight/hypotheses/generation.hpp"

#include <utility>

#include "resight/core/check.hpp"
#include "resight/core/parallel.hpp"

namespace resight {
namespace {

// Origin of a row of a descriptor index.
struct FeatureOwner {
  int object = -1;
  int feature = -1;
};

// All descriptors of one type.
struct TypeIndex {
  TypeIndex(const ModelLibrary& library, CodedFeatures ObjectModel::*features, int neighbors,
            const DescriptorIndexOptions& options);
  void match(const ModelLibrary& library, const FeatureSet& scene,
             std::vector<std::vector<Correspondence>>& correspondences) const;

  CodedFeatures ObjectModel::*features;
  int neighbors;
  int dimension = 0;  // 0: no object has features of this type.
  std::vector<FeatureOwner> owners;
  std::unique_ptr<DescriptorIndex> index;
};

TypeIndex::TypeIndex(const ModelLibrary& library, CodedFeatures ObjectModel::*member, int num_neighbors,
                     const DescriptorIndexOptions& options)
    : features(member), neighbors(num_neighbors) {
  std::vector<const std::uint8_t*> codes;
  for (std::size_t o = 0; o < library.objects.size(); ++o) {
    const CodedFeatures& set = library.objects[o].*features;
    if (set.size() == 0) continue;
    if (dimension == 0) dimension = set.dimension;
    require(set.dimension == dimension, "ModelFeatureIndex: descriptors of the objects differ in dimension");
    require(
        set.normals.size() == set.size() && set.codes.size() == set.size() * static_cast<std::size_t>(set.dimension),
        "ModelFeatureIndex: points, normals and descriptors of an object differ in number");
    for (std::size_t f = 0; f < set.size(); ++f) {
      owners.push_back({static_cast<int>(o), static_cast<int>(f)});
      codes.push_back(set.code(f).data());
    }
  }
  if (dimension > 0) index = std::make_unique<DescriptorIndex>(DescriptorRows(std::move(codes), dimension), options);
}

void TypeIndex::match(const ModelLibrary& library, const FeatureSet& scene,
                      std::vector<std::vector<Correspondence>>& correspondences) const {
  if (!index || scene.size() == 0) return;
  require(scene.dimension == dimension,
          "ModelFeatureIndex::match: descriptors of the scene and of the models differ in dimension");
  require(scene.normals.size() == scene.size(), "ModelFeatureIndex::match: points and normals differ in number");
  const std::vector<DescriptorMatch> matches = index->search(scene.descriptors, neighbors);
  const auto k = static_cast<std::size_t>(neighbors);
  for (std::size_t i = 0; i < matches.size(); ++i) {
    const DescriptorMatch& match = matches[i];
    const std::size_t scene_feature = i / k;
    if (match.index < 0 || !scene.points[scene_feature].allFinite()) continue;
    const FeatureOwner owner = owners[static_cast<std::size_t>(match.index)];
    const CodedFeatures& model = library.objects[static_cast<std::size_t>(owner.object)].*features;
    const auto model_feature = static_cast<std::size_t>(owner.feature);
    correspondences[static_cast<std::size_t>(owner.object)].push_back(
        {.model_point = model.points[model_feature],
         .model_normal = model.normals[model_feature],
         .scene_point = scene.points[scene_feature],
         .scene_normal = scene.normals[scene_feature],
         .distance_sq = match.distance_sq,
         .type = scene.type,
         .model_feature = owner.feature,
         .scene_feature = static_cast<int>(scene_feature)});
  }
}

}  // namespace

Hypothesis make_hypothesis(const CorrespondenceGroup& group, std::span<const Correspondence> correspondences,
                           const Rigid3& world_from_camera, int object, int view) {
  Hypothesis hypothesis;
  hypothesis.object = object;
  hypothesis.world_from_object = world_from_camera * group.scene_from_object;
  hypothesis.origin_view = view;
  hypothesis.origin_views = {view};
  hypothesis.correspondences.reserve(group.members.size());
  const Rigid3f world_from_camera_f(world_from_camera);
  for (const int i : group.members) {
    Correspondence c = correspondences[static_cast<std::size_t>(i)];
    c.scene_point = world_from_camera_f * c.scene_point;
    c.scene_normal = world_from_camera_f.rotation * c.scene_normal;
    hypothesis.correspondences.push_back(c);
  }
  return hypothesis;
}

struct ModelFeatureIndex::Impl {
  const ModelLibrary* library;
  TypeIndex sift;
  TypeIndex shot;
};

ModelFeatureIndex::ModelFeatureIndex(const ModelLibrary& library, const MatchFeaturesOptions& options) {
  options.check();
  impl_ = std::make_unique<Impl>(
      Impl{&library, TypeIndex(library, &ObjectModel::sift, options.sift_neighbors, options.sift_index),
           TypeIndex(library, &ObjectModel::shot, options.shot_neighbors, options.shot_index)});
}

ModelFeatureIndex::~ModelFeatureIndex() = default;
ModelFeatureIndex::ModelFeatureIndex(ModelFeatureIndex&&) noexcept = default;
ModelFeatureIndex& ModelFeatureIndex::operator=(ModelFeatureIndex&&) noexcept = default;

std::vector<std::vector<Correspondence>> ModelFeatureIndex::match(const FeatureSet& sift,
                                                                  const FeatureSet& shot) const {
  require(sift.size() == 0 || sift.type == FeatureType::kSift, "ModelFeatureIndex::match: sift must be of type kSift");
  require(shot.size() == 0 || shot.type == FeatureType::kShot, "ModelFeatureIndex::match: shot must be of type kShot");
  std::vector<std::vector<Correspondence>> correspondences(impl_->library->objects.size());
  impl_->sift.match(*impl_->library, sift, correspondences);
  impl_->shot.match(*impl_->library, shot, correspondences);
  return correspondences;
}

std::vector<Hypothesis> generate_hypotheses(std::span<const std::vector<Correspondence>> correspondences_per_object,
                                            const Rigid3& world_from_camera, int view, std::uint64_t first_id,
                                            const GenerateHypothesesOptions& options) {
  options.check();
  require(world_from_camera.is_rigid(), "generate_hypotheses: world_from_camera is not a rigid motion");
  std::vector<std::vector<Hypothesis>> per_object(correspondences_per_object.size());
  parallel_for(correspondences_per_object.size(), options.num_threads, [&](std::size_t o) {
    for (const CorrespondenceGroup& group : group_correspondences(correspondences_per_object[o], options.grouping))
      per_object[o].push_back(
          make_hypothesis(group, correspondences_per_object[o], world_from_camera, static_cast<int>(o), view));
  });
  std::vector<Hypothesis> hypotheses;
  for (std::vector<Hypothesis>& of_object : per_object)
    for (Hypothesis& hypothesis : of_object) {
      hypothesis.id = first_id + hypotheses.size();
      hypotheses.push_back(std::move(hypothesis));
    }
  return hypotheses;
}

}  // namespace resight
