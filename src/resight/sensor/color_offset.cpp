// SPDX-License-Identifier: Apache-2.0
#include "resight/sensor/color_offset.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "resight/core/statistics.hpp"
#include "resight/sensor/occluding_contour.hpp"

namespace resight {
namespace {

constexpr int kReach_px = 5;  // Of the search; at its border there is no peak.
constexpr int kNumShifts = 2 * kReach_px + 1;
// Distance of the contour from the outermost pixel of the near surface: depth is smeared over it, or lost before it.
constexpr int kMinErosion_px = -2;
constexpr int kMaxErosion_px = 4;
constexpr int kNumErosions = kMaxErosion_px - kMinErosion_px + 1;
constexpr float kMaxSlope = 0.03F;      // Change of depth over two pixels of the near surface.
constexpr float kMaxContrast = 40;      // Grey levels. Stronger edges count no more.
constexpr int kBlock_px = 64;           // The halves of a view are the fields of a chequerboard.
constexpr int kMinContourPixels = 100;  // Per half.
constexpr double kMaxHalfDistance_px = 1;
constexpr std::size_t kMaxViews = 32;            // The newest ones count.
constexpr double kSystematicError_px = 0.15;     // As on scenes with known offsets.
constexpr double kMedianOverMeanError = 1.2533;  // Of their standard errors, if errors are normal: sqrt(pi / 2).

/// Contrast between a pixel and its next neighbour in the row and in the column.
struct EdgeImages {
  Image<float> row;
  Image<float> column;
};

EdgeImages find_color_edges(const Image<Rgb8>& color) {
  EdgeImages edges{Image<float>(color.width(), color.height()), Image<float>(color.width(), color.height())};
  const auto grey = [&](int u, int v) {
    const Rgb8& c = color(u, v);
    return static_cast<float>(c.r + c.g + c.b) / 3;
  };
  for (int v = 0; v + 1 < color.height(); ++v)
    for (int u = 0; u + 1 < color.width(); ++u) {
      edges.row(u, v) = std::min(std::abs(grey(u + 1, v) - grey(u, v)), kMaxContrast);
      edges.column(u, v) = std::min(std::abs(grey(u, v + 1) - grey(u, v)), kMaxContrast);
    }
  return edges;
}

/// Whether the pixel is the outermost of a smooth surface that ends before another one.
bool is_sharp_contour(const Image<float>& depth_m, int u, int v, PixelStep towards) {
  if (!depth_m.contains(u - 2 * towards.u, v - 2 * towards.v)) return false;
  const float near_m = depth_m(u, v);
  return std::abs(depth_m(u - 2 * towards.u, v - 2 * towards.v) - near_m) < kMaxSlope * near_m &&
         is_occluding_contour(depth_m, u, v, towards);
}

/// Contrast of the colours along the contours, for each shift of these and each erosion.
class ContourContrast {
 public:
  void add(const EdgeImages& edges, int u, int v, PixelStep to) {
    const Image<float>& image = to.u != 0 ? edges.row : edges.column;
    float* sum = sums_.data();
    for (int erosion = kMinErosion_px; erosion <= kMaxErosion_px; ++erosion) {
      // The edge between a pixel and the one before it is kept at the one before.
      const int from_u = u + erosion * to.u - (to.u < 0 ? 1 : 0);
      const int from_v = v + erosion * to.v - (to.v < 0 ? 1 : 0);
      for (int y = from_v - kReach_px; y <= from_v + kReach_px; ++y)
        for (int x = from_u - kReach_px; x <= from_u + kReach_px; ++x, ++sum)
          if (image.contains(x, y)) *sum += image(x, y);
    }
    ++num_pixels_;
  }
  void add(const ContourContrast& other) {
    for (std::size_t i = 0; i < sums_.size(); ++i) sums_[i] += other.sums_[i];
    num_pixels_ += other.num_pixels_;
  }
  [[nodiscard]] int num_pixels() const { return num_pixels_; }

  /// The shift with the strongest contrast, between pixels by parabolas.
  [[nodiscard]] std::optional<Eigen::Vector2d> peak() const {
    const auto best = std::ranges::max_element(sums_) - sums_.begin();
    const auto x = static_cast<int>(best % kNumShifts);
    const auto y = static_cast<int>(best / kNumShifts % kNumShifts);
    if (*std::ranges::max_element(sums_) <= 0 || x == 0 || y == 0 || x == kNumShifts - 1 || y == kNumShifts - 1)
      return std::nullopt;
    return Eigen::Vector2d(x - kReach_px + peak_of_parabola(best, 1),
                           y - kReach_px + peak_of_parabola(best, kNumShifts));
  }

