// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "resight/core/image.hpp"
#include "resight/models/object_model.hpp"
#include "resight/recognition/scene_update.hpp"
#include "resight/sensor/rgbd_frame.hpp"
#include "resight/sensor/sequence.hpp"

namespace resight {

/// Verdict of the ground truth on a detection. It determines how the detection is drawn.
enum class DetectionMark : std::uint8_t {
  kUnjudged,       ///< No ground truth: solid outline.
  kCorrect,        ///< Solid outline.
  kFalsePositive,  ///< Dashed outline, "false" in the label.
  /// Dashed outline and a cross, "ghost" in the label: the object has left this place.
  kGhost,
  /// Matches ground truth that is too occluded to count, or lies outside the image: thin outline.
  kIgnored,
};
/// Text of a mark, as in detections.json and the report.
[[nodiscard]] std::string to_string(DetectionMark mark);

struct DrawOverlayOptions {
  bool show_detections = true;
  bool show_changes = true;  ///< Novel pixels green, removed points red.
  bool show_labels = true;
  double change_opacity = 0.55;  ///< Of the two colours, in [0, 1].
  double outline_px = 2.0;
  void check() const;  ///< Throws std::invalid_argument: field, value, rule.
};

/// Outline colour of an object by its library index. Differs from the red and green of the changes.
[[nodiscard]] Rgb8 object_color(int object);

/// Draws detections and changes into the colour image of a view: outline and name of each detected object, removed
/// points in red, novel pixels in green. The outline is that of the whole projected surface, including occluded parts,
/// so that the pose can be judged. Points behind the camera are skipped. The camera pose is the corrected one of
/// `update`. `marks`: one per detection, or empty (kUnjudged). `missed`: ground truth that was not found, with white
/// dotted outlines. Throws std::invalid_argument if the frame is invalid or a detection's object is not in the library.
[[nodiscard]] Image<Rgb8> draw_overlay(const RgbdFrame& frame, const ModelLibrary& library, const SceneUpdate& update,
                                       std::span<const DetectionMark> marks = {},
                                       std::span<const GroundTruthObject> missed = {},
                                       const DrawOverlayOptions& options = {});

/// Draws the changes only, on the view in grey: removed points red, novel pixels green. Needs no models.
[[nodiscard]] Image<Rgb8> draw_changes(const RgbdFrame& frame, const ChangeResult& changes,
                                       const DrawOverlayOptions& options = {});

/// Encodes the picture as a JPEG file in memory. `quality`: 1 to 100. Pictures wider than `max_width_px` are shrunk; 0
/// = any width.
[[nodiscard]] std::vector<std::uint8_t> encode_jpeg(const Image<Rgb8>& picture, int quality = 85, int max_width_px = 0);

}  // namespace resight
