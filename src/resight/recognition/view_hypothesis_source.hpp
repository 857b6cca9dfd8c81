// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <memory>
#include <optional>

#include "resight/recognition/view_hypothesis_generator.hpp"

namespace resight {

/// The hypotheses of single views: generated, or taken from a store that several recognisers share.
class ViewHypothesisSource {
 public:
  /// Library and config must outlive it. `store`: null = every view is generated.
  ViewHypothesisSource(const ModelLibrary& library, const RecognizerConfig& config,
                       std::shared_ptr<ViewHypothesisStore> store);

  /// The stored hypotheses of a view; null if they must be generated.
  [[nodiscard]] std::shared_ptr<const ViewHypotheses> find_stored(int number) const;
  /// Generates the hypotheses of a view, with ids above those of all views before, and stores them; parameters as in
  /// ViewHypothesisGenerator::generate(). `planning_times` are added to the times of the result.
  [[nodiscard]] std::shared_ptr<const ViewHypotheses> generate(const PreparedView& view, int number,
                                                               const Deadline& deadline,
                                                               const Image<std::uint8_t>& skipped,
                                                               const StageTimes& planning_times);
  /// Reserves the ids of hypotheses that are used; to be called for each view that is searched, stored or not.
  void reserve_ids(const ViewHypotheses& used) { next_id_ += used.hypotheses.size(); }

 private:
  const ModelLibrary& library_;
  const RecognizerConfig& config_;
  std::shared_ptr<ViewHypothesisStore> store_;
  std::optional<ViewHypothesisGenerator> generator_;  // With a store: made when a view needs it.
  std::uint64_t next_id_ = 0;
};

}  // namespace resight
