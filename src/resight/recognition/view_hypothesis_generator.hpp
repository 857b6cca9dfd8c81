// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <vector>

#include "resight/core/deadline.hpp"
#include "resight/hypotheses/generation.hpp"
#include "resight/models/object_model.hpp"
#include "resight/recognition/recognizer_config.hpp"
#include "resight/recognition/view_hypotheses.hpp"
#include "resight/sensor/prepared_view.hpp"
#include "resight/shape_search/shape_search.hpp"

namespace resight {

/// What the shape search shares with the verification.
[[nodiscard]] MatchCriteria match_criteria(const VerifyOptions& verify);

/// Generates the hypotheses of single views: from groups of correspondences (paper, Sec. III-A), and from shape if
/// RecognizerConfig::shape is enabled. Library and config must outlive it.
class ViewHypothesisGenerator {
 public:
  ViewHypothesisGenerator(const ModelLibrary& library, const RecognizerConfig& config);

  /// Searches a view with its number in the sequence; ids start at `first_id`. Pixels where `explained` is not 0 are
  /// skipped (same size as the view; empty: none is). After the deadline, neither the search as a whole nor the search
  /// by shape is begun.
  [[nodiscard]] ViewHypotheses generate(const PreparedView& view, int number, std::uint64_t first_id,
                                        const Deadline& deadline = {}, const Image<std::uint8_t>& explained = {}) const;

 private:
  void extract_features(const PreparedView& view, const SearchView* searched, const Image<std::uint8_t>& explained,
                        ViewHypotheses& made) const;
  void add_from_shape(const PreparedView& view, const SearchView& searched, int number, const Deadline& deadline,
                      ViewHypotheses& made) const;
  void discard_spurious(const SearchView& view, std::vector<Hypothesis>& hypotheses) const;

  const RecognizerConfig& config_;
  ModelFeatureIndex index_;
  ShapeSearch shapes_;  // Of no objects if it is not enabled.
  float largest_diameter_m_ = 0;
};

}  // namespace resight
