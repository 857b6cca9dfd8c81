// SPDX-License-Identifier: Apache-2.0
#include "resight/inspection/internal/pose_faults.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "resight/inspection/internal/sure_errors.hpp"

namespace resight::inspection {
namespace {

// Pixels are those of images 640 px long. Beyond this, contours of other surfaces agree by chance
// (estimate_misregistration_px()).
constexpr double kMaxPoseError_px = 8;
constexpr double kMaxStillShift = 8.0 / 640;  // Of the image's width.
constexpr double kMinMotion_px = 5;           // Between views; less says nothing about poses and intrinsics.
constexpr double kMinGain = 3;                // How much better another convention must explain the views.
constexpr double kMinTimeGain = 2;            // The same for another time: the poses between views are interpolated.
// Factory calibrations of depth differ by up to 4 % (TUM RGB-D: 3.5 %), those of focal lengths by 5 %.
constexpr double kMaxLogScale = 0.06;
constexpr double kMaxLogFocal = 0.08;
constexpr double kMaxCenter = 0.06;  // Of the image's width.
constexpr double kMaxUnsure = 3;     // Times the limit. With a larger error, even a grossly wrong value would not show.
constexpr std::size_t kMinFarPairs = 3;

std::size_t num_steady_pairs(const SequenceMeasurements& all) {
  return static_cast<std::size_t>(std::ranges::count(all.pairs, false, &ViewPair::shows_change));
}

double sure_scale_error(const GivenPosesFit& fit) {
  return sure_errors(fit.pair_errors_px.size(), 1) * fit.log_scale->standard_error;
}

double sure_intrinsics_errors(const SequenceMeasurements& all) { return sure_errors(all.pairs.size(), 3); }

struct PoseContext {
  const SequenceMeasurements& all;
  const PoseMeasurements& poses;
  std::vector<Finding>& findings;
  int view;

