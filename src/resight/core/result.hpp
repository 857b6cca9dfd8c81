// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <variant>

namespace resight {

/// The reason why an operation on the outside world (file, format, data set) failed. One line for the user that names
/// the file, the defect and what was expected.
struct Error {
  std::string message;
};

/// A value or an error. For mistakes in files and formats; a mistake of the caller throws (check.hpp).
template <typename T>
class [[nodiscard]] Result {
 public:
  Result(T value) : content_(std::move(value)) {}      // NOLINT(google-explicit-constructor)
  Result(Error error) : content_(std::move(error)) {}  // NOLINT(google-explicit-constructor)

  [[nodiscard]] bool ok() const { return std::holds_alternative<T>(content_); }
  explicit operator bool() const { return ok(); }

  /// The value. Throws std::logic_error with the message if there is none; call ok() first.
  [[nodiscard]] const T& value() const& {
    return ok() ? std::get<T>(content_) : (throw_error(), std::get<T>(content_));
  }
  [[nodiscard]] T& value() & { return ok() ? std::get<T>(content_) : (throw_error(), std::get<T>(content_)); }
  [[nodiscard]] T&& value() && {
    if (!ok()) throw_error();
    return std::move(std::get<T>(content_));
  }
  const T& operator*() const& { return value(); }
  T& operator*() & { return value(); }
  T&& operator*() && { return std::move(*this).value(); }
  const T* operator->() const { return &value(); }
  T* operator->() { return &value(); }

  /// The error. May be called only if !ok().
  [[nodiscard]] const Error& error() const { return std::get<Error>(content_); }

 private:
  void throw_error() const { throw std::logic_error("Result has no value: " + error().message); }
  std::variant<T, Error> content_;
};

/// Success without a value, or an error.
template <>
class [[nodiscard]] Result<void> {
 public:
  Result() = default;
  Result(Error error) : error_(std::move(error)) {}  // NOLINT(google-explicit-constructor)
  [[nodiscard]] bool ok() const { return !error_.has_value(); }
  explicit operator bool() const { return ok(); }
  [[nodiscard]] const Error& error() const { return error_.value(); }

 private:
  std::optional<Error> error_;
};

}  // namespace resight
