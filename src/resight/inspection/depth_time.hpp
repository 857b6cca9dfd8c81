// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "resight/inspection/view_pairs.hpp"
#include "resight/sensor/prepared_view.hpp"

namespace resight {

/// Contours of the depth of a view, and the contrast of its colours. In pixels of the view, which may be reduced.
struct ContourView {
  std::vector<Eigen::Vector3f> points_m;  ///< Camera frame.
  std::vector<Eigen::Vector2f> pixels;    ///< Of the points.
  std::vector<std::uint8_t> along_row;    ///< Per point: the surface ends along its row of pixels.
  std::array<Image<float>, 2> contrasts;  ///< Along columns, along rows.
};
[[nodiscard]] ContourView find_contour_view(const PreparedView& view);

/// When the depth of a sequence was measured, beside its colours.
struct DepthTime {
  double views_late = 0;       ///< The depth of view v is that of the time v + views_late.
  double displacement_px = 0;  ///< Median distance by which contours are off as given.
  double mean_contrast = 0;    ///< Of the colours at the contours, where that time puts them, grey levels.
  /// The same over the contrast as given, with any shift of up to 4 px: that of the half of the views that gains less.
  double gain = 0;
};

/// Moves the contours of the depth by the motion of the camera, as if they had been measured up to one view earlier or
/// later, and finds the time at which the colours have the strongest contrast there. A constant offset of the colours
/// of up to 4 px does not matter. None with too few contours. `pairs`: those of neighbouring views are used; `camera`:
/// that of the contours; `depth_unit_m`: unit of the pairs' translations.
[[nodiscard]] std::optional<DepthTime> measure_depth_time(const std::map<int, ContourView>& views,
                                                          std::span<const ViewPair> pairs, const Camera& camera,
                                                          double depth_unit_m);

}  // namespace resight
