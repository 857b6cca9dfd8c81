// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <nlohmann/json.hpp>
#include <string_view>

#include "resight/report/view_record.hpp"

namespace resight::report {

/// Receives a text in parts.
using TextSink = std::function<void(std::string_view)>;

/// Puts an object whose lists are not in memory as a whole, in the layout of to_text().
class JsonLists {
 public:
  /// `head`: the members before the lists; at least one.
  JsonLists(const nlohmann::ordered_json& head, TextSink sink);
  void begin(std::string_view list);
  void add(const nlohmann::ordered_json& item);
  void end();
  /// After the last list.
  void finish();

 private:
  TextSink sink_;
  bool is_empty_ = true;  ///< The list so far.
};

/// The files of results.hpp, view by view.
void put_detections_csv(const ReportRun& run, const ModelLibrary& library, const TextSink& sink);
void put_detections_json(const ReportRun& run, const ModelLibrary& library, const TextSink& sink);
void put_changes_json(const ReportRun& run, const ModelLibrary& library, const TextSink& sink);

}  // namespace resight::report
