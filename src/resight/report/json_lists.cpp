// SPDX-License-Identifier: Apache-2.0
#include <string>
#include <utility>

#include "resight/core/json_text.hpp"
#include "resight/report/internal/results_text.hpp"

namespace resight::report {

JsonLists::JsonLists(const nlohmann::ordered_json& head, TextSink sink) : sink_(std::move(sink)) {
  const std::string text = to_json_text(head, kIndentedJson);
  sink_(std::string_view(text).substr(0, text.size() - 2));  // Without the line of the closing brace.
}

void JsonLists::begin(std::string_view list) {
  sink_(",\n \"" + std::string(list) + "\": [");
  is_empty_ = true;
}

void JsonLists::add(const nlohmann::ordered_json& item) {
  const std::string text = to_json_text(item, kIndentedJson);
  std::string indented = is_empty_ ? "\n  " : ",\n  ";
  for (const char c : text) {
    indented += c;
    if (c == '\n') indented += "  ";  // A line break within a value is written as an escape.
  }
  sink_(indented);
  is_empty_ = false;
}

void JsonLists::end() { sink_(is_empty_ ? "]" : "\n ]"); }

void JsonLists::finish() { sink_("\n}\n"); }

}  // namespace resight::report
