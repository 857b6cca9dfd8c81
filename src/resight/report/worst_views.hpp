// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>
#include <string>
#include <vector>

#include "resight/evaluation/evaluated_run.hpp"
#include "resight/sensor/sequence.hpp"

namespace resight {

/// A view with missed or wrong objects.
struct WorstView {
  const EvaluatedRun* run = nullptr;
  int view = 0;  ///< Index into run->views.
  int rank = 0;  ///< Rank within its configuration; 0 = worst.
  int num_missed = 0;
  int num_wrong = 0;

  [[nodiscard]] const EvaluatedView& evaluated() const { return run->views[static_cast<std::size_t>(view)]; }
};

/// Finds the views of each configuration with the most missed and wrong objects, worst first (ties in the order of the
/// runs). The runs must outlive the result.
[[nodiscard]] std::vector<WorstView> find_worst_views(std::span<const EvaluatedRun> runs,
                                                      int max_views_per_configuration = 25);

/// Formats a Markdown page with each missed object, the stage at which it was lost, and each wrong object. Views of
/// rank below `num_pictures` refer to the picture worst_view_picture().
[[nodiscard]] std::string format_worst_views(std::span<const WorstView> views, int num_pictures = 0);

/// Path of a view's picture relative to the page: "worst/<preset>_k<K>_<rank>.jpg".
[[nodiscard]] std::string worst_view_picture(const WorstView& view);

/// Draws the view with its right and wrong detections, and missed objects in white. `truth`: ground truth of the view.
[[nodiscard]] Image<Rgb8> draw_evaluated_view(const RgbdFrame& frame, const ModelLibrary& library,
                                              std::span<const GroundTruthObject> truth, const EvaluatedView& view);

}  // namespace resight
