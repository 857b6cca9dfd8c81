// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <array>
#include <deque>
#include <limits>
#include <optional>
#include <vector>

#include "resight/core/options.hpp"
#include "resight/sensor/prepared_view.hpp"

namespace resight {

struct ColorOffsetOptions {
  bool correct = false;
  void check() const { check_options("ColorOffsetOptions", *this); }
};

inline void declare(OptionVisitor& v, ColorOffsetOptions& o) {
  v.field("correct", o.correct,
          "Colours that are offset from the depth are moved onto it, by whole pixels, and the principal point of the "
          "depth by the whole offset. In a recorded sequence, the offset is measured before the first view.",
          "ours");
}

/// How far the colours of a camera lie beside its depth: the depth of pixel p has the colour of pixel p + offset. In
/// pixels of prepared views, which may be reduced.
struct ColorOffset {
  Eigen::Vector2d offset_px = Eigen::Vector2d::Zero();
  /// Standard error: from how much views and halves of the image disagree, and a systematic one of 0.2 px of an image
  /// 640 px long. Infinite if it is not known.
  Eigen::Vector2d sigma_px = Eigen::Vector2d::Constant(std::numeric_limits<double>::infinity());
  int num_views = 0;
  Camera camera{};  ///< Of the views that showed it, as prepared. Views of other cameras have another offset.

  /// Whether the offset, in pixels, is that of this camera, too: the image has the same size, and the focal lengths
  /// differ by less than 5 %. Principal points may differ. Cameras of one model are not told apart.
  [[nodiscard]] bool is_of(const Camera& other) const;
  /// What is corrected: the offset on axes where it is more than two standard errors. Nothing if one of these is above
  /// 1 px of an image 640 px long.
  [[nodiscard]] Eigen::Vector2d corrected_px() const;
  /// By how many whole pixels colours are moved: the nearest ones.
  [[nodiscard]] Eigen::Vector2i moved_px() const;
};

/// Contrast of the colours along the occluding contours of the depth, by the shift of the colours and the width of the
/// lost depth; summed over pixels of the contours.
struct ContourContrast {
  std::vector<float> sums;
  int num_pixels = 0;
};

/// Measures the offset in one view: the shift that puts the occluding contours of the depth onto the strongest edges of
/// the colours. Depth may end before a contour or reach beyond it, by the same distance on all sides; this distance is
/// estimated, too. Nothing if the view has few contours, its halves disagree, or the offset is larger than 4 px of an
/// image 640 px long.
[[nodiscard]] std::optional<Eigen::Vector2d> measure_color_offset(const PreparedView& view);

/// Moves the colours of a frame onto its depth (at the border, they repeat), and the principal point by the offset:
/// intrinsics and pose of a frame are those of the colours, to which depth is registered, so that the depth of pixel p
/// lies on the ray of pixel p + offset. `frame` has the size of prepared views. Frames of other cameras stay as they
/// are.
void correct_color_offset(const ColorOffset& offset, RgbdFrame& frame);

/// Estimates the offset of a camera from the contours of the newest 32 views together, of at least three. If the views
/// are of several cameras, it is the offset of the one that has most of them.
class ColorOffsetEstimator {
 public:
  using Halves = std::array<ContourContrast, 2>;  ///< The fields of a chequerboard.

  explicit ColorOffsetEstimator(const ColorOffsetOptions& options = {});

  /// Measures a view that was corrected by correct_color_offset(corrected). Does nothing unless options.correct.
  void add(const PreparedView& view, const ColorOffset& corrected = {});
  [[nodiscard]] ColorOffset offset() const;

 private:
  struct View {
    Camera camera;
    Halves halves;
  };
  ColorOffsetOptions options_;
  std::deque<View> views_;
};

}  // namespace resight
