// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "resight/io/internal/calibration.hpp"
#include "resight/io/sequence.hpp"

namespace resight::io {

/// Encoding of depth images.
enum class DepthStorage {
  kPng,         ///< 16-bit PNG.
  kRotatedPng,  ///< 16-bit PNG, each value rotated right by 3 bits.
  kByName,  ///< A number array (npy, npz, exr) or kPng by the extension; the largest 16-bit value is no return, too.
};

/// A depth camera beside the colour camera.
struct DepthCamera {
  Calibration calibration;
  Rigid3 color_from_depth;
};

/// A view without its images; everything else is already known.
struct ListedView {
  std::string name;
  int image_id = 0;
  std::filesystem::path color;
  std::filesystem::path depth;
  Intrinsics intrinsics;
  std::optional<Calibration> own_camera;  ///< With its lens and image size, if the views have several.
  double metres_per_unit = 0.001;         ///< Unit of a depth image of whole numbers.
  double time_s = std::numeric_limits<double>::quiet_NaN();  ///< Of the depth image; NaN if unknown.
  Rigid3 world_from_camera;
  std::vector<GroundTruthObject> ground_truth;
};

/// All views of a sequence with its common properties.
struct SequenceTable {
  std::string format;
  int scene_id = 0;
  bool has_poses = true;
  bool has_ground_truth = false;
  bool is_recording = false;           ///< The table only lists times and poses.
  bool poses_tell_convention = false;  ///< The format of their file defines it.
  DepthStorage depth_storage = DepthStorage::kPng;
  std::optional<double> npy_unit_m;  ///< Unit of number arrays. Otherwise metres, and whole numbers are refused.
  LensDistortion lens;  ///< Of both images, except in views with own_camera. Views that are read have no distortion.
  std::optional<DepthCamera> depth_camera;  ///< None: the depth is registered to the colours.
  bool may_enlarge_depth = false;           ///< Registered depth may have fewer pixels than the colours.
  std::vector<ListedView> views;
  std::vector<std::string> notes;
};

/// A sequence of separate colour and depth images, which all formats except TUW use.
[[nodiscard]] std::unique_ptr<Sequence> make_listed_sequence(SequenceTable table);

/// The table of such a sequence; null for another one.
[[nodiscard]] SequenceTable* listed_table(Sequence& sequence);

/// Sets the poses of views from a file: by the name of the view, by its time, or by its place in the order. Views
/// without a pose are left out, with a note.
[[nodiscard]] Result<void> assign_poses(SequenceTable& table, const std::filesystem::path& file);

/// check_calibration() for the size that the header of an image names.
[[nodiscard]] Result<void> check_image_size(const Calibration& calibration, const std::filesystem::path& image,
                                            std::string_view what);

/// A note for the user, if the depth of the first view has fewer pixels than its colours. Empty otherwise.
[[nodiscard]] std::string describe_enlarged_depth(const SequenceTable& table);

/// The pose of a camera that looks along z and has y down, from a pose of this convention.
[[nodiscard]] Rigid3 to_world_from_camera(const Rigid3& pose, PoseConvention convention);

/// Sets the depth camera that the options give, if they do.
[[nodiscard]] Result<void> set_depth_camera(SequenceTable& table, const OpenSequenceOptions& options);

/// Replaces what the options give: intrinsics, unit of depth, poses, and the choice of views. Fails for a sequence that
/// make_listed_sequence() has not made, if the options give anything.
[[nodiscard]] Result<void> apply_options(Sequence& sequence, const OpenSequenceOptions& options);
[[nodiscard]] Result<void> apply_options(SequenceTable& table, const OpenSequenceOptions& options);

}  // namespace resight::io
