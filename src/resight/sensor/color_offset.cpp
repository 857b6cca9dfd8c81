// SPDX-License-Identifier: Apache-2.0
#include "resight/sensor/color_offset.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include "resight/sensor/occluding_contour.hpp"
#include "resight/sensor/reduce_frame.hpp"

namespace resight {
namespace {

// Lengths in pixels are those of images about this long. Larger views are reduced.
constexpr double kReducedLength_px = 640;
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
constexpr std::size_t kMinViews = 3;
constexpr std::size_t kMaxViews = 32;        // The newest ones count.
constexpr double kSystematicError_px = 0.2;  // As on scenes with known offsets.
constexpr double kMinSigmas = 2;
constexpr double kMaxSigma_px = 1;
constexpr double kMaxFocalDifference = 0.05;  // Relative. An offset of 4 px then differs by the systematic error.

int find_divisor(const Camera& camera) {
  return std::max(1, static_cast<int>(std::lround(std::max(camera.width, camera.height) / kReducedLength_px)));
}

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

void add_contour_pixel(const EdgeImages& edges, int u, int v, PixelStep to, ContourContrast& contrast) {
  const Image<float>& image = to.u != 0 ? edges.row : edges.column;
  float* sum = contrast.sums.data();
  for (int erosion = kMinErosion_px; erosion <= kMaxErosion_px; ++erosion) {
    // The edge between a pixel and the one before it is kept at the one before.
    const int from_u = u + erosion * to.u - (to.u < 0 ? 1 : 0);
    const int from_v = v + erosion * to.v - (to.v < 0 ? 1 : 0);
    for (int y = from_v - kReach_px; y <= from_v + kReach_px; ++y)
      for (int x = from_u - kReach_px; x <= from_u + kReach_px; ++x, ++sum)
        if (image.contains(x, y)) *sum += image(x, y);
  }
  ++contrast.num_pixels;
}

void add_contrast(const ContourContrast& other, float sign, ContourContrast& contrast) {
  for (std::size_t i = 0; i < contrast.sums.size(); ++i) contrast.sums[i] += sign * other.sums[i];
  contrast.num_pixels += static_cast<int>(sign) * other.num_pixels;
}

ContourContrast make_contrast() { return {std::vector<float>(kNumErosions * kNumShifts * kNumShifts), 0}; }

using Halves = ColorOffsetEstimator::Halves;

Halves measure_contrast(const RgbdFrame& frame, const Image<float>& edge_distance_px, Eigen::Vector2i moved_px) {
  const EdgeImages edges = find_color_edges(frame.color);
  Halves halves = {make_contrast(), make_contrast()};
  for (int v = 0; v < frame.depth_m.height(); ++v)
    for (int u = v % 2; u < frame.depth_m.width(); u += 2) {  // Half of the pixels is enough for a mean.
      if (edge_distance_px(u, v) > 0 || std::isnan(frame.depth_m(u, v))) continue;  // Contours are edges.
      const auto half = static_cast<std::size_t>((u / kBlock_px + v / kBlock_px) % 2);
      for (const PixelStep to : kPixelSteps)
        if (is_sharp_contour(frame.depth_m, u, v, to))
          add_contour_pixel(edges, u - moved_px.x(), v - moved_px.y(), to, halves[half]);
    }
  return halves;
}

void move_colors(Eigen::Vector2i by_px, Image<Rgb8>& color) {
  if (by_px.isZero()) return;
  const Image<Rgb8> from = color;
  for (int v = 0; v < color.height(); ++v)
    for (int u = 0; u < color.width(); ++u)
      color(u, v) =
          from(std::clamp(u + by_px.x(), 0, color.width() - 1), std::clamp(v + by_px.y(), 0, color.height() - 1));
}

/// In pixels of the view, reduced if it is large. Its colours were moved by `moved_px`.
Halves measure_contrast(const PreparedView& view, const Eigen::Vector2i& moved_px) {
  const int divisor = find_divisor(view.frame.camera);
  if (divisor == 1) return measure_contrast(view.frame, view.edge_distance_px, moved_px);
  RgbdFrame frame = view.frame;
  move_colors(-moved_px, frame.color);
  frame = reduce_frame(frame, divisor);
  const DepthEdgeOptions edges;
  return measure_contrast(frame, find_edge_distance(find_depth_edges(frame.depth_m, edges), edges.max_distance_px),
                          {0, 0});
}

double peak_of_parabola(const std::vector<float>& sums, std::ptrdiff_t at, std::ptrdiff_t step) {
  const auto value = [&](std::ptrdiff_t i) { return static_cast<double>(sums[static_cast<std::size_t>(i)]); };
  const double curvature = value(at - step) - 2 * value(at) + value(at + step);
  return curvature < 0 ? 0.5 * (value(at - step) - value(at + step)) / curvature : 0;
}

/// The shift with the strongest contrast, between pixels by parabolas. Nothing if it is at the end of the reach.
std::optional<Eigen::Vector2d> find_peak(const ContourContrast& contrast) {
  if (contrast.num_pixels < kMinContourPixels) return std::nullopt;
  const auto best = std::ranges::max_element(contrast.sums) - contrast.sums.begin();
  const auto x = static_cast<int>(best % kNumShifts);
  const auto y = static_cast<int>(best / kNumShifts % kNumShifts);
  if (contrast.sums[static_cast<std::size_t>(best)] <= 0 || x == 0 || y == 0 || x == kNumShifts - 1 ||
      y == kNumShifts - 1)
    return std::nullopt;
  return Eigen::Vector2d(x - kReach_px + peak_of_parabola(contrast.sums, best, 1),
                         y - kReach_px + peak_of_parabola(contrast.sums, best, kNumShifts));
}

ContourContrast sum_of(const Halves& halves) {
  ContourContrast sum = halves[0];
  add_contrast(halves[1], 1, sum);
  return sum;
}

/// Variance of the peak of the sum, from the sums without one view each (jackknife). Nothing if one has no peak.
std::optional<Eigen::Array2d> find_jackknife_variance(std::span<const Halves* const> views,
                                                      const ContourContrast& sum) {
  std::vector<Eigen::Vector2d> peaks;
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (const Halves* left_out : views) {
    ContourContrast rest = sum;
    for (const ContourContrast& half : *left_out) add_contrast(half, -1, rest);
    const std::optional<Eigen::Vector2d> peak = find_peak(rest);
    if (!peak) return std::nullopt;
    peaks.push_back(*peak);
    mean += *peak;
  }
  const auto n = static_cast<double>(peaks.size());
  mean /= n;
  Eigen::Array2d squares = Eigen::Array2d::Zero();
  for (const Eigen::Vector2d& peak : peaks) squares += (peak - mean).array().square();
  return (n - 1) / n * squares;
}

bool is_same_camera(const Camera& a, const Camera& b) {
  const auto is_near = [](double fa, double fb) { return std::abs(fa - fb) < kMaxFocalDifference * std::max(fa, fb); };
  return a.width == b.width && a.height == b.height && is_near(a.fx, b.fx) && is_near(a.fy, b.fy);
}

}  // namespace

std::optional<Eigen::Vector2d> measure_color_offset(const PreparedView& view) {
  const Halves halves = measure_contrast(view, {0, 0});
  const std::optional<Eigen::Vector2d> a = find_peak(halves[0]);
  const std::optional<Eigen::Vector2d> b = find_peak(halves[1]);
  if (!a || !b || (*a - *b).cwiseAbs().maxCoeff() > kMaxHalfDistance_px) return std::nullopt;
  std::optional<Eigen::Vector2d> offset_px = find_peak(sum_of(halves));
  if (offset_px) *offset_px *= find_divisor(view.frame.camera);
  return offset_px;
}

bool ColorOffset::is_of(const Camera& other) const { return is_same_camera(camera, other); }

Eigen::Vector2d ColorOffset::corrected_px() const {
  if (sigma_px.maxCoeff() > kMaxSigma_px * find_divisor(camera)) return Eigen::Vector2d::Zero();
  const Eigen::Array2d limit_px = kMinSigmas * sigma_px.array();
  return (offset_px.array().abs() > limit_px).select(offset_px.array(), 0).matrix();
}

Eigen::Vector2i ColorOffset::moved_px() const { return corrected_px().array().round().cast<int>().matrix(); }

void correct_color_offset(const ColorOffset& offset, RgbdFrame& frame) {
  if (!offset.is_of(frame.camera)) return;
  move_colors(offset.moved_px(), frame.color);
  frame.camera.cx -= offset.corrected_px().x();
  frame.camera.cy -= offset.corrected_px().y();
}

ColorOffsetEstimator::ColorOffsetEstimator(const ColorOffsetOptions& options) : options_(options) { options_.check(); }

void ColorOffsetEstimator::add(const PreparedView& view, const ColorOffset& corrected) {
  if (!options_.correct) return;
  const Camera& camera = view.frame.camera;
  const Eigen::Vector2i moved_px = corrected.is_of(camera) ? corrected.moved_px() : Eigen::Vector2i(0, 0);
  views_.push_back({camera, measure_contrast(view, moved_px)});
  if (views_.size() > kMaxViews) views_.pop_front();
}

ColorOffset ColorOffsetEstimator::offset() const {
  ColorOffset offset;
  std::vector<const Halves*> views;
  for (const View& candidate : views_) {
    std::vector<const Halves*> same;
    for (const View& view : views_)
      if (is_same_camera(view.camera, candidate.camera)) same.push_back(&view.halves);
    if (same.size() <= views.size()) continue;
    views = std::move(same);
    offset.camera = candidate.camera;
  }
  offset.num_views = static_cast<int>(views.size());
  if (views.size() < kMinViews) return offset;
  Halves sums = {make_contrast(), make_contrast()};
  for (const Halves* view : views)
    for (std::size_t half = 0; half < 2; ++half) add_contrast((*view)[half], 1, sums[half]);
  const ContourContrast sum = sum_of(sums);
  const std::optional<Eigen::Vector2d> peak = find_peak(sum);
  const std::optional<Eigen::Vector2d> a = find_peak(sums[0]);
  const std::optional<Eigen::Vector2d> b = find_peak(sums[1]);
  if (!peak || !a || !b) return offset;
  const std::optional<Eigen::Array2d> variance = find_jackknife_variance(views, sum);
  if (!variance) return offset;
  const int divisor = find_divisor(offset.camera);
  offset.offset_px = divisor * *peak;
  const Eigen::Array2d half_difference_px = 0.5 * (*a - *b).array();
  offset.sigma_px =
      divisor * (*variance + half_difference_px.square() + kSystematicError_px * kSystematicError_px).sqrt().matrix();
  return offset;
}

}  // namespace resight
