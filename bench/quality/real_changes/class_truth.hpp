// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "components.hpp"
#include "resight/core/result.hpp"
#include "resight/sensor/rgbd_frame.hpp"

namespace resight::bench {

/// Class of each pixel as 0xrrggbb; 0 is the background.
using ClassImage = Image<std::int32_t>;

/// Reads a class mask: grey values, or the colours of a palette.
[[nodiscard]] Result<ClassImage> read_classes(const std::filesystem::path& file);

/// A view of a still camera with its classes.
struct LabelledView {
  RgbdFrame frame;
  ClassImage classes;
};

/// The two sides of a change, as indices.
enum Side : std::uint8_t { kAdded, kRemoved };
inline constexpr std::array<Side, 2> kSides{kAdded, kRemoved};
[[nodiscard]] constexpr const char* to_string(Side side) { return side == kAdded ? "added" : "removed"; }

enum class TruthPixel : std::uint8_t { kIgnored, kUnchanged, kChanged };

/// An object that was added or removed: connected changed pixels of one class.
struct ChangedObject {
  Region pixels;      ///< Those that count.
  double rise_m = 0;  ///< Median height above the depth of the other view.
};

/// What was added, or removed, between two views.
struct SideTruth {
  Image<TruthPixel> pixels;
  std::vector<ChangedObject> objects;
};

/// What class masks and depth say about the changes between two views.
struct ChangeTruth {
  std::array<SideTruth, 2> sides;         ///< By Side.
  std::vector<Region> unchanged_objects;  ///< Pixels that count.
  /// Pixels of one class before and after, but of no unchanged object: the object moved across itself, or was replaced
  /// by another of its class. The sides call them unchanged, although their depth may have changed.
  Mask same_class;
};

/// The truth between two neighbouring views of a still camera. A pixel changed where its class did: added if its class
/// now is not the background, removed if its class before was not. Where one object replaced another, the nearer one
/// counts and the other is ignored, because depth can show only that one. Also ignored are pixels without depth in
/// either view, a band of 2 px along the borders of the classes of both views, and objects that rise by less than 5 mm
/// above the depth of the other view. An object is unchanged if its pixels in both views overlap by more than 0.9
/// (intersection over union).
[[nodiscard]] ChangeTruth find_change_truth(const LabelledView& before, const LabelledView& after);

}  // namespace resight::bench
