// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <deque>
#include <optional>

#include "resight/core/options.hpp"
#include "resight/sensor/prepared_view.hpp"

namespace resight {

struct ColorOffsetOptions {
  bool correct = false;
  int min_views = 3;
  double max_spread_px = 0.5;
  void check() const { check_options("ColorOffsetOptions", *this); }
};

inline void declare(OptionVisitor& v, ColorOffsetOptions& o) {
  v.field("correct", o.correct, "Colours that lie beside the depth are moved onto it, by whole pixels.", "ours");
  v.only_if(o.correct, "correct", "true", [&] {
    v.field("min_views", o.min_views, at_least(2), "With fewer measured views, colours stay where they are.");
    v.field("max_spread_px", o.max_spread_px, positive(),
            "If the views disagree by more (1.48 times the median deviation from the median), colours stay, too.");
  });
}

/// How far the colours of a camera lie beside its depth: the depth of pixel p has the colour of pixel p + offset.
struct ColorOffset {
  Eigen::Vector2d offset_px = Eigen::Vector2d::Zero();  ///< Median of the views.
  Eigen::Vector2d spread_px = Eigen::Vector2d::Zero();  ///< Of the views: 1.48 times the median deviation from it.
  int num_views = 0;                                    ///< Measured ones.
  Eigen::Vector2i moved_px = Eigen::Vector2i::Zero();   ///< By which the colours of the newest view were moved.
};

/// Measures the offset in one view: the shift that puts the occluding contours of the depth onto the strongest edges of
/// the colours. Depth may end before a contour or reach beyond it, by the same distance on all sides; this distance is
/// estimated, too. Nothing if the view has few contours, its halves disagree, or the offset is
/// larger than 4 px.
[[nodiscard]] std::optional<Eigen::Vector2d> measure_color_offset(const PreparedView& view);

/// Estimates the offset of a camera from its views so far, and corrects each view.
class ColorOffsetCorrector {
 public:
  explicit ColorOffsetCorrector(const ColorOffsetOptions& options = {});

  /// Measures the view and moves its colours by as many whole pixels as the views so far are sure of (two standard
  /// errors, with a systematic one of 0.15 px). At the border, colours repeat.
  ColorOffset correct(PreparedView& view);

 private:
  ColorOffsetOptions options_;
  std::deque<Eigen::Vector2d> measured_px_;
};

}  // namespace resight
