// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <string>
#include <utility>

#include "resight/core/files.hpp"
#include "resight/core/names.hpp"
#include "resight/io/internal/json.hpp"
#include "resight/io/pose_text.hpp"

namespace resight::io {

/// The first thing that is wrong in a file. Readers go on with defaults after it.
class Faults {
 public:
  explicit Faults(std::filesystem::path file) : file_(std::move(file)) {}
  void add(const std::string& where, const std::string& what) {
    if (!first_) first_ = file_error(file_, where + ": " + what);
  }
  [[nodiscard]] const std::optional<Error>& first() const { return first_; }

 private:
  std::filesystem::path file_;
  std::optional<Error> first_;
};

/// Reads the members of one object of a file. `where` names the object in messages.
class MemberReader {
 public:
  MemberReader(const nlohmann::json& object, std::string where, Faults& faults)
      : object_(object), where_(std::move(where)), faults_(faults) {}

  [[nodiscard]] int integer(const char* key) const {
    const auto value = as_integer(member(object_, key));
    if (!value) fault(key, "expected a whole number");
    return value.value_or(0);
  }
  [[nodiscard]] int count(const char* key) const {
    const int value = integer(key);
    if (value < 0) fault(key, "expected a number of 0 or more");
    return std::max(0, value);
  }
  [[nodiscard]] bool flag(const char* key) const {
    const nlohmann::json& value = member(object_, key);
    if (!value.is_boolean()) fault(key, "expected true or false");
    return value.is_boolean() && value.get<bool>();
  }
  /// In [0, 1]; null is NaN.
  [[nodiscard]] double share(const char* key) const {
    const nlohmann::json& value = member(object_, key);
    if (value.is_null() && object_.contains(key)) return std::numeric_limits<double>::quiet_NaN();
    const auto number = as_number(value);
    if (!number || *number < 0 || *number > 1) fault(key, "expected a number in [0, 1]");
    return number.value_or(0);
  }
  /// Finite; null is NaN.
  [[nodiscard]] double number(const char* key) const {
    const nlohmann::json& value = member(object_, key);
    if (value.is_null() && object_.contains(key)) return std::numeric_limits<double>::quiet_NaN();
    const auto number = as_number(value);
    if (!number) fault(key, "expected a number");
    return number.value_or(0);
  }
  /// A whole number from 0 to below `count`; null is -1.
  [[nodiscard]] int optional_index(const char* key, int count) const {
    if (member(object_, key).is_null()) return -1;
    const int value = integer(key);
    if (value >= 0 && value < count) return value;
    fault(key, "is out of range");
    return -1;
  }
  [[nodiscard]] std::string text(const char* key) const {
    const auto value = as_text(member(object_, key));
    if (!value) fault(key, "expected a text");
    return value.value_or("");
  }
  /// Name of an object.
  [[nodiscard]] std::string name(const char* key) const {
    const std::string value = text(key);
    if (const auto valid = check_object_name(value); !valid) fault(key, valid.error().message);
    return value;
  }
  [[nodiscard]] Rigid3 pose(const char* key) const {
    const nlohmann::json& value = member(object_, key);
    const auto r = as_numbers(member(value, "rotation"));
    const auto t = as_numbers(member(value, "translation_m"));
    if (!r || r->size() != 9 || !t || t->size() != 3) {
      fault(key, "expected a rotation of 9 numbers and a translation_m of 3");
      return {};
    }
    Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column) matrix(row, column) = (*r)[3 * row + column];
      matrix(row, 3) = (*t)[row];
    }
    const auto pose = rigid_from_matrix(matrix, key);
    if (!pose) faults_.add(where_, pose.error().message);
    return pose ? *pose : Rigid3();
  }
  [[nodiscard]] std::optional<Rigid3> optional_pose(const char* key) const {
    if (member(object_, key).is_null()) return std::nullopt;
    return pose(key);
  }
  /// Calls `read` with the object under a key.
  template <typename Read>
  void object(const char* key, const Read& read) const {
    read(MemberReader(member(object_, key), prefix() + key, faults_));
  }
  /// Calls `read` with each element of an array and its place.
  template <typename Read>
  void each(const char* key, const Read& read) const {
    const nlohmann::json& items = member(object_, key);
    if (!items.is_array()) fault(key, "expected a list");
    int index = 0;
    if (items.is_array())
      for (const nlohmann::json& item : items)
        read(MemberReader(item, fmt::format("{}{}[{}]", prefix(), key, index++), faults_));
  }
  [[nodiscard]] const nlohmann::json& operator[](const char* key) const { return member(object_, key); }
  void fault(const char* key, const std::string& what) const { faults_.add(prefix() + key, what); }

 private:
  [[nodiscard]] std::string prefix() const { return where_.empty() ? "" : where_ + "."; }
  const nlohmann::json& object_;
  std::string where_;
  Faults& faults_;
};

}  // namespace resight::io
