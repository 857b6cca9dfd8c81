// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "check_pictures.hpp"
#include "commands.hpp"
#include "output_paths.hpp"
#include "resight/core/files.hpp"
#include "resight/core/json_text.hpp"
#include "resight/inspection/find_faults.hpp"
#include "resight/io/images.hpp"
#include "sequence_input.hpp"

namespace resight::app {
namespace {

using CheckJson = nlohmann::ordered_json;

std::string picture_name(const Finding& finding) { return finding.fault + ".png"; }

void write_pictures(const CheckArguments& arguments, const std::vector<Finding>& findings,
                    const SequenceMeasurements& measured, const Sequence& sequence) {
  auto folder = value_or_throw(PendingDirectory::create(*arguments.out, ExistingFolder::kFill));
  for (const Finding& f : findings)
    value_or_throw(write_color(folder.path() / picture_name(f), draw_finding(f, measured, sequence)));
  value_or_throw(folder.commit());
}

CheckJson to_json(const Finding& f, const Sequence& sequence, bool has_picture) {
  CheckJson json = {
      {"fault", f.fault}, {"message", f.message},     {"remedy", f.remedy}, {"value", f.value},
      {"unit", f.unit},   {"threshold", f.threshold}, {"margin", f.margin}, {"view", sequence.view_name(f.view)}};
  if (has_picture) json["picture"] = picture_name(f);
  return json;
}

void print_json(const CheckArguments& arguments, const std::vector<Finding>& findings,
                const SequenceMeasurements& measured, const Sequence& sequence) {
  CheckJson json = {{"path", arguments.sequence.string()},      {"sound", findings.empty()},
                    {"inspected_views", measured.views.size()}, {"matched_pairs", measured.pairs.size()},
                    {"findings", CheckJson::array()},           {"facts", list_facts(measured)}};
  for (const Finding& f : findings) json["findings"].push_back(to_json(f, sequence, arguments.out.has_value()));
  print_text(to_json_text(json, kIndentedJson) + "\n");
}

}  // namespace

bool run_check(const CheckArguments& arguments) {
  if (arguments.out) check_output_folder(*arguments.out, {arguments.sequence});
  const auto sequence = open_input(arguments.sequence, arguments.input);
  const SequenceMeasurements measured = value_or_throw(
      measure_sequence(*sequence, {.max_views = arguments.max_views, .num_threads = arguments.num_threads}));
  const std::vector<Finding> findings = find_faults(measured);
  if (arguments.out && !findings.empty()) write_pictures(arguments, findings, measured, *sequence);
  if (arguments.as_json) {
    print_json(arguments, findings, measured, *sequence);
    return findings.empty();
  }
  for (const Finding& f : findings)
    print("{}: {}\n  margin {:.2g}, view {}; remedy: {}\n", f.fault, f.message, f.margin, sequence->view_name(f.view),
          f.remedy);
  for (const std::string& fact : list_facts(measured)) print("fact: {}\n", fact);
  print("{}: {} of {} views inspected, {} pairs of views matched: {}\n", arguments.sequence.string(),
        measured.views.size(), measured.num_views, measured.pairs.size(),
        findings.empty() ? "sound" : fmt::format("{} findings", findings.size()));
  return findings.empty();
}

}  // namespace resight::app
