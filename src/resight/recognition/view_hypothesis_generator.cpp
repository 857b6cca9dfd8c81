// SPDX-License-Identifier: Apache-2.0
#include "resight/recognition/view_hypothesis_generator.hpp"

#include <algorithm>
#include <optional>
#include <utility>

namespace resight {
namespace {

const ModelLibrary kNoModels;

// Non-zero where keypoints are sought. Empty masks hold for the whole image.
Image<std::uint8_t> keypoint_mask(const Image<std::uint8_t>& explained) {
  Image<std::uint8_t> mask(explained.width(), explained.height());
  for (std::size_t i = 0; i < mask.size(); ++i) mask[i] = explained[i] != 0 ? 0 : 255;
  return mask;
}

Image<std::uint8_t> intersect(Image<std::uint8_t> a, const Image<std::uint8_t>& b) {
  for (std::size_t i = 0; i < b.size(); ++i)
    if (b[i] == 0) a[i] = 0;
  return a;
}

const Image<std::uint8_t>* mask_or_null(const Image<std::uint8_t>& mask) { return mask.size() > 0 ? &mask : nullptr; }

}  // namespace

MatchCriteria match_criteria(const VerifyOptions& verify) {
  const auto* continuation = std::get_if<ContinuationClutter>(&verify.clutter.rule);
  return {.appearance = verify.appearance,
          .min_weight = verify.support.min_weight,
          .min_pattern_similarity = verify.acceptance.min_pattern_similarity.value_or(-1),
          .texture_contrast = continuation != nullptr ? continuation->texture_contrast : std::nullopt,
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
  const Image<std::uint8_t> unexplained = keypoint_mask(explained);
  {
    const ScopedTimer timer(made.times, "sift");
    made.sift = extract_sift(view, config_.features.sift, mask_or_null(unexplained));
  }
  const ScopedTimer timer(made.times, "shot");
  // A plane has no shape to describe. Its texture may be that of boxes side by side.
  Image<std::uint8_t> off_planes = unexplained;
  if (searched != nullptr && config_.shape.skip_planes)
    off_planes = intersect(searched->scorer.off_larger_planes(largest_diameter_m_), unexplained);
  made.shot = extract_shot(view, config_.features.shot, mask_or_null(off_planes));
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