 private:
  [[nodiscard]] double peak_of_parabola(std::ptrdiff_t at, std::ptrdiff_t step) const {
    const auto value = [&](std::ptrdiff_t i) { return static_cast<double>(sums_[static_cast<std::size_t>(i)]); };
    const double curvature = value(at - step) - 2 * value(at) + value(at + step);
    return curvature < 0 ? 0.5 * (value(at - step) - value(at + step)) / curvature : 0;
  }

  std::vector<float> sums_ = std::vector<float>(kNumErosions * kNumShifts * kNumShifts);
  int num_pixels_ = 0;
};

void move_colors(Eigen::Vector2i by_px, Image<Rgb8>& color) {
  if (by_px.isZero()) return;
  const Image<Rgb8> from = color;
  for (int v = 0; v < color.height(); ++v)
    for (int u = 0; u < color.width(); ++u)
      color(u, v) =
          from(std::clamp(u + by_px.x(), 0, color.width() - 1), std::clamp(v + by_px.y(), 0, color.height() - 1));
}

}  // namespace

std::optional<Eigen::Vector2d> measure_color_offset(const PreparedView& view) {
  const RgbdFrame& frame = view.frame;
  const EdgeImages edges = find_color_edges(frame.color);
  std::array<ContourContrast, 2> halves;
  for (int v = 0; v < frame.depth_m.height(); ++v)
    for (int u = v % 2; u < frame.depth_m.width(); u += 2) {  // Half of the pixels is enough for a mean.
      if (view.edge_distance_px(u, v) > 0 || std::isnan(frame.depth_m(u, v))) continue;  // Contours are edges.
      const auto half = static_cast<std::size_t>((u / kBlock_px + v / kBlock_px) % 2);
      for (const PixelStep to : kPixelSteps)
        if (is_sharp_contour(frame.depth_m, u, v, to)) halves[half].add(edges, u, v, to);
    }
  for (const ContourContrast& half : halves)
    if (half.num_pixels() < kMinContourPixels) return std::nullopt;
  const std::optional<Eigen::Vector2d> a = halves[0].peak();
  const std::optional<Eigen::Vector2d> b = halves[1].peak();
  if (!a || !b || (*a - *b).cwiseAbs().maxCoeff() > kMaxHalfDistance_px) return std::nullopt;
  halves[0].add(halves[1]);
  return halves[0].peak();
}

ColorOffsetCorrector::ColorOffsetCorrector(const ColorOffsetOptions& options) : options_(options) { options_.check(); }

ColorOffset ColorOffsetCorrector::correct(PreparedView& view) {
  ColorOffset offset;
  if (!options_.correct) return offset;
  if (const std::optional<Eigen::Vector2d> measured = measure_color_offset(view)) measured_px_.push_back(*measured);
  if (measured_px_.size() > kMaxViews) measured_px_.pop_front();
  offset.num_views = static_cast<int>(measured_px_.size());
  if (measured_px_.empty()) return offset;
  for (int axis = 0; axis < 2; ++axis) {
    std::vector<double> values;
    for (const Eigen::Vector2d& measured_px : measured_px_) values.push_back(measured_px[axis]);
    offset.offset_px[axis] = upper_median(values);
    for (double& value : values) value = std::abs(value - offset.offset_px[axis]);
    offset.spread_px[axis] = kNormalizedMad * upper_median(values);
  }
  if (offset.num_views < options_.min_views || offset.spread_px.maxCoeff() > options_.max_spread_px) return offset;
  for (int axis = 0; axis < 2; ++axis) {
    const double standard_error =
        kMedianOverMeanError * offset.spread_px[axis] / std::sqrt(static_cast<double>(offset.num_views));
    const double error_px = 2 * std::hypot(standard_error, kSystematicError_px);
    const double sure_px = std::floor(std::max(0.0, std::abs(offset.offset_px[axis]) + 0.5 - error_px));
    offset.moved_px[axis] = static_cast<int>(std::copysign(sure_px, offset.offset_px[axis]));
  }
  move_colors(offset.moved_px, view.frame.color);
  if (!view.averaged_color.empty()) move_colors(offset.moved_px, view.averaged_color);
  return offset;
}

}  // namespace resight
