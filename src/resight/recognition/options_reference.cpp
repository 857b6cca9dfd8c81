// SPDX-License-Identifier: Apache-2.0
#include "resight/recognition/options_reference.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>
#include <vector>

#include "resight/core/options.hpp"
#include "resight/recognition/recognizer_config.hpp"

namespace resight {
namespace {

constexpr std::array<const char*, 3> kPresets{"mvr", "mvr-chd", "default"};

constexpr const char* kIntroduction = R"(# Options

Made by `resight options` from the declarations beside the code; do not edit.

A settings file (`--config FILE`, TOML) sets options of a preset. A key `a.b.c` is `c` in the table `[a.b]`:

```toml
num_previous_views = 3

[changes]
sigmas = 3

[verify.clutter]
weight = 3
```

`summary.json` keeps all settings of a run. An option that has no effect in its context is refused, as is an unknown
key. In the tables, `off` is the absence of an optional value, and `–` an option without effect in that preset. Paper:
the paper that resight reproduces; V4R: its reference code; ours: an addition of this project.
)";

std::string_view unit_of(std::string_view key) {
  for (const auto& [suffix, unit] :
       {std::pair<std::string_view, std::string_view>{"_m", "m"}, {"_rad", "rad"}, {"_px", "px"}, {"_ms", "ms"}})
    if (key.ends_with(suffix)) return unit;
  if (key.ends_with("_sigmas")) return "standard deviations";
  return key.ends_with("_share") ? "share" : "";
}

std::string values_of(const Option& option) {
  if (!option.alternatives.empty()) {
    if (option.alternatives.front().name == "false") return "true, false";
    std::string names;
    for (const OptionAlternative& alternative : option.alternatives)
      names += fmt::format("{}`\"{}\"`", names.empty() ? "" : ", ", alternative.name);
    return names;
  }
  if (std::holds_alternative<bool*>(option.pointer)) return "true, false";
  if (std::holds_alternative<std::uint64_t*>(option.pointer)) return "whole, >= 0";
  const bool is_whole =
      std::holds_alternative<int*>(option.pointer) || std::holds_alternative<std::optional<int>*>(option.pointer);
  const bool may_be_off = std::holds_alternative<std::optional<int>*>(option.pointer) ||
                          std::holds_alternative<std::optional<double>*>(option.pointer);
  return (is_whole ? "whole, " : "") + option.range.rule() + (may_be_off ? ", `\"off\"`" : "");
}

std::string meaning_of(const Option& option, const std::string& condition) {
  std::string text(option.doc);
  std::string names;
  for (const OptionAlternative& alternative : option.alternatives)
    if (!alternative.doc.empty())
      names += fmt::format("{}`{}`: {}", names.empty() ? "" : "; ", alternative.name, alternative.doc);
  if (!names.empty()) text += " " + names + ".";
  if (!option.source.empty()) text += fmt::format(" Source: {}.", option.source);
  if (!condition.empty()) text += fmt::format(" Only with `{}`.", condition);
  return text;
}

std::string section_of(const std::string& key) {
  const std::size_t dot = key.rfind('.');
  return dot == std::string::npos ? "" : key.substr(0, dot);
}

}  // namespace

std::string options_reference() {
  std::vector<RecognizerConfig> configs;
  for (const char* preset : kPresets) configs.push_back(RecognizerConfig::from_preset(preset));
  std::vector<std::vector<Option>> options;
  for (RecognizerConfig& config : configs) options.push_back(list_options(config));
  // Sections in the order of their first option.
  std::vector<std::pair<std::string, std::string>> sections;
  for (std::size_t i = 0; i < options[0].size(); ++i) {
    const Option& option = options[0][i];
    const std::string name = section_of(option.key);
    auto section = std::ranges::find(sections, name, &std::pair<std::string, std::string>::first);
    if (section == sections.end()) section = sections.insert(sections.end(), {name, ""});
    std::string condition;
    std::string values;
    for (const std::vector<Option>& of_preset : options) {
      values += of_preset[i].condition.empty() ? fmt::format(" {} |", of_preset[i].value) : " – |";
      if (condition.empty()) condition = of_preset[i].condition;
    }
    section->second += fmt::format("| `{}` | {} | {} |{} {} |\n", option.key, unit_of(option.key), values_of(option),
                                   values, meaning_of(option, condition));
  }
  std::string text = kIntroduction;
  for (const auto& [name, rows] : sections) {
    text += fmt::format("\n## {}\n\n", name.empty() ? "General" : "`[" + name + "]`");
    text += "| key | unit | values | mvr | mvr-chd | default | meaning |\n|---|---|---|---|---|---|---|\n" + rows;
  }
  return text;
}

}  // namespace resight
