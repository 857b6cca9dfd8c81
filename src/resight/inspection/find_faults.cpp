// SPDX-License-Identifier: Apache-2.0
#include "resight/inspection/find_faults.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <set>

#include "resight/core/statistics.hpp"
#include "resight/inspection/internal/image_faults.hpp"
#include "resight/inspection/internal/pose_faults.hpp"

namespace resight {
namespace {

// Pixels are those of images 640 px long.
constexpr double kMaxEdgeWidth_px = 8;  // SIFT finds little in the finest three octaves then.
constexpr double kMaxBlurredShare = 0.1;
constexpr double kMaxFineShift_px = 2;  // Twice the width of a depth edge; appearance tolerates one pixel.
constexpr std::size_t kMinShiftViews = 3;
constexpr double kMinTimeContrast = 1.15;    // Over the contrast as given.
constexpr double kMaxRelativeSpread = 0.34;  // A shift that varies is none of the calibration.

/// The faults of all views, once per kind, with the number of views that have it. The middle one stands for them.
std::vector<Finding> join_view_faults(const SequenceMeasurements& measured) {
  std::vector<Finding> all;
  for (const ViewMeasurements& v : measured.views) {
    inspection::add_depth_faults(v.depth, v.noise_ratio, v.view, all);
    inspection::add_color_faults(v.color.bright_grey, v.view, all);
  }
  std::vector<Finding> joined;
  std::set<std::string> done;
  const bool is_unit_right = inspection::is_unit_confirmed(measured);
  for (const Finding& f : all) {
    if (!done.insert(f.fault).second || (f.fault == "depth_scale" && is_unit_right)) continue;
    std::vector<Finding> same;
    std::ranges::copy_if(all, std::back_inserter(same), [&](const Finding& g) { return g.fault == f.fault; });
    // A single near wall is no wrong unit: that one is common to all views.
    const bool is_common = f.fault == "depth_scale" || f.fault == "eight_bit_depth";
    if (is_common && 2 * same.size() <= measured.views.size()) continue;
    joined.push_back(same[same.size() / 2]);
    joined.back().message += fmt::format(" ({} of {} inspected views)", same.size(), measured.views.size());
  }
  return joined;
}

void add_blur(const SequenceMeasurements& measured, std::vector<Finding>& findings) {
  std::vector<double> widths_px;
  const ViewMeasurements* worst = nullptr;
  int num_blurred = 0;
  for (const ViewMeasurements& v : measured.views) {
    if (!(v.color.edge_width_px > kMaxEdgeWidth_px)) continue;
    ++num_blurred;
    if (worst == nullptr || v.color.edge_width_px > worst->color.edge_width_px) worst = &v;
  }
  const std::size_t num_views = measured.views.size();
  const bool is_one_of_several = num_blurred == 1 && num_views > 1;
  if (worst == nullptr || is_one_of_several || num_blurred <= kMaxBlurredShare * static_cast<double>(num_views)) return;
  findings.push_back({.fault = "motion_blur",
                      .message = fmt::format("{} of {} inspected views are blurred (edges are up to {:.1f} px wide)",
                                             num_blurred, measured.views.size(), worst->color.edge_width_px),
                      .remedy = "move the camera more slowly or shorten the exposure; --every leaves views out",
                      .value = worst->color.edge_width_px,
                      .unit = "px",
                      .threshold = kMaxEdgeWidth_px,
                      .margin = worst->color.edge_width_px / kMaxEdgeWidth_px,
                      .view = worst->view});
}

/// Size of a pixel of an image 640 px long, in pixels of the views whose contours are compared.
double contour_scale(const SequenceMeasurements& measured) { return measured.pixel_scale() / measured.contour_divisor; }

bool add_wide_shift(const SequenceMeasurements& measured, double max_px, std::vector<Finding>& findings) {
  const auto shift = find_unregistered_shift(measured.half_shifts, max_px);
  if (!shift) return false;
  const int unit = measured.contour_divisor;
  const double shift_px = shift->shift_px.norm();
  findings.push_back({.fault = "unregistered_depth",
                      .message = fmt::format("colours lie ({:.0f}, {:.0f}) px beside the depth, {:.2f} times as large",
                                             unit * shift->shift_px.x(), unit * shift->shift_px.y(), shift->scale),
                      .remedy = "record depth registered (aligned) to colour",
                      .value = unit * shift_px,
                      .unit = "px",
                      .threshold = unit * max_px,
                      .margin = std::max(shift_px / max_px, std::abs(shift->scale - 1) / kMaxRegisteredScale),
                      .view = measured.views.front().view});
  return true;
}

/// True if the views agree on a shift, which may be no fault.
bool add_fine_shift(const SequenceMeasurements& measured, std::vector<Finding>& findings) {
  std::vector<double> x_px, y_px, distances_px;
  for (const ViewMeasurements& v : measured.views)
    if (v.fine_shift_px) {
      x_px.push_back(v.fine_shift_px->x());
      y_px.push_back(v.fine_shift_px->y());
    }
  if (x_px.size() < std::min(kMinShiftViews, measured.views.size())) return false;
  const Eigen::Vector2d shift_px(upper_median(x_px), upper_median(y_px));
  for (std::size_t i = 0; i < x_px.size(); ++i)
    distances_px.push_back((Eigen::Vector2d(x_px[i], y_px[i]) - shift_px).norm());
  const double spread_px = upper_median(std::move(distances_px));
  const double limit_px = kMaxFineShift_px * contour_scale(measured);
  if (spread_px > kMaxRelativeSpread * std::max(limit_px, shift_px.norm())) return false;
  if (shift_px.norm() <= limit_px) return true;
  const int unit = measured.contour_divisor;
  findings.push_back(
      {.fault = "color_offset",
       .message = fmt::format("colours lie ({:.1f}, {:.1f}) px beside the depth ({} views, spread {:.1f} px)",
                              unit * shift_px.x(), unit * shift_px.y(), x_px.size(), unit * spread_px),
       .remedy = fmt::format("calibrate both cameras; preset default corrects up to {} px by itself", 4 * unit),
       .value = unit * shift_px.norm(),
       .unit = "px",
       .threshold = unit * limit_px,
       .margin = shift_px.norm() / limit_px,
       .view = measured.views.front().view});
  return true;
}

/// The wide search is coarser, so that it decides on small shifts only where the fine one, whose reach ends at 4.5 px
/// of the reduced views, finds none.
void add_shift(const SequenceMeasurements& measured, std::vector<Finding>& findings) {
  constexpr double kMaxSureFineShift_px = 3.5;
  const double limit_px = kMaxRegisteredShift_px * contour_scale(measured);
  if (!add_wide_shift(measured, limit_px, findings) && !add_fine_shift(measured, findings))
    add_wide_shift(measured, std::min(limit_px, kMaxSureFineShift_px), findings);
}

ShiftScores all_shifts(const SequenceMeasurements& measured) {
  ShiftScores shifts = measured.half_shifts[0];
  shifts.add(measured.half_shifts[1]);
  return shifts;
}

/// Depth of another time than the colours. A constant shift that explains the colours better is none of time.
bool add_depth_time(const SequenceMeasurements& measured, std::vector<Finding>& findings) {
  if (!measured.depth_time) return false;
  const DepthTime& time = *measured.depth_time;
  const double limit_px = kMaxFineShift_px * contour_scale(measured);
  if (time.views_late == 0 || time.displacement_px <= limit_px || time.gain < kMinTimeContrast) return false;
  const auto shift = all_shifts(measured).peak();
  if (shift && shift->mean_contrast > time.mean_contrast) return false;
  findings.push_back({.fault = "depth_time",
                      .message = fmt::format("depth is that of {:.2g} views {} than the colours, {:.0f} px beside them",
                                             std::abs(time.views_late), time.views_late > 0 ? "later" : "earlier",
                                             measured.contour_divisor * time.displacement_px),
                      .remedy = "record both streams by one clock; pair the images by their times, not their numbers",
                      .value = time.views_late,
                      .unit = "views",
                      .threshold = 0.25,
                      .margin = std::min(time.gain / kMinTimeContrast, time.displacement_px / limit_px),
                      .view = measured.pairs.front().b});
  return true;
}

}  // namespace

std::vector<std::string> picture_names(std::span<const Finding> findings) {
  std::map<std::string, int> counts;
  std::vector<std::string> names;
  for (const Finding& f : findings)
    names.push_back(++counts[f.fault] == 1 ? f.fault + ".png" : fmt::format("{}_{}.png", f.fault, counts[f.fault]));
  return names;
}

std::vector<Finding> find_faults(const SequenceMeasurements& measured) {
  std::vector<Finding> findings;
  inspection::add_camera_faults(measured.camera, measured.views.front().view, findings);
  const bool has_camera = findings.empty();
  for (Finding& f : join_view_faults(measured)) findings.push_back(std::move(f));
  if (measured.poses) inspection::add_origin_fault(measured.poses->farthest_m, 0, findings);
  add_blur(measured, findings);
  if (!add_depth_time(measured, findings)) add_shift(measured, findings);
  const auto has = [&](std::string_view fault) {
    return std::ranges::find(findings, fault, &Finding::fault) != findings.end();
  };
  const bool has_depth_fault = has("depth_scale") || has("eight_bit_depth") || has("depth_time");
  if (has_camera && !has_depth_fault) inspection::add_pose_faults(measured, findings);
  return findings;
}

std::vector<std::string> list_facts(const SequenceMeasurements& measured) {
  std::vector<std::string> facts;
  constexpr double kStill_px = 1.5;
  if (!measured.pairs.empty() && measured.pair_shift_px < kStill_px * measured.pixel_scale())
    facts.push_back(fmt::format("the camera does not move (views differ by {:.1f} px)", measured.pair_shift_px));
  if (measured.num_views > 1 && !measured.pairs.empty() && !measured.poses)
    facts.emplace_back("the sequence has no poses; give --poses, or use resight track");
  return facts;
}

std::vector<std::string> list_unmeasured(const SequenceMeasurements& measured, bool knows_sizes) {
  std::vector<std::string> unmeasured;
  if (const auto why = inspection::why_unit_is_unmeasured(measured); why && !knows_sizes)
    unmeasured.push_back(fmt::format("a unit of the depth that is off by less than ten ({})", *why));
  if (measured.pairs.size() < inspection::kMinComparedPairs)
    unmeasured.push_back(
        fmt::format("intrinsics, {}and the time of the depth ({})", measured.has_poses ? "poses " : "",
                    measured.num_other_views > 0
                        ? fmt::format("{} of {} inspected views have other intrinsics than the first",
                                      measured.num_other_views, measured.views.size())
                        : fmt::format("{} of {} pairs of views could be matched, at least {} are needed",
                                      measured.pairs.size(), measured.num_tried_pairs, inspection::kMinComparedPairs)));
  else if (const auto why = inspection::why_intrinsics_are_unmeasured(measured))
    unmeasured.push_back(fmt::format("intrinsics ({})", *why));
  if (const auto why = inspection::why_poses_are_unmeasured(measured))
    unmeasured.push_back(fmt::format("poses ({})", *why));
  if (!all_shifts(measured).peak())
    unmeasured.emplace_back("the registration of depth to colour (the depth has too few contours)");
  return unmeasured;
}

}  // namespace resight
