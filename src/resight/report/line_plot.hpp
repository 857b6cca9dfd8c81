// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>
#include <vector>

namespace resight {

/// A line of a plot. NaN points are skipped and interrupt the line.
struct PlotSeries {
  std::string name;
  std::vector<double> x;
  std::vector<double> y;  ///< Same length as x.
};

/// A plot with one or more series.
struct LinePlot {
  std::string title;
  std::string x_label;
  std::string y_label;
  std::vector<PlotSeries> series;
  std::optional<double> y_min, y_max;  ///< Absent: from the data, including zero.
};

/// Formats the plot as a stand-alone SVG image. The colour of a series depends on its position. Throws
/// std::invalid_argument if x and y of a series differ in length.
[[nodiscard]] std::string format_svg(const LinePlot& plot);

}  // namespace resight