  void add(const char* fault, std::string message, std::string remedy, double value, const char* unit, double threshold,
           double margin) const {
    findings.push_back({.fault = fault,
                        .message = std::move(message),
                        .remedy = std::move(remedy),
                        .value = value,
                        .unit = unit,
                        .threshold = threshold,
                        .margin = margin,
                        .view = view});
  }
  /// Errors of poses beside those of the matches themselves.
  [[nodiscard]] double excess_px(double error_px) const { return std::max(0.1, error_px - all.pair_error_px); }
  [[nodiscard]] double max_error_px() const { return kMaxPoseError_px * all.pixel_scale(); }
};

bool add_fixed(const PoseContext& c) {
  if (!c.poses.all_equal) return false;
  const double max_shift_px = kMaxStillShift * c.all.camera.width;
  if (c.all.still_share < 0.5 && c.all.pair_shift_px > max_shift_px)
    c.add("fixed_poses",
          fmt::format("the poses say that the camera stands still, but views differ by {:.0f} px", c.all.pair_shift_px),
          "--poses auto, or resight track", c.all.pair_shift_px, "px", max_shift_px,
          c.all.pair_shift_px / max_shift_px);
  return true;
}

bool add_convention(const PoseContext& c) {
  const TriedReading& given = c.poses.readings.front();
  const TriedReading& best =
      *std::ranges::min_element(c.poses.readings, {}, [](const TriedReading& r) { return r.fit.error_px; });
  const double gain = c.excess_px(given.fit.error_px) / c.excess_px(best.fit.error_px);
  if (gain < kMinGain || given.fit.error_px < c.max_error_px()) return false;
  const std::string name = best.reading.inverted ? "world to camera" : "camera to world";
  const std::string option = best.reading.opengl ? "opengl" : "world-to-camera";
  c.add("pose_convention",
        fmt::format("views disagree by {:.0f} px as given, and by {:.1f} px if the poses are read as {}{}",
                    given.fit.error_px, best.fit.error_px, name, best.reading.opengl ? " with y up" : ""),
        best.reading.opengl && best.reading.inverted ? "invert the poses, then --pose-convention opengl"
                                                     : "--pose-convention " + option + " (if it was given: without it)",
        gain, "", kMinGain, gain / kMinGain);
  return true;
}

bool add_time(const PoseContext& c) {
  const TriedReading& best =
      *std::ranges::min_element(c.poses.shifted, {}, [](const TriedReading& r) { return r.fit.error_px; });
  const double gain = c.excess_px(c.poses.given.error_px) / c.excess_px(best.fit.error_px);
  if (std::abs(best.reading.views_late) < 0.5 || gain < kMinTimeGain || c.poses.given.error_px < c.max_error_px())
    return false;
  c.add("pose_time",
        fmt::format("views disagree by {:.0f} px as given, and by {:.1f} px with the poses of {:.2g} views {}",
                    c.poses.given.error_px, best.fit.error_px, std::abs(best.reading.views_late),
                    best.reading.views_late > 0 ? "later" : "before"),
        "shift the times in the file of poses", best.reading.views_late, "views", 0.5, gain / kMinTimeGain);
  return true;
}

bool add_scale(const PoseContext& c) {
  const GivenPosesFit& fit = c.poses.readings.front().fit;
  if (!fit.log_scale) return false;
  const double log_scale = fit.log_scale->value;
  const double limit = std::max(kMaxLogScale, sure_scale_error(fit));
  if (std::abs(log_scale) < limit || c.excess_px(fit.error_px) > 0.8 * c.excess_px(c.poses.given.error_px))
    return false;
  const double scale = std::exp(log_scale);
  const bool is_unit = std::abs(std::abs(log_scale) - std::log(1000)) < 0.3;
  c.add(is_unit ? "pose_unit" : "depth_scale",
        fmt::format("the motion that depth shows is {:.4g} times that of the poses (+- {:.1f} %)", scale,
                    100 * fit.log_scale->standard_error),
        is_unit && scale < 1 ? "divide the translations by 1000: they are in millimetres where metres are expected"
        : is_unit            ? "multiply the translations by 1000: they are in metres where millimetres are expected"
                  : fmt::format("--depth-scale {:.3g} times the present one, if the poses are right", 1 / scale),
        scale, "", std::exp(limit), std::abs(log_scale) / limit);
  return true;
}

bool add_intrinsics(const PoseContext& c) {
  if (!c.all.intrinsics) return false;
  const IntrinsicsFit& fit = *c.all.intrinsics;
  const double sigmas = sure_intrinsics_errors(c.all);
  const double focal_limit = std::max(kMaxLogFocal, sigmas * fit.log_focal.standard_error);
  const auto margin_of_center = [&](const Estimate& e) {
    return std::abs(e.value) / std::max(kMaxCenter * c.all.camera.width, sigmas * e.standard_error);
  };
  const double margin = std::max({std::abs(fit.log_focal.value) / focal_limit, margin_of_center(fit.center_x_px),
                                  margin_of_center(fit.center_y_px)});
  if (margin <= 1) return false;
  const Camera& k = c.all.camera;
  const double focal = std::exp(fit.log_focal.value);
  const std::string better = fmt::format("{:.0f},{:.0f},{:.0f},{:.0f}", focal * k.fx, focal * k.fy,
                                         k.cx + fit.center_x_px.value, k.cy + fit.center_y_px.value);
  c.add("intrinsics", fmt::format("the views move like those of a camera with fx,fy,cx,cy = {}", better),
        "--intrinsics of this camera and resolution (about " + better + ")", focal, "", std::exp(focal_limit), margin);
  return true;
}

bool add_accuracy(const PoseContext& c) {
  const double error_px = c.excess_px(c.poses.given.error_px);
  if (error_px <= c.max_error_px()) return false;
  c.add("pose_error",
        fmt::format("views disagree by {:.0f} px under the given poses: they drift or are coarse", error_px),
        "--poses refine, or resight track", error_px, "px", c.max_error_px(), error_px / c.max_error_px());
  return true;
}

/// Views that are far apart in the sequence but show the same scene.
void add_drift(const PoseContext& c) {
  const GivenPosesFit& far = c.poses.far;
  if (far.pair_errors_px.size() < kMinFarPairs) return;
  const double error_px = far.error_px - c.all.far_pair_error_px;
  if (error_px <= c.max_error_px()) return;
  const PoseContext at_far{c.all, c.poses, c.findings, c.all.far_pairs.front().b};
  at_far.add("pose_drift",
             fmt::format("views far apart in the sequence disagree by {:.0f} px under the given poses ({} pairs), and "
                         "neighbours by {:.1f} px: they drift",
                         error_px, far.pair_errors_px.size(), c.excess_px(c.poses.given.error_px)),
             "--poses refine, or resight track, which closes loops", error_px, "px", c.max_error_px(),
             error_px / c.max_error_px());
}

}  // namespace

std::optional<std::string> why_unit_is_unmeasured(const SequenceMeasurements& all) {
  const bool moves = all.poses && !all.poses->all_equal && all.poses->readings.front().fit.log_scale;
  if (!moves || num_steady_pairs(all) < kMinComparedPairs)
    return "it needs --models, or the poses of a camera that moves";
  const double error = sure_scale_error(all.poses->readings.front().fit);
  if (error > kMaxUnsure * kMaxLogScale)
    return fmt::format("the motion between views tells it to {:.0f} % only", 100 * (std::exp(error) - 1));
  return std::nullopt;
}

bool is_unit_confirmed(const SequenceMeasurements& all) {
  if (why_unit_is_unmeasured(all)) return false;
  const GivenPosesFit& fit = all.poses->readings.front().fit;
  return std::abs(fit.log_scale->value) < std::max(kMaxLogScale, sure_scale_error(fit)) &&
         all.poses->given.error_px - all.pair_error_px <= kMaxPoseError_px * all.pixel_scale();
}

std::optional<std::string> why_poses_are_unmeasured(const SequenceMeasurements& all) {
  const std::size_t num_steady = num_steady_pairs(all);
  const bool is_compared = all.poses && !all.poses->all_equal && all.pairs.size() >= kMinComparedPairs;
  if (!is_compared || num_steady >= kMinComparedPairs) return std::nullopt;
  return fmt::format("in {} of {} pairs of views, something else has moved", all.pairs.size() - num_steady,
                     all.pairs.size());
}

std::optional<std::string> why_intrinsics_are_unmeasured(const SequenceMeasurements& all) {
  const double min_motion_px = kMinMotion_px * all.pixel_scale();
  if (all.pair_shift_px <= min_motion_px)
    return fmt::format("views differ by {:.1f} px, more than {:.0f} px are needed", all.pair_shift_px, min_motion_px);
  if (!all.intrinsics)
    return fmt::format("{} of {} pairs of views could be matched, at least {} are needed", all.pairs.size(),
                       all.num_tried_pairs, kMinFitPairs);
  const double error = sure_intrinsics_errors(all) * all.intrinsics->log_focal.standard_error;
  if (error > kMaxUnsure * kMaxLogFocal)
    return fmt::format("the views tell the focal length to {:.0f} % only", 100 * (std::exp(error) - 1));
  return std::nullopt;
}

void add_pose_faults(const SequenceMeasurements& measured, std::vector<Finding>& findings) {
  if (measured.pairs.size() < kMinComparedPairs) return;
  const PoseMeasurements none;
  const PoseContext c{measured, measured.poses ? *measured.poses : none, findings, measured.pairs.front().b};
  const bool moves = measured.pair_shift_px > kMinMotion_px * measured.pixel_scale();
  if (moves && add_intrinsics(c)) return;
  if (!measured.poses || add_fixed(c) || num_steady_pairs(measured) < kMinComparedPairs) return;
  if (add_convention(c) || add_scale(c) || add_time(c)) return;
  if (!add_accuracy(c)) add_drift(c);
}

}  // namespace resight::inspection
