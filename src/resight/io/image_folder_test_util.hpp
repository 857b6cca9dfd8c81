// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <string>

#include "resight/io/images.hpp"
#include "resight/io/internal/test_data.hpp"

/// Folders of images as users have them, for the tests of their reader.
namespace resight::test {

inline constexpr int kWidth = 8;
inline constexpr int kHeight = 6;

/// Writes `count` pairs of images: <folder>/<prefix><number><suffix>.
struct FolderLayout {
  std::string color_folder, color_prefix, color_suffix;
  std::string depth_folder, depth_prefix, depth_suffix;
  int digits = 6;
  int count = 3;
};

inline std::string numbered(const FolderLayout& layout, int number) {
  const std::string digits = std::to_string(number);
  return std::string(static_cast<std::size_t>(layout.digits) - digits.size(), '0') + digits;
}

inline void write_npy(const std::filesystem::path& file, const Image<float>& depth) {
  std::string dictionary = "{'descr': '<f4', 'fortran_order': False, 'shape': (" + std::to_string(depth.height()) +
                           ", " + std::to_string(depth.width()) + "), }";
  dictionary.resize(118, ' ');
  io::write_text(file, std::string("\x93NUMPY\x01\0", 8) + std::string("\x76\0", 2) + dictionary +
                           std::string(reinterpret_cast<const char*>(depth.data().data()), 4 * depth.size()));
}

inline void write_layout(const std::filesystem::path& root, const FolderLayout& layout) {
  for (int i = 0; i < layout.count; ++i) {
    const Image<float> depth(kWidth, kHeight, 1.0F + 0.1F * static_cast<float>(i));
    const auto color_file =
        root / layout.color_folder / (layout.color_prefix + numbered(layout, i) + layout.color_suffix);
    const auto depth_file =
        root / layout.depth_folder / (layout.depth_prefix + numbered(layout, i) + layout.depth_suffix);
    ASSERT_TRUE(write_color(color_file, Image<Rgb8>(kWidth, kHeight, Rgb8{90, 120, 200})).ok());
    if (depth_file.extension() == ".npy")
      write_npy(depth_file, depth);
    else
      ASSERT_TRUE(write_depth(depth_file, depth, 0.001).ok());
  }
}

inline const std::string kMatrix = "60 0 3.5\n0 61 2.5\n0 0 1\n";

/// Layouts that users have.
inline const FolderLayout kTwoFolders{"color", "", ".jpg", "depth", "", ".png", 6, 3};
inline const FolderLayout kSevenScenes{"", "frame-", ".color.png", "", "frame-", ".depth.png", 6, 3};
inline const FolderLayout kOneFolder{"", "color_", ".jpg", "", "depth_", ".png", 1, 3};
inline const FolderLayout kNumpy{"rgb", "img", ".png", "depth", "img", ".npy", 4, 3};
inline const FolderLayout kReplica{"results", "frame", ".jpg", "results", "depth", ".png", 6, 3};
inline const FolderLayout kWithSize{"", "c", "_640x480.png", "", "d", "_16.png", 3, 3};
inline const FolderLayout kUnnamedFolders{"a", "", ".png", "b", "", ".png", 3, 3};

}  // namespace resight::test
