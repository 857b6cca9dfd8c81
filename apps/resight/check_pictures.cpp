// SPDX-License-Identifier: Apache-2.0
#include "check_pictures.hpp"

#include <algorithm>
#include <cmath>

#include "commands.hpp"
#include "resight/sensor/depth_edges.hpp"

namespace resight::app {
namespace {

constexpr Rgb8 kRed{255, 0, 0};
constexpr Rgb8 kGreen{0, 255, 0};

Image<Rgb8> draw_depth(const RgbdFrame& frame) {
  const DepthValues values = measure_depth_values(frame.depth_m);
  Image<Rgb8> picture(frame.depth_m.width(), frame.depth_m.height());
  for (std::size_t i = 0; i < picture.size(); ++i) {
    if (std::isnan(frame.depth_m[i])) continue;
    const double range_m = std::max(1e-9, values.far_m - values.near_m);
    const double share = std::clamp((values.far_m - frame.depth_m[i]) / range_m, 0.0, 1.0);
    const auto level = static_cast<std::uint8_t>(40 + 215 * share);
    picture[i] = {level, level, level};
  }
  return picture;
}

Image<Rgb8> draw_contours(const RgbdFrame& frame) {
  Image<Rgb8> picture = frame.color;
  const Image<std::uint8_t> edges = find_depth_edges(frame.depth_m);
  for (std::size_t i = 0; i < picture.size(); ++i)
    if (edges[i] != 0) picture[i] = kRed;
  return picture;
}

void draw_square(Image<Rgb8>& picture, const Eigen::Vector2d& at_px, Rgb8 color) {
  constexpr int kRadius_px = 2;
  if (!at_px.allFinite() || at_px.cwiseAbs().maxCoeff() > 1e6) return;
  for (int dv = -kRadius_px; dv <= kRadius_px; ++dv)
    for (int du = -kRadius_px; du <= kRadius_px; ++du) {
      const int u = static_cast<int>(std::lround(at_px.x())) + du;
      const int v = static_cast<int>(std::lround(at_px.y())) + dv;
      if (picture.contains(u, v)) picture(u, v) = color;
    }
}

Image<Rgb8> draw_matches(const ViewPair& pair, const SequenceMeasurements& measured, const Sequence& sequence) {
  const RgbdFrame frame = value_or_throw(sequence.read_view(pair.b));
  Image<Rgb8> picture = frame.color;
  Rigid3 b_from_a = value_or_throw(sequence.read_pose(pair.b)).inverse() * value_or_throw(sequence.read_pose(pair.a));
  b_from_a.translation /= measured.depth_unit_m;
  for (const MatchedPoint& m : pair.matches) {
    const Eigen::Vector3d in_b = b_from_a * frame.camera.unproject(m.pixel_a.x(), m.pixel_a.y(), m.depth_a);
    if (in_b.z() > 0) draw_square(picture, frame.camera.project(in_b), kRed);
    draw_square(picture, m.pixel_b, kGreen);
  }
  return picture;
}

}  // namespace

Image<Rgb8> draw_finding(const Finding& finding, const SequenceMeasurements& measured, const Sequence& sequence) {
  const RgbdFrame frame = value_or_throw(sequence.read_view(finding.view));
  const std::string& fault = finding.fault;
  if (fault == "no_depth" || fault == "eight_bit_depth") return draw_depth(frame);
  if (fault == "color_offset" || fault == "unregistered_depth" || fault == "depth_time") return draw_contours(frame);
  if (fault == "pose_drift") return draw_matches(measured.far_pairs.front(), measured, sequence);
  const bool is_pose = fault.starts_with("pose_") || fault == "fixed_poses";
  return is_pose && !measured.pairs.empty() ? draw_matches(measured.pairs.front(), measured, sequence) : frame.color;
}

}  // namespace resight::app
