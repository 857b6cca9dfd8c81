// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "resight/core/result.hpp"

namespace resight::io {

/// Encoding of the body.
enum class PlyEncoding { kAscii, kBinaryLittleEndian, kBinaryBigEndian };
/// Type of a value.
enum class PlyType { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat32, kFloat64 };

/// A property of an element: a scalar or a list.
struct PlyProperty {
  std::string name;
  PlyType type = PlyType::kFloat32;  ///< Type of the value, or of each value of a list.
  bool is_list = false;
  PlyType count_type = PlyType::kUint8;  ///< Type of the length of a list.
};

/// An element (vertex, face, ...) with its number of items.
struct PlyElement {
  std::string name;
  std::size_t count = 0;
  std::vector<PlyProperty> properties;
  /// Index of the property with that name, or -1.
  [[nodiscard]] int find(std::string_view property) const;
};

/// A parsed PLY header.
struct PlyHeader {
  PlyEncoding encoding = PlyEncoding::kAscii;
  std::vector<PlyElement> elements;
  std::vector<std::string> texture_files;
  std::size_t body_offset = 0;
};

/// Number of bytes of a value.
[[nodiscard]] std::size_t size_of(PlyType type);

/// Parses the header and checks it against the file size: no element may claim more items than the remaining bytes can
/// contain.
[[nodiscard]] Result<PlyHeader> parse_ply_header(std::string_view bytes, std::string_view name);

/// Reads the values of a body one by one.
class PlyValueReader {
 public:
  PlyValueReader(std::string_view body, PlyEncoding encoding) : rest_(body), encoding_(encoding) {}
  /// Reads the next value. Returns false at the end of the body or if the value is not a number.
  bool next(PlyType type, double& value);
  [[nodiscard]] std::size_t bytes_left() const { return rest_.size(); }

 private:
  std::string_view rest_;
  PlyEncoding encoding_;
};

}  // namespace resight::io
