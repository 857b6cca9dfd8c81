// SPDX-License-Identifier: Apache-2.0
#include "resight/io/settings_file.hpp"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <map>

#include "resight/core/input_file.hpp"
#include "resight/io/toml_keys.hpp"

namespace resight {
namespace {

using Nodes = std::map<std::string, const toml::node*>;

void collect_values(const toml::table& table, const std::string& prefix, Nodes& values) {
  for (const auto& [key, node] : table) {
    const std::string name = prefix + std::string(key.str());
    if (const toml::table* entries = node.as_table())
      collect_values(*entries, name + ".", values);
    else
      values[name] = &node;
  }
}

OptionValue value_of(const toml::node& node) {
  if (const auto flag = node.value_exact<bool>()) return *flag;
  if (const auto whole = node.value_exact<std::int64_t>()) return *whole;
  if (const auto number = node.value_exact<double>()) return *number;
  return node.value_exact<std::string>().value_or("");
}

// What is wrong, or an empty text.
std::string assign(const std::vector<Option>& options, const std::string& key, const toml::node& node) {
  const auto option = std::ranges::find(options, key, &Option::key);
  constexpr std::size_t kMaxKeyBytes = 100;  // No option has a longer one.
  if (option == options.end() && key.size() > kMaxKeyBytes)
    return fmt::format("unknown key {}.. of {} bytes", key.substr(0, kMaxKeyBytes), key.size());
  if (option == options.end()) return fmt::format("unknown key {} (did you mean {}?)", key, nearest_key(options, key));
  if (!option->condition.empty()) return fmt::format("{} has no effect unless {}", key, option->condition);
  const std::string expected = assign_option(*option, value_of(node));
  return expected.empty() ? "" : fmt::format("{} must be {}", key, expected);
}

// Whether other options may depend on it: whatever is no plain number.
bool is_choice(const std::vector<Option>& options, const std::string& key) {
  const auto option = std::ranges::find(options, key, &Option::key);
  return option != options.end() && option->condition.empty() && !std::holds_alternative<int*>(option->pointer) &&
         !std::holds_alternative<double*>(option->pointer);
}

}  // namespace

Result<void> assign_settings(const std::filesystem::path& file, const std::function<std::vector<Option>()>& list_all) {
  const auto fail = [&](const std::string& what) { return Error{fmt::format("{}: {}", file.string(), what)}; };
  const auto text = read_file(file);
  if (!text) return text.error();
  if (const auto checked = check_toml_keys(*text); !checked) return fail(checked.error().message);
  toml::table table;
  try {
    table = toml::parse(*text);
  } catch (const toml::parse_error& error) {
    return fail(fmt::format("line {}: {}", error.source().begin.line, error.description()));
  }
  Nodes open;
  collect_values(table, "", open);
  // Choices first, one at a time: each may bring others into effect.
  for (bool found = true; found;) {
    const std::vector<Option> options = list_all();
    const auto choice = std::ranges::find_if(open, [&](const auto& entry) { return is_choice(options, entry.first); });
    found = choice != open.end();
    if (!found) break;
    if (const std::string problem = assign(options, choice->first, *choice->second); !problem.empty())
      return fail(problem);
    open.erase(choice);
  }
  const std::vector<Option> options = list_all();
  for (const auto& [key, node] : open)
    if (const std::string problem = assign(options, key, *node); !problem.empty()) return fail(problem);
  return {};
}

}  // namespace resight
