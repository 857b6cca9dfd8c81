// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "resight/registration/depth_bias.hpp"
#include "resight/sensor/color_offset.hpp"
#include "resight/sensor/prepared_view.hpp"
#include "resight/sensor/sequence.hpp"

namespace resight {

/// measure_camera_errors() takes as many views, spread over the sequence.
inline constexpr int kMaxCalibrationViews = 12;

/// Errors of a calibration that views show by themselves. Zero corrects nothing.
struct CameraErrors {
  ColorOffset color_offset;
  DepthBias depth_bias;
};

/// Measures the errors in up to kMaxCalibrationViews views of a sequence, those that their options correct; views that
/// cannot be read do not count. The bias is measured in views without the offset. If all given poses are equal, there
/// is no bias: a camera that stands still shows nothing.
[[nodiscard]] CameraErrors measure_camera_errors(const Sequence& sequence, const PrepareViewOptions& prepare,
                                                 const ColorOffsetOptions& color_offset,
                                                 const DepthBiasOptions& depth_bias);

/// prepare_view() of a frame without the errors of its camera.
[[nodiscard]] PreparedView prepare_corrected(RgbdFrame frame, const CameraErrors& errors,
                                             const PrepareViewOptions& prepare);

/// Prepares the views of a camera without its errors: those of set(), called before the first view, or the offset of
/// the colours that the views so far show. This offset is kept until the views show one that differs by more than half
/// a pixel.
class CameraErrorCorrector {
 public:
  explicit CameraErrorCorrector(const ColorOffsetOptions& color_offset = {}) : estimator_(color_offset) {}

  void set(const CameraErrors& errors);
  [[nodiscard]] PreparedView prepare(RgbdFrame frame, const PrepareViewOptions& options);
  /// By which the next view will be corrected.
  [[nodiscard]] const CameraErrors& errors() const { return errors_; }
  /// Whether that differs from what the last view was corrected by: their intrinsics do not fit each other.
  [[nodiscard]] bool has_changed() const { return has_changed_; }

 private:
  CameraErrors errors_;
  ColorOffsetEstimator estimator_;
  bool is_set_ = false;
  bool has_changed_ = false;
};

}  // namespace resight
