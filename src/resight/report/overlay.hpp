// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "resight/core/image.hpp"
#include "resight/io/sequence.hpp"
#include "resight/models/object_model.hpp"
#include "resight/recognition/scene_update.hpp"
#include "resight/sensor/rgbd_frame.hpp"

namespace resight {

/// What the ground truth says of a detection. It changes how the detection is drawn.
enum class DetectionMark : std::uint8_t {
  kUnjudged,       ///< No ground truth: a solid outline.
  kCorrect,        ///< A solid outline.
  kFalsePositive,  ///< A dashed outline, "false" in the label.
  kGhost,          ///< A dashed outline and a cross, "ghost" in the label: the object has left this place.
  kIgnored,        ///< Of a truth too hidden to count: a thin outline.
};
[[nodiscard]] std::string to_string(DetectionMark mark);

struct DrawOverlayOptions {
  bool show_detections = true;
  bool show_changes = true;  ///< Novel pixels green, removed points red.
  bool show_labels = true;
  double change_opacity = 0.55;  ///< Of the two colours, in [0, 1].
  double outline_px = 2.0;
  void check() const;  ///< Throws std::invalid_argument: field, value, rule.
};

/// Outline colour of an object of the library, by its index. None of them is the red or green of the changes.
[[nodiscard]] Rgb8 object_color(int object);

/// The colour image of the view with what was recognised in it: the outline and the name of each detected object,
/// removed points in red, novel pixels in green. The outline is that of the object's whole projected surface: what
/// hides the object is not taken away from it, so that the pose can be judged. Points behind the camera are left out.
/// `marks`: one per detection, or empty (kUnjudged). `missed`: ground truth that was not found, drawn dotted in white.
/// Throws std::invalid_argument if the frame is not valid or a detection names no object of the library.
[[nodiscard]] Image<Rgb8> draw_overlay(const RgbdFrame& frame, const ModelLibrary& library, const SceneUpdate& update,
                                       std::span<const DetectionMark> marks = {},
                                       std::span<const GroundTruthObject> missed = {},
                                       const DrawOverlayOptions& options = {});

/// The changes alone, on the view in grey: removed points red, novel pixels green. Needs no models.
[[nodiscard]] Image<Rgb8> draw_changes(const RgbdFrame& frame, const ChangeResult& changes,
                                       const DrawOverlayOptions& options = {});

/// The picture as a JPEG file in memory; `quality` 1 to 100. Shrunk (never enlarged) to at most `max_width_px`; 0 = as
/// it is.
[[nodiscard]] std::vector<std::uint8_t> encode_jpeg(const Image<Rgb8>& picture, int quality = 85, int max_width_px = 0);

}  // namespace resight
