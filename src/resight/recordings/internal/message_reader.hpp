// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>

#include "resight/recordings/recording.hpp"

namespace resight::recordings {

/// Reads the fields of a message one by one, packed (ROS 1) or aligned (CDR). After a read beyond the end, ok() is
/// false and all values are zero or empty.
class MessageReader {
 public:
  MessageReader(std::string_view bytes, MessageLayout layout) : bytes_(bytes), is_cdr_(layout == MessageLayout::kCdr) {
    if (layout == MessageLayout::kOther) ok_ = false;
    if (!is_cdr_) return;
    if (bytes.size() < 4 || bytes[0] != 0 || (bytes[1] & ~1) != 0) {
      ok_ = false;
      return;
    }
    is_swapped_ = bytes[1] == 0;  // big-endian
    bytes_.remove_prefix(4);
  }

  template <typename T>
  T value() {
    static_assert(std::is_arithmetic_v<T>);
    if (is_cdr_) at_ = (at_ + sizeof(T) - 1) / sizeof(T) * sizeof(T);
    char raw[sizeof(T)] = {};
    if (!has(sizeof(T))) return T{};
    std::memcpy(raw, bytes_.data() + at_, sizeof(T));
    if (is_swapped_) std::reverse(raw, raw + sizeof(T));
    at_ += sizeof(T);
    T result;
    std::memcpy(&result, raw, sizeof(T));
    return result;
  }
  std::string text() {
    const auto count = value<std::uint32_t>();
    if (!has(count)) return {};
    std::string_view text = bytes_.substr(at_, count);
    at_ += count;
    if (is_cdr_ && !text.empty()) text.remove_suffix(1);  // its NUL
    return std::string(text);
  }
  /// An array of bytes, behind their number.
  std::string_view blob() {
    const auto count = value<std::uint32_t>();
    if (!has(count)) return {};
    const std::string_view blob = bytes_.substr(at_, count);
    at_ += count;
    return blob;
  }
  [[nodiscard]] bool ok() const { return ok_; }
  [[nodiscard]] bool is_cdr() const { return is_cdr_; }
  [[nodiscard]] std::size_t bytes_left() const { return bytes_.size() - std::min(at_, bytes_.size()); }

 private:
  bool has(std::size_t count) {
    if (!ok_ || at_ > bytes_.size() || count > bytes_.size() - at_) ok_ = false;
    return ok_;
  }
  std::string_view bytes_;
  std::size_t at_ = 0;  ///< CDR aligns relative to the byte behind its 4 first bytes.
  bool is_cdr_;
  bool is_swapped_ = false;
  bool ok_ = true;
};

}  // namespace resight::recordings
