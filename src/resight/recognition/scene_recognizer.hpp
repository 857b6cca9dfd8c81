// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <vector>

#include "resight/core/deadline.hpp"
#include "resight/models/object_model.hpp"
#include "resight/recognition/recognition_trace.hpp"
#include "resight/recognition/recognizer_config.hpp"
#include "resight/recognition/scene_update.hpp"
#include "resight/recognition/view_hypotheses.hpp"

namespace resight {

/// Recognises objects and changes view by view: the one class that sequences all stages (paper, Algorithm 1 and
/// Sec. III).
///
///     SceneRecognizer recognizer(library, RecognizerConfig::from_preset("default"));
///     recognize_sequence(recognizer, sequence, on_view);  // or add_view() for each frame, then finish()
///
/// Keeps the last K + 1 views; its memory does not grow with the length of the sequence. Not thread-safe; it uses
/// threads itself.
class SceneRecognizer {
 public:
  /// The library must outlive the recogniser. Throws std::invalid_argument for a config that fails check(). `store`:
  /// shared with other recognisers of the same sequence (see ViewHypothesisStore); null = on its own. `clock`: for
  /// run.deadline_ms.
  SceneRecognizer(const ModelLibrary& library, RecognizerConfig config,
                  std::shared_ptr<ViewHypothesisStore> store = nullptr, Clock clock = steady_clock_s);
  ~SceneRecognizer();
  SceneRecognizer(SceneRecognizer&&) noexcept;

  /// Errors of the camera, which add_view() corrects. Call it before the first view. Otherwise, add_view() estimates
  /// the offset of the colours from the views so far.
  void set_camera_errors(const CameraErrors& errors);
  /// Recognises the scene at this view. Views in time order; poses in one world frame. Throws std::invalid_argument for
  /// a frame that fails check_frame(); the recogniser is then unchanged. `trace`: filled with the intermediate results
  /// of the stages, unless null.
  SceneUpdate add_view(RgbdFrame frame, RecognitionTrace* trace = nullptr);
  /// Events that were waiting for a further view; call once after the last view.
  std::vector<ObjectEvent> finish();

  [[nodiscard]] const RecognizerConfig& config() const;
  /// Psi_k: the scene as reconstructed from the window, world frame.
  [[nodiscard]] const PointCloud& reconstruction() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace resight
