// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "resight/core/result.hpp"
#include "resight/sensor/depth_sensor.hpp"
#include "resight/sensor/sequence.hpp"

namespace resight {

/// What a camera pose in a file maps to what.
enum class PoseConvention {
  kCameraToWorld,  ///< world_from_camera; camera x right, y down, z forward.
  kWorldToCamera,  ///< camera_from_world.
  kOpenGl,         ///< world_from_camera; camera x right, y up, z backward.
};

/// The views of a sequence that are used.
struct ViewChoice {
  int every = 1;  ///< Takes each n-th view.
  /// Takes a view only if the camera, or what is 1 m in front of it, has moved by this since the last one. 0: any.
  double min_motion_m = 0;
  std::optional<double> from_s;  ///< Seconds since the first view.
  std::optional<double> to_s;    ///< Seconds since the first view.
  std::optional<int> max_views;  ///< The first of those that the other fields leave.
};

/// What a recording contains many of. Empty: found by type and name.
struct RecordingTopics {
  std::string color;
  std::string depth;
  std::string camera_info;              ///< Of the colour camera.
  std::string world_frame;              ///< Poses are in this frame.
  std::string camera_frame;             ///< Frame of the colour camera. Empty: the frame of its images.
  double max_time_difference_s = 0.02;  ///< Between a colour image and its depth image.
  bool operator==(const RecordingTopics&) const = default;
};

/// How to open a sequence that does not say everything itself, or says it wrongly. Everything is optional.
struct OpenSequenceOptions {
  std::string intrinsics;               ///< "fx,fy,cx,cy", distortion coefficients after it, or a file.
  std::string depth_intrinsics;         ///< The same of a depth camera whose depth is not registered to colour.
  std::string color_from_depth;         ///< A file with its pose: 12 or 16 numbers, row by row, metres.
  std::optional<double> depth_scale_m;  ///< Metres per unit of stored depth.
  double depth_bias_per_m = 0;          ///< Is corrected: 1 / z = 1 / measured - depth_bias_per_m.
  std::string poses;                    ///< A file of camera poses, or "fixed": the camera does not move.
  PoseConvention pose_convention = PoseConvention::kCameraToWorld;  ///< Of poses in the folder or in `poses`.
  ViewChoice views;
  RecordingTopics topics;
  /// Whose noise the depth has. Null: as the names in a recording tell, otherwise structured light.
  const DepthSensor* sensor = nullptr;
};

/// The sequences in a data set: `directory` itself if it is one, or those in its sub-folders and in splits of BOP and
/// TUW data sets below it. Scenes for training count only if there are no others. Folders of models are skipped.
[[nodiscard]] std::vector<std::filesystem::path> find_sequence_folders(const std::filesystem::path& directory);

/// The folder that open_sequence() opens: `directory` itself, or the only sequence below it. Empty if there is none.
/// Fails if there are several, or if this cannot be found out.
[[nodiscard]] Result<std::optional<std::filesystem::path>> find_sequence_folder(const std::filesystem::path& directory);

/// Opens a sequence directory or a recording and detects the format from its contents. The error says what was
/// expected.
[[nodiscard]] Result<std::unique_ptr<Sequence>> open_sequence(const std::filesystem::path& directory,
                                                              const OpenSequenceOptions& options = {});

/// Same, for uses that need camera poses. Fails for several views without poses.
[[nodiscard]] Result<std::unique_ptr<Sequence>> open_posed_sequence(const std::filesystem::path& directory,
                                                                    const OpenSequenceOptions& options = {});

/// Writes a sequence view by view. It appears under its final name only with finish().
class SequenceWriter {
 public:
  virtual ~SequenceWriter() = default;
  [[nodiscard]] virtual Result<void> write_view(const RgbdFrame& frame,
                                                const std::vector<GroundTruthObject>& ground_truth) = 0;
  /// Names of the views written so far, as a reader of the new sequence will see them.
  [[nodiscard]] virtual const std::vector<std::string>& view_names() const = 0;
  /// Writes another file into the folder of the sequence.
  [[nodiscard]] virtual Result<void> add_file(const std::string& name, std::string_view bytes) = 0;
  [[nodiscard]] virtual Result<void> finish() = 0;
};
/// Formats that can be written (docs/formats.md).
enum class DatasetFormat { kTuw, kBop };
/// What is known of the views that are written. What is not is left out, and not invented.
struct SequenceContent {
  bool has_poses = true;  ///< TUW cannot leave poses out.
  bool has_ground_truth = true;
};
/// Starts a sequence in `directory`. Fails if the folder exists and is not empty, or cannot be written.
[[nodiscard]] Result<std::unique_ptr<SequenceWriter>> create_sequence(const std::filesystem::path& directory,
                                                                      DatasetFormat format,
                                                                      const SequenceContent& content = {});

}  // namespace resight
