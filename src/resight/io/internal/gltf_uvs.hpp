// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "resight/core/result.hpp"

namespace resight::io {

/// The content of the file that a mesh calls `name`; empty if it cannot be read.
using FindFile = std::function<std::shared_ptr<const std::string>(const std::string& name)>;

/// Type of the numbers of an accessor.
struct GltfNumberType {
  int number;  ///< In the file.
  std::int64_t bytes;
};
inline constexpr GltfNumberType kGltfUint8{5121, 1};
inline constexpr GltfNumberType kGltfUint16{5123, 2};
inline constexpr GltfNumberType kGltfUint32{5125, 4};
inline constexpr GltfNumberType kGltfFloat{5126, 4};

/// Where texture coordinates lie in a buffer.
struct GltfUvSource {
  GltfNumberType type = kGltfFloat;
  std::size_t buffer = 0;
  std::int64_t begin = 0;  ///< Bytes.
  std::int64_t stride = 0;
  std::int64_t num = 0;
};

/// Converts texture coordinates to floats without a transform, because Assimp reads no others.
class GltfUvs {
 public:
  /// `binary`: the part of a GLB file that is its first buffer; empty for a text file.
  GltfUvs(const nlohmann::json& document, std::string_view binary, FindFile find)
      : document_(document), binary_(binary), find_(std::move(find)) {}

  /// Appends to converted(), pairs of floats. Whole numbers are shares of the largest one. `transform`: as
  /// KHR_texture_transform has it, or null. Fails if the source ends beyond its buffer or the transform is damaged.
  [[nodiscard]] Result<void> convert(const GltfUvSource& source, const nlohmann::json& transform);

  [[nodiscard]] std::string_view binary() const { return binary_; }
  [[nodiscard]] std::string& converted() { return converted_; }

 private:
  [[nodiscard]] std::string_view buffer(std::size_t index);

  const nlohmann::json& document_;
  std::string_view binary_;
  FindFile find_;
  std::map<std::size_t, std::shared_ptr<const std::string>> buffers_;
  std::string converted_;
};

}  // namespace resight::io
