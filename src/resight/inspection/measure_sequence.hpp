// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "resight/core/result.hpp"
#include "resight/inspection/color_depth_shift.hpp"
#include "resight/inspection/color_values.hpp"
#include "resight/inspection/depth_time.hpp"
#include "resight/inspection/depth_values.hpp"
#include "resight/inspection/motion_fit.hpp"
#include "resight/sensor/sequence.hpp"

namespace resight {

/// One inspected view.
struct ViewMeasurements {
  int view = 0;  ///< Number in the sequence.
  std::string name;
  DepthValues depth;
  double noise_ratio = 0;  ///< measure_noise_ratio().
  ColorValues color;
  std::optional<Eigen::Vector2d> fine_shift_px;  ///< measure_color_offset() of the reduced view, up to 4 px.
};

/// How the poses of a sequence are read.
struct PoseReading {
  bool inverted = false;  ///< They are camera_from_world.
  bool opengl = false;    ///< The camera looks along -z, with y up.
  double views_late = 0;  ///< The pose of view v is that at this many views after it.
};

/// One reading of the poses, tried on the views.
struct TriedReading {
  PoseReading reading;
  GivenPosesFit fit;
};

/// What the given poses say about the views, and what the views say about them.
struct PoseMeasurements {
  GivenPosesFit given;                 ///< As they are.
  std::vector<TriedReading> readings;  ///< All conventions with their best scale; the first one is as given.
  std::vector<TriedReading> shifted;   ///< In steps of a quarter of a view, as far as they reach half of the pairs.
  GivenPosesFit far;                   ///< Of the far pairs, with their best scale.
  bool all_equal = false;              ///< The poses say that the camera does not move.
  double farthest_m = 0;               ///< From the origin of the world.
  double extent_m = 0;
};

/// Everything that is measured on a sequence without models.
struct SequenceMeasurements {
  int num_views = 0;
  Camera camera;  ///< Of the first inspected view.
  std::vector<ViewMeasurements> views;
  /// Large views are reduced by it before colours are compared with contours: shifts are in pixels of reduced views.
  int contour_divisor = 1;
  std::array<ShiftScores, 2> half_shifts;  ///< Of every second view, and of the others.
  double depth_unit_m = 1;      ///< Median depth of the inspected views: the unit of the pairs' translations.
  std::vector<ViewPair> pairs;  ///< Those of neighbouring views that could be matched; of a slow camera, the far pairs.
  int num_tried_pairs = 0;
  int num_other_views = 0;  ///< Inspected ones with other intrinsics than the first; they are not compared.
  bool has_poses = false;
  double pair_error_px = 0;  ///< Median over the pairs of their own errors.
  double pair_shift_px = 0;  ///< Median over the pairs of the distance between matched pixels.
  /// Share of the pairs whose depths mostly agree if the camera stands still, and better than if it moves as the
  /// matches tell. Where the background has no texture, the matches are on what moved before it.
  double still_share = 0;
  std::vector<ViewPair> far_pairs;  ///< Views far apart in the sequence that could be matched, if they are not `pairs`.
  double far_pair_error_px = 0;     ///< Median over the far pairs of their own errors.
  std::optional<DepthTime> depth_time;
  std::optional<IntrinsicsFit> intrinsics;
  std::optional<PoseMeasurements> poses;  ///< None without poses or without matched pairs.
  /// Limits in pixels are those of images 640 px long, times this.
  [[nodiscard]] double pixel_scale() const { return std::max(1.0, std::max(camera.width, camera.height) / 640.0); }
};

struct MeasureSequenceOptions {
  int max_views = 24;  ///< Inspected ones, spread over the sequence; at least 3.
  int num_threads = 1;
};

/// Reads up to max_views views, and measures them and the motion between them. Fails with the error of the first view
/// that cannot be read. Throws std::invalid_argument if max_views is less than 3.
[[nodiscard]] Result<SequenceMeasurements> measure_sequence(const Sequence& sequence,
                                                            const MeasureSequenceOptions& options = {});

}  // namespace resight
