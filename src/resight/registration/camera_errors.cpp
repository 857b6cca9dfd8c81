// SPDX-License-Identifier: Apache-2.0
#include "resight/registration/camera_errors.hpp"

#include <algorithm>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "resight/sensor/reduce_frame.hpp"

namespace resight {
namespace {

std::vector<int> spread_views(int num_views) {
  const int count = std::min(num_views, kMaxCalibrationViews);
  std::vector<int> views;
  for (int k = 0; k < count; ++k) views.push_back(count > 1 ? k * (num_views - 1) / (count - 1) : 0);
  return views;
}

// By the given poses. Poses that cannot be read are no evidence.
bool stands_still(const Sequence& sequence, std::span<const int> views) {
  std::optional<Rigid3> first;
  for (const int v : views) {
    const Result<Rigid3> pose = sequence.read_pose(v);
    if (!pose) continue;
    if (first && first->matrix() != pose->matrix()) return false;
    first = *pose;
  }
  return true;
}

// prepare_view() refuses a frame that is not sound.
RgbdFrame reduce(RgbdFrame frame, const PrepareViewOptions& prepare) {
  if (!check_frame(frame)) return frame;
  const int divisor = find_reduction(frame.camera, prepare);
  return divisor > 1 ? reduce_frame(frame, divisor) : std::move(frame);
}

// Reduced at once, because all are kept.
std::vector<RgbdFrame> read_views(const Sequence& sequence, std::span<const int> numbers,
                                  const PrepareViewOptions& prepare) {
  std::vector<RgbdFrame> frames;
  for (const int v : numbers)
    if (Result<RgbdFrame> frame = sequence.read_view(v)) frames.push_back(reduce(*std::move(frame), prepare));
  return frames;
}

}  // namespace

CameraErrors measure_camera_errors(const Sequence& sequence, const PrepareViewOptions& prepare,
                                   const ColorOffsetOptions& color_offset, const DepthBiasOptions& depth_bias) {
  CameraErrors errors;
  const std::vector<int> numbers = spread_views(sequence.num_views());
  const bool shows_bias = depth_bias.correct && !stands_still(sequence, numbers);
  if (!color_offset.correct && !shows_bias) return errors;
  ColorOffsetEstimator colors(color_offset);
  const std::vector<RgbdFrame> frames = read_views(sequence, numbers, prepare);
  std::vector<AlignmentView> aligned;
  const auto align_views = [&] {
    aligned.clear();
    for (const RgbdFrame& frame : frames) {
      const PreparedView view = prepare_corrected(frame, errors, prepare);
      if (errors.color_offset.num_views == 0) colors.add(view);
      if (shows_bias) aligned.push_back(make_alignment_view(view));
    }
  };
  align_views();
  errors.color_offset = colors.offset();
  if (!shows_bias) return errors;
  // Only a correction moves the views.
  if (!errors.color_offset.corrected_px().isZero()) align_views();
  std::vector<AlignmentTarget> views;
  for (std::size_t i = 0; i < frames.size(); ++i)
    if (!aligned[i].levels.empty()) views.push_back({&aligned[i], frames[i].world_from_camera});
  errors.depth_bias = estimate_depth_bias(views, depth_bias);
  return errors;
}

PreparedView prepare_corrected(RgbdFrame frame, const CameraErrors& errors, const PrepareViewOptions& prepare) {
  if (check_frame(frame)) {  // Before the correction, which takes away depth that is not sound.
    correct_depth(errors.depth_bias, frame);
    frame = reduce(std::move(frame), prepare);
    correct_color_offset(errors.color_offset, frame);
  }
  return prepare_view(std::move(frame), prepare);
}

void CameraErrorCorrector::set(const CameraErrors& errors) {
  errors_ = errors;
  is_set_ = true;
}

PreparedView CameraErrorCorrector::prepare(RgbdFrame frame, const PrepareViewOptions& options) {
  PreparedView view = prepare_corrected(std::move(frame), errors_, options);
  if (!is_set_) {
    constexpr double kMinChange_px = 0.5;
    estimator_.add(view, errors_.color_offset);
    const ColorOffset offset = estimator_.offset();
    const Eigen::Vector2d change_px = offset.corrected_px() - errors_.color_offset.corrected_px();
    has_changed_ = change_px.cwiseAbs().maxCoeff() > kMinChange_px;
    const bool corrects_nothing = offset.corrected_px().isZero() && errors_.color_offset.corrected_px().isZero();
    if (has_changed_ || corrects_nothing) errors_.color_offset = offset;
  }
  return view;
}

}  // namespace resight
