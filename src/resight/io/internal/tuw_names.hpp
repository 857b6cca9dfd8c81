// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>
#include <string_view>

namespace resight::io {

/// The name of a view without leading zeros of its numbers: "cloud_003" and "cloud_03" are the same view.
[[nodiscard]] std::string normalized_view(std::string_view name);

/// `<object>_<instance>`. The name of the object may contain underscores.
struct ObjectInstance {
  std::string object;
  int instance = 0;
};
[[nodiscard]] std::optional<ObjectInstance> split_object_instance(std::string_view text);

/// `<view>_<object>_<instance>` for an unknown view name. The view name ends with the first run of digits (`cloud_03`,
/// `00003`).
struct AnnotationName {
  std::string view;
  int view_number = 0;
  ObjectInstance what;
};
[[nodiscard]] std::optional<AnnotationName> split_annotation_name(std::string_view stem);

}  // namespace resight::io
