// SPDX-License-Identifier: Apache-2.0
#include "resight/simulation/internal/toml_fields.hpp"

#include <limits>

namespace resight {

const toml::node* TomlFields::find(const std::string& key) {
  known_.insert(key);
  return error_ ? nullptr : table_.get(key);
}

void TomlFields::read(const std::string& key, double& target) {
  const toml::node* node = find(key);
  if (node == nullptr) return;
  const auto value = node->is_number() ? node->value<double>() : std::nullopt;
  if (value && std::abs(*value) <= kMaxNumber) {
    target = *value;
  } else {
    fail(key, value && std::isfinite(*value) ? kNumberLimits : "must be a finite number");
  }
}

void TomlFields::read(const std::string& key, std::optional<double>& target) {
  double value = 0;
  if (!has(key)) {
    find(key);
    return;
  }
  read(key, value);
  target = value;
}

void TomlFields::read(const std::string& key, int& target) {
  const toml::node* node = find(key);
  if (node == nullptr) return;
  const auto value = node->is_integer() ? node->value<std::int64_t>() : std::nullopt;
  if (value && *value >= std::numeric_limits<int>::min() && *value <= std::numeric_limits<int>::max()) {
    target = static_cast<int>(*value);
  } else {
    fail(key, "must be a whole number");
  }
}

void TomlFields::read(const std::string& key, std::uint64_t& target) {
  const toml::node* node = find(key);
  if (node == nullptr) return;
  const auto value = node->is_integer() ? node->value<std::int64_t>() : std::nullopt;
  if (value && *value >= 0) {
    target = static_cast<std::uint64_t>(*value);
  } else {
    fail(key, "must be a whole number >= 0");
  }
}

void TomlFields::read(const std::string& key, bool& target) {
  const toml::node* node = find(key);
  if (node == nullptr) return;
  if (const auto value = node->value_exact<bool>()) {
    target = *value;
  } else {
    fail(key, "must be true or false");
  }
}

void TomlFields::read(const std::string& key, std::string& target) {
  const toml::node* node = find(key);
  if (node == nullptr) return;
  if (const auto value = node->value_exact<std::string>()) {
    target = *value;
  } else {
    fail(key, "must be a text in quotes");
  }
}

void TomlFields::table(const std::string& key, const std::function<void(TomlFields&)>& body) {
  const toml::node* node = find(key);
  if (node == nullptr) return;
  const toml::table* sub = node->as_table();
  if (sub == nullptr) return fail(key, "must be a table [" + key + "]");
  TomlFields fields(*sub, where_.empty() ? key : where_ + "." + key, error_);
  body(fields);
  fields.finish();
}

void TomlFields::tables(const std::string& key, const std::function<void(TomlFields&)>& body) {
  const toml::node* node = find(key);
  if (node == nullptr) return;
  const toml::array* list = node->as_array();
  if (list == nullptr) return fail(key, "must be a list of tables [[" + key + "]]");
  for (std::size_t i = 0; i < list->size() && !error_; ++i) {
    const std::string name = key + "[" + std::to_string(i) + "]";
    const toml::table* sub = list->get(i)->as_table();
    if (sub == nullptr) return fail(name, "must be a table");
    TomlFields fields(*sub, where_.empty() ? name : where_ + "." + name, error_);
    body(fields);
    fields.finish();
  }
}

// Options of a nested struct follow each other, and their keys start with its name and a dot.
void TomlFields::read_options(std::span<const Option> options, std::size_t prefix_length) {
  for (std::size_t i = 0; i < options.size(); ++i) {
    const std::string key = options[i].key.substr(prefix_length);
    const std::size_t dot = key.find('.');
    if (dot == std::string::npos) {
      read_option(key, options[i].pointer);
      continue;
    }
    const std::string prefix = options[i].key.substr(0, prefix_length + dot + 1);
    std::size_t end = i;
    while (end < options.size() && options[end].key.starts_with(prefix)) ++end;
    table(key.substr(0, dot), [&](TomlFields& f) { f.read_options(options.subspan(i, end - i), prefix.size()); });
    i = end - 1;
  }
}

void TomlFields::read_option(const std::string& key, const OptionPointer& target) {
  if (auto* const* number = std::get_if<double*>(&target)) return read(key, **number);
  if (auto* const* count = std::get_if<int*>(&target)) return read(key, **count);
  if (auto* const* flag = std::get_if<bool*>(&target)) return read(key, **flag);
  if (auto* const* seed = std::get_if<std::uint64_t*>(&target)) return read(key, **seed);
}

void TomlFields::finish() {
  for (const auto& [key, node] : table_)
    if (!known_.contains(key.str())) fail(std::string(key.str()), "is not a known key");
}

}  // namespace resight
