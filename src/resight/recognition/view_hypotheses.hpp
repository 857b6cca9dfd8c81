// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <map>
#include <string>
#include <vector>

#include "resight/core/timing.hpp"
#include "resight/features/feature_set.hpp"
#include "resight/hypotheses/hypothesis.hpp"
#include "resight/recognition/recognizer_config.hpp"

namespace resight {

/// What recognition extracts from a single view. Tracked objects only decide where it is searched.
struct ViewHypotheses {
  std::vector<Hypothesis> hypotheses;                        ///< World frame; ids in the order of the sequence.
  FeatureSet sift;                                           ///< Camera frame.
  FeatureSet shot;                                           ///< Camera frame.
  std::vector<std::vector<Correspondence>> correspondences;  ///< Per object.
  StageTimes times;                                          ///< What it took to make them.
  std::vector<std::string> left_out;                         ///< Stages skipped to meet the deadline.
  Rigid3 world_from_camera;                                  ///< The pose that placed the hypotheses in the world.
};

/// The same hypotheses for another pose of their view; unchanged, bit for bit, if it is the same pose.
[[nodiscard]] std::vector<Hypothesis> move_hypotheses(const ViewHypotheses& of_view, const Rigid3& world_from_camera);

/// Keeps the hypotheses of each view for several recognisers of the same sequence with the same library and the same
/// generation_settings(). The first recogniser generates them, the others reuse them, times included. Not thread-safe.
class ViewHypothesisStore {
 public:
  /// Null if the view has none yet.
  [[nodiscard]] const ViewHypotheses* find(int view) const {
    const auto entry = of_view_.find(view);
    return entry == of_view_.end() ? nullptr : &entry->second;
  }
  const ViewHypotheses& add(int view, ViewHypotheses hypotheses) {
    return of_view_.insert_or_assign(view, std::move(hypotheses)).first->second;
  }

 private:
  std::map<int, ViewHypotheses> of_view_;
};

/// All settings that the hypotheses of a view depend on, as one text: equal texts, equal hypotheses. K and the settings
/// of later stages are left out, unless tracked objects decide where a view is searched.
[[nodiscard]] std::string generation_settings(const RecognizerConfig& config);

}  // namespace resight
