// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>
#include <vector>

namespace resight {

/// A line of a plot. Points with a NaN are left out, and the line is interrupted there.
struct PlotSeries {
  std::string name;
  std::vector<double> x;
  std::vector<double> y;  ///< As long as x.
};

struct LinePlot {
  std::string title;
  std::string x_label;
  std::string y_label;
  std::vector<PlotSeries> series;
  std::optional<double> y_min, y_max;  ///< Absent: from the data, zero included.
};

/// The plot as a stand-alone SVG picture. Series keep their colour by their position. Throws std::invalid_argument for
/// a series whose x and y differ in length.
[[nodiscard]] std::string format_svg(const LinePlot& plot);

}  // namespace resight
