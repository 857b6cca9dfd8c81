// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "resight/inspection/find_faults.hpp"
#include "resight/inspection/internal/image_faults.hpp"

namespace resight {
namespace inspection {
namespace {

// Ranges of common RGB-D cameras: 0.25 m (RealSense D4xx) to 10 m; some metres more for the median of a hall.
constexpr double kMinMedian_m = 0.25;
constexpr double kMaxMedian_m = 12;
constexpr double kMinMeasuredShare = 0.05;
constexpr double kMinBrightGrey = 16;
// Horizontal fields of view of 130 and 20 deg; RGB-D cameras have 43 to 120.
constexpr double kMinFocal = 0.23;
constexpr double kMaxFocal = 2.9;
constexpr double kMaxFocalRatio = 1.25;  // fx over fy: pixels of cameras are square.
// No lens is mounted farther off: intrinsics of an image of half or twice the size lie at a quarter or at the border.
constexpr double kMaxCenterOffset = 1.0 / 6;
constexpr double kMaxOrigin_m = 10000;  // Single precision is finer than a millimetre up to here.
// Noise of planes over the law of the Kinect, beyond 4 m: time of flight has a quarter (Tölgyessy et al. 2021).
constexpr double kFar_m = 4;
constexpr double kMinNoiseRatio = 0.15;

double over(double value, double threshold) {
  return std::min(1e6, std::max(std::abs(value) / threshold, threshold / std::max(1e-12, std::abs(value))));
}

}  // namespace

void add_depth_faults(const DepthValues& depth, double noise_ratio, int view, std::vector<Finding>& findings) {
  if (depth.measured_share < kMinMeasuredShare) {
    findings.push_back({.fault = "no_depth",
                        .message = fmt::format("only {:.1f} % of the pixels have depth", 100 * depth.measured_share),
                        .remedy = "record the depth stream; check that the depth images are not empty",
                        .value = depth.measured_share,
                        .unit = "",
                        .threshold = kMinMeasuredShare,
                        .margin = over(depth.measured_share, kMinMeasuredShare),
                        .view = view});
    return;
  }
  if (depth.has_eight_bits)
    findings.push_back({.fault = "eight_bit_depth",
                        .message = fmt::format("depth has {} levels only: eight bits", depth.num_levels),
                        .remedy = "save 16-bit PNG; pictures of depth are no depth",
                        .value = static_cast<double>(depth.num_levels),
                        .unit = "levels",
                        .threshold = 256,
                        .margin = over(depth.num_levels, 256),
                        .view = view});
  const bool too_near = depth.median_m < kMinMedian_m;
  const bool too_far = depth.median_m > kMaxMedian_m;
  const bool too_smooth = depth.median_m > kFar_m && noise_ratio < kMinNoiseRatio;
  if (!too_near && !too_far && !too_smooth) return;
  const double limit = too_near ? kMinMedian_m : kMaxMedian_m;
  Finding f{.fault = "depth_scale",
            .message = fmt::format("the median depth is {:.3g} m: the unit of depth is wrong", depth.median_m),
            .remedy = "--depth-scale METRES per stored unit (0.001: millimetres, 0.0002: 5000 per metre)",
            .value = depth.median_m,
            .unit = "m",
            .threshold = limit,
            .margin = over(depth.median_m, limit),
            .view = view};
  if (!too_near && !too_far) {
    f.message = fmt::format("surfaces at {:.3g} m have {:.2g} times the noise of a sensor: the unit of depth is wrong",
                            depth.median_m, noise_ratio);
    f.value = noise_ratio;
    f.unit = "";
    f.threshold = kMinNoiseRatio;
    f.margin = over(noise_ratio, kMinNoiseRatio);
  }
  findings.push_back(std::move(f));
}

void add_color_faults(double bright_grey, int view, std::vector<Finding>& findings) {
  if (bright_grey >= kMinBrightGrey) return;
  findings.push_back({.fault = "black_image",
                      .message = fmt::format("the colours are black (95 % of the pixels are at most {})", bright_grey),
                      .remedy = "check exposure, light and the colour stream",
                      .value = bright_grey,
                      .unit = "grey levels",
                      .threshold = kMinBrightGrey,
                      .margin = over(bright_grey + 1, kMinBrightGrey),
                      .view = view});
}

void add_camera_faults(const Camera& camera, int view, std::vector<Finding>& findings) {
  const auto add = [&](const std::string& message, double value, double threshold, const char* unit) {
    findings.push_back(
        {.fault = "intrinsics",
         .message = message,
         .remedy = fmt::format("--intrinsics fx,fy,cx,cy of images of {}x{}", camera.width, camera.height),
         .value = value,
         .unit = unit,
         .threshold = threshold,
         .margin = over(value, threshold),
         .view = view});
  };
  const double focal = camera.fx / camera.width;
  if (focal < kMinFocal || focal > kMaxFocal)
    return add(fmt::format("a focal length of {:.3g} px does not fit images {} px wide", camera.fx, camera.width),
               camera.fx, (focal < kMinFocal ? kMinFocal : kMaxFocal) * camera.width, "px");
  const double ratio = camera.fx / camera.fy;
  if (ratio > kMaxFocalRatio || ratio < 1 / kMaxFocalRatio)
    return add(fmt::format("fx and fy differ by a factor of {:.3g}", ratio), ratio,
               ratio > 1 ? kMaxFocalRatio : 1 / kMaxFocalRatio, "");
  const double x_px = camera.cx - 0.5 * (camera.width - 1);
  const double y_px = camera.cy - 0.5 * (camera.height - 1);
  const double offset = std::max(std::abs(x_px) / camera.width, std::abs(y_px) / camera.height);
  if (offset <= kMaxCenterOffset) return;
  add(fmt::format("the principal point ({:.6g}, {:.6g}) is not near the middle of {}x{} images", camera.cx, camera.cy,
                  camera.width, camera.height),
      offset, kMaxCenterOffset, "");
}

void add_origin_fault(double distance_m, int view, std::vector<Finding>& findings) {
  if (distance_m <= kMaxOrigin_m) return;
  findings.push_back({.fault = "far_from_origin",
                      .message = fmt::format("the camera is {:.0f} km from the origin of the world", 1e-3 * distance_m),
                      .remedy = "subtract the position of the first view from all poses, or check their unit",
                      .value = distance_m,
                      .unit = "m",
                      .threshold = kMaxOrigin_m,
                      .margin = over(distance_m, kMaxOrigin_m),
                      .view = view});
}

}  // namespace inspection

std::vector<Finding> find_view_faults(const RgbdFrame& frame) {
  std::vector<Finding> findings;
  inspection::add_camera_faults(frame.camera, 0, findings);
  inspection::add_depth_faults(measure_depth_values(frame.depth_m), measure_noise_ratio(frame.depth_m, frame.camera.fx),
                               0, findings);
  inspection::add_color_faults(measure_color_values(frame.color).bright_grey, 0, findings);
  inspection::add_origin_fault(frame.world_from_camera.translation.norm(), 0, findings);
  return findings;
}

}  // namespace resight
