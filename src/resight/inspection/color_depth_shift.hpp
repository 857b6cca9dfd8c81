// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

#include "resight/sensor/prepared_view.hpp"
#include "resight/sensor/rgbd_frame.hpp"

namespace resight {

/// What registered depth may be off by; the scales searched are 5 % apart.
inline constexpr double kMaxRegisteredShift_px = 5;
inline constexpr double kMaxRegisteredScale = 0.03;

/// Where the colours of a camera lie beside its depth: the depth of pixel p has the colour of pixel
/// middle + scale * (p - middle) + shift. A scale other than 1 is that of two cameras with different focal lengths.
struct ColorDepthShift {
  Eigen::Vector2d shift_px = Eigen::Vector2d::Zero();
  double scale = 1;
  double peak_sigmas = 0;    ///< Height of the peak above the scores of all shifts, in their standard deviations.
  double mean_contrast = 0;  ///< At the peak, grey levels per pixel of the contours.
};

/// Contrast of the colours across the occluding contours of the depth, for each shift and scale of the colours. The
/// scores of several views of one camera may be added.
class ShiftScores {
 public:
  /// Largest shift searched, px.
  static constexpr int kReach_px = 48;
  static constexpr std::array<double, 8> kScales{0.8, 0.85, 0.9, 0.95, 1, 1.05, 1.1, 1.2};

  ShiftScores();
  /// Takes up to about 1,000 pixels of the contours.
  void add(const PreparedView& view);
  void add(const ShiftScores& other);
  /// The best shift and scale; none with fewer than 200 pixels of contours.
  [[nodiscard]] std::optional<ColorDepthShift> peak() const;

 private:
  static constexpr int kNumShifts = 2 * kReach_px + 1;
  std::array<std::vector<float>, kScales.size()> sums_;
  int num_pixels_ = 0;
};

/// The shift of depth that is not registered to the colours: more than `max_registered_px` or a scale, the same in both
/// halves of the views. None if there is none, or if the contours do not tell.
[[nodiscard]] std::optional<ColorDepthShift> find_unregistered_shift(const std::array<ShiftScores, 2>& half_shifts,
                                                                     double max_registered_px = kMaxRegisteredShift_px);

/// Takes the colours from where they lie beside the depth. Pixels without a colour lose their depth.
void align_colors(const ColorDepthShift& shift, RgbdFrame& frame);

}  // namespace resight
