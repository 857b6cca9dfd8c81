// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <string_view>

namespace resight::recordings {

static_assert(std::endian::native == std::endian::little, "the readers assume a little-endian machine");

/// Reads little-endian values one by one. After a read beyond the end, ok() is false and all values are zero or empty.
class ByteReader {
 public:
  explicit ByteReader(std::string_view bytes) : rest_(bytes) {}

  template <typename T>
  T value() {
    T result{};
    const std::string_view bytes = take(sizeof(T));
    if (ok_) std::memcpy(&result, bytes.data(), sizeof(T));
    return result;
  }
  std::string_view take(std::uint64_t count) {
    if (!ok_ || count > rest_.size()) {
      ok_ = false;
      return {};
    }
    const std::string_view bytes = rest_.substr(0, count);
    rest_.remove_prefix(count);
    return bytes;
  }
  /// Bytes behind their number.
  template <typename Count>
  std::string_view counted() {
    const auto count = value<Count>();
    return take(count);
  }
  [[nodiscard]] bool ok() const { return ok_; }
  [[nodiscard]] bool at_end() const { return rest_.empty(); }
  [[nodiscard]] std::string_view rest() const { return rest_; }

 private:
  std::string_view rest_;
  bool ok_ = true;
};

}  // namespace resight::recordings
