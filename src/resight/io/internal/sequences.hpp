// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <memory>
#include <string>

#include "resight/io/sequence.hpp"

/// Functions that detect and open each format. is_*() look at the names of files, and where these leave it open, at the
/// first bytes of clouds and images and at files of poses.
namespace resight::io {

using SequenceResult = Result<std::unique_ptr<Sequence>>;

[[nodiscard]] bool is_bop_scene(const std::filesystem::path& directory);
[[nodiscard]] SequenceResult open_bop_scene(const std::filesystem::path& directory);

[[nodiscard]] bool is_tum_sequence(const std::filesystem::path& directory);
[[nodiscard]] SequenceResult open_tum_sequence(const std::filesystem::path& directory,
                                               const OpenSequenceOptions& options);

[[nodiscard]] bool is_tuw_sequence(const std::filesystem::path& directory);
[[nodiscard]] SequenceResult open_tuw_sequence(const std::filesystem::path& directory);
/// Opens one organised PCD as a sequence of one view.
[[nodiscard]] SequenceResult open_single_pcd(const std::filesystem::path& file);

[[nodiscard]] bool is_npy_sequence(const std::filesystem::path& directory);
[[nodiscard]] SequenceResult open_npy_sequence(const std::filesystem::path& directory,
                                               const OpenSequenceOptions& options);
[[nodiscard]] bool is_fixed_camera_sequence(const std::filesystem::path& directory);
[[nodiscard]] SequenceResult open_fixed_camera_sequence(const std::filesystem::path& directory,
                                                        const OpenSequenceOptions& options);
[[nodiscard]] bool is_camera_info_sequence(const std::filesystem::path& directory);
[[nodiscard]] SequenceResult open_camera_info_sequence(const std::filesystem::path& directory);
[[nodiscard]] bool is_numbered_cameras_sequence(const std::filesystem::path& directory);
[[nodiscard]] SequenceResult open_numbered_cameras_sequence(const std::filesystem::path& directory);

/// Any other folder of colour and depth images. The error of the second function says what is missing.
[[nodiscard]] bool is_image_folder(const std::filesystem::path& directory);
[[nodiscard]] SequenceResult open_image_folder(const std::filesystem::path& directory,
                                               const OpenSequenceOptions& options);
/// Whether such a folder has camera poses that open_image_folder() reads.
[[nodiscard]] bool holds_poses(const std::filesystem::path& directory);
/// One sentence about the images in a folder that is no sequence. Empty if there are none.
[[nodiscard]] std::string describe_image_folder(const std::filesystem::path& directory);

/// Opens a recording (is_recording()).
[[nodiscard]] SequenceResult open_recording_sequence(const std::filesystem::path& where,
                                                     const OpenSequenceOptions& options);

/// Fails if a view of this name cannot follow the one before it (empty: none) in a TUW sequence. The error does not
/// name the folder.
[[nodiscard]] Result<void> check_tuw_view_name(const std::string& name, const std::string& before);
[[nodiscard]] Result<std::unique_ptr<SequenceWriter>> create_tuw_sequence(const std::filesystem::path& directory);
[[nodiscard]] Result<std::unique_ptr<SequenceWriter>> create_bop_scene(const std::filesystem::path& directory,
                                                                       const SequenceContent& content);

}  // namespace resight::io
