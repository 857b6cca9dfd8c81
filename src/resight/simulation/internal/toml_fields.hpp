// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <toml++/toml.h>

#include <array>
#include <cmath>
#include <functional>
#include <optional>
#include <set>
#include <span>
#include <string>

#include "resight/core/options.hpp"
#include "resight/core/result.hpp"

namespace resight {

/// Largest number of a scene script, whatever its unit: products of a few are finite, also in single precision.
inline constexpr double kMaxNumber = 1e6;
inline constexpr const char* kNumberLimits = "must lie between -1000000 and 1000000";

/// Reads the fields of one TOML table. Keeps the first mistake with its place and rule; later reads then leave their
/// targets unchanged. Unread keys are also mistakes (finish()).
class TomlFields {
 public:
  /// `where` names the table in messages ("object[2]"). `error` receives the first mistake.
  TomlFields(const toml::table& table, std::string where, std::optional<Error>& error)
      : table_(table), where_(std::move(where)), error_(error) {}

  [[nodiscard]] bool has(std::string_view key) const { return table_.contains(key); }
  /// Records a mistake of this table unless there is an earlier one.
  void fail(const std::string& key, const std::string& what) {
    if (!error_) error_ = Error{(where_.empty() ? "" : where_ + ".") + key + ": " + what};
  }

  /// Read a value of the type of the target; a missing key leaves the target unchanged.
  void read(const std::string& key, double& target);
  void read(const std::string& key, int& target);
  void read(const std::string& key, std::uint64_t& target);  ///< A seed: >= 0.
  void read(const std::string& key, bool& target);
  void read(const std::string& key, std::string& target);
  void read(const std::string& key, std::optional<double>& target);
  /// Reads exactly N numbers.
  template <std::size_t N>
  [[nodiscard]] std::optional<std::array<double, N>> read_numbers(const std::string& key);
  void require_key(const std::string& key) {
    if (!has(key)) fail(key, "is missing");
  }

  /// Calls body(fields) for the sub-table if it exists.
  void table(const std::string& key, const std::function<void(TomlFields&)>& body);
  /// Calls body(fields) for each table of the array [[key]] if it exists.
  void tables(const std::string& key, const std::function<void(TomlFields&)>& body);
  /// Reads declared options from this table, or from the sub-table if it exists.
  template <typename Options>
  void options(Options& target) {
    read_options(list_options(target), 0);
  }
  template <typename Options>
  void options(const std::string& key, Options& target) {
    table(key, [&](TomlFields& fields) { fields.options(target); });
  }
  /// Must be called after all reads.
  void finish();

 private:
  const toml::node* find(const std::string& key);
  void read_options(std::span<const Option> options, std::size_t prefix_length);
  void read_option(const std::string& key, const OptionPointer& target);
  const toml::table& table_;
  std::string where_;
  std::optional<Error>& error_;
  std::set<std::string, std::less<>> known_;
};

template <std::size_t N>
std::optional<std::array<double, N>> TomlFields::read_numbers(const std::string& key) {
  const toml::node* node = find(key);
  if (node == nullptr) return std::nullopt;
  const toml::array* list = node->as_array();
  std::array<double, N> numbers{};
  bool good = list != nullptr && list->size() == N;
  for (std::size_t i = 0; good && i < N; ++i) {
    const auto number = list->get(i)->value<double>();
    good = number && std::isfinite(*number);
    if (good) numbers[i] = *number;
    if (good && std::abs(*number) > kMaxNumber) {
      fail(key, kNumberLimits);
      return std::nullopt;
    }
  }
  if (good) return numbers;
  fail(key, "must be a list of " + std::to_string(N) + " numbers");
  return std::nullopt;
}

}  // namespace resight
