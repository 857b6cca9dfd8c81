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
  if (value && std::isfinite(*value)) {
    target = *value;
  } else {
    fail(key, "must be a finite number");
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

void TomlFields::finish() {
  for (const auto& [key, node] : table_)
    if (!known_.contains(key.str())) fail(std::string(key.str()), "is not a known key");
}

}  // namespace resight
