// SPDX-License-Identifier: Apache-2.0
#include "resight/recognition/view_hypothesis_generator.hpp"

#include <algorithm>
#include <optional>
#include <utility>

namespace resight {
namespace {

const ModelLibrary kNoModels;

}  // namespace

MatchCriteria match_criteria(const VerifyOptions& verify) {
  return {.appearance = verify.appearance,
          .min_weight = verify.support.min_weight,
          .min_pattern_similarity = verify.acceptance.min_pattern_similarity.value_or(-1),
          .symmetry_step_rad = verify.refine.symmetry_step_rad};
}

ViewHypothesisGenerator::ViewHypothesisGenerator(const ModelLibrary& library, const RecognizerConfig& config)
    : config_(config),
      index_(library, config.features.match),
      shapes_(config.shape.enabled ? library : kNoModels, config.shape, match_criteria(config.verify)),
      largest_diameter_m_(library.largest_diameter_m()) {}

ViewHypotheses ViewHypothesisGenerator::generate(const PreparedView& view, int number, std::uint64_t first_id,
                                                 const Deadline& deadline, const Image<std::uint8_t>& explained) const {
  ViewHypotheses made;
  made.world_from_camera = view.frame.world_from_camera;
  if (deadline.has_passed()) {
    made.left_out = {"search"};
    return made;
  }
  std::optional<SearchView> searched;
  if (config_.shape.enabled) {
    const ScopedTimer timer(made.times, "planes");
    searched.emplace(view, config_.shape, largest_diameter_m_, explained);
  }
  extract_features(view, searched ? &*searched : nullptr, explained, made);
  {
    const ScopedTimer timer(made.times, "match");
    made.correspondences = index_.match(made.sift, made.shot);
  }
  {
    const ScopedTimer timer(made.times, "hypotheses");
    made.hypotheses = generate_hypotheses(made.correspondences, view.frame.world_from_camera, number, first_id,
                                          config_.hypotheses.generate);
  }
  if (searched) add_from_shape(view, *searched, number, deadline, made);
  for (std::size_t h = 0; h < made.hypotheses.size(); ++h) made.hypotheses[h].id = first_id + h;
  return made;
}

void ViewHypothesisGenerator::extract_features(const PreparedView& view, const SearchView* searched,
                                               const Image<std::uint8_t>& explained, ViewHypotheses& made) const {
  Image<std::uint8_t> where;
  if (searched != nullptr && config_.shape.skip_planes) where = searched->scorer.off_larger_planes(largest_diameter_m_);
  if (explained.size() > 0) {
    if (where.size() == 0) where = Image<std::uint8_t>(explained.width(), explained.height(), 255);
    for (std::size_t i = 0; i < explained.size(); ++i)
      if (explained[i] != 0) where[i] = 0;
  }
  const Image<std::uint8_t>* mask = where.size() > 0 ? &where : nullptr;
  {
    const ScopedTimer timer(made.times, "sift");
    made.sift = extract_sift(view, config_.features.sift, mask);
  }
  const ScopedTimer timer(made.times, "shot");
  made.shot = extract_shot(view, config_.features.shot, mask);
}

void ViewHypothesisGenerator::add_from_shape(const PreparedView& view, const SearchView& searched, int number,
                                             const Deadline& deadline, ViewHypotheses& made) const {
  const ScopedTimer timer(made.times, "shape search");
  discard_spurious(searched, made.hypotheses);
  if (deadline.has_passed()) {
    made.left_out = {"shape search"};
    return;
  }
  for (const ShapeCandidate& candidate : shapes_.search(searched, made.correspondences, made.hypotheses))
    made.hypotheses.push_back(make_hypothesis({candidate.matches, candidate.camera_from_object},
                                              made.correspondences[static_cast<std::size_t>(candidate.object)],
                                              view.frame.world_from_camera, candidate.object, number));
}

// Most groups of correspondences are spurious, which their own view shows.
void ViewHypothesisGenerator::discard_spurious(const SearchView& view, std::vector<Hypothesis>& hypotheses) const {
  if (config_.shape.min_feature_share <= 0) return;
  const std::vector<PoseFit> fits = shapes_.score_hypotheses(view, hypotheses);
  std::vector<Hypothesis> kept;
  for (std::size_t h = 0; h < hypotheses.size(); ++h)
    if (fits[h].explained_share >= config_.shape.min_feature_share) kept.push_back(std::move(hypotheses[h]));
  hypotheses = std::move(kept);
}

}  // namespace resight
