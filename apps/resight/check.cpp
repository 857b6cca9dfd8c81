// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "check_pictures.hpp"
#include "commands.hpp"
#include "output_paths.hpp"
#include "resight/core/files.hpp"
#include "resight/core/json_text.hpp"
#include "resight/inspection/find_faults.hpp"
#include "resight/inspection/object_scale.hpp"
#include "resight/io/images.hpp"
#include "resight/models/library_file.hpp"
#include "resight/registration/camera_errors.hpp"
#include "resight/training/training.hpp"
#include "sequence_input.hpp"

namespace resight::app {
namespace {

using CheckJson = nlohmann::ordered_json;

CheckJson to_json(const Finding& f, const Sequence& sequence) {
  return {{"fault", f.fault}, {"message", f.message},     {"remedy", f.remedy}, {"value", f.value},
          {"unit", f.unit},   {"threshold", f.threshold}, {"margin", f.margin}, {"view", sequence.view_name(f.view)}};
}

/// Everything that `check` has to say.
struct CheckReport {
  SequenceMeasurements measured;
  std::vector<Finding> findings;
  std::vector<std::string> facts;
  std::vector<std::string> unmeasured;
  bool knows_sizes = false;  ///< Those of known objects were measured.
  [[nodiscard]] bool is_sound() const { return findings.empty() && unmeasured.empty(); }
};

std::optional<ModelLibrary> load_models(const CheckArguments& arguments) {
  if (!arguments.models) return std::nullopt;
  ModelLibrary library = value_or_throw(load_library(*arguments.models, TrainOptions{}.hash()));
  if (library.objects.empty()) throw InputError(fmt::format("{}: contains no models", arguments.models->string()));
  return library;
}

void add_model_sizes(const CheckArguments& arguments, const Sequence& sequence, const ModelLibrary& library,
                     CheckReport& report) {
  const ObjectScales scales = value_or_throw(measure_object_scales(
      sequence, library, {.max_views = std::min(12, arguments.max_views), .num_threads = arguments.num_threads}));
  for (Finding& f : find_scale_faults(scales, library)) report.findings.push_back(std::move(f));
  (scales.is_measured() ? report.facts : report.unmeasured).push_back(describe_scales(scales));
  report.knows_sizes = scales.is_measured();
}

// Nothing if the views do not show one.
void add_depth_bias(const CheckArguments& arguments, const Sequence& sequence, CheckReport& report) {
  PrepareViewOptions prepare;
  prepare.max_pixels = kMaxWorkingPixels;
  const DepthBias bias = measure_camera_errors(sequence, prepare, {.correct = true},
                                               {.correct = true, .num_threads = arguments.num_threads})
                             .depth_bias;
  if (bias.is_significant())
    report.facts.push_back(fmt::format(
        "depth at 1 m is {:.1f} +- {:.1f} mm too {}, and at 2 m four times as much; preset default corrects it in "
        "recordings of a moving camera, --depth-bias {:.4f} everywhere",
        1e3 * std::abs(bias.per_m), 1e3 * bias.sigma_per_m, bias.per_m > 0 ? "small" : "large",
        arguments.input.depth_bias_per_m + bias.per_m));  // A given one was corrected before.
}

// The bias can be measured nevertheless.
bool leaves_depth_alone(const Finding& finding) {
  return finding.fault == "color_offset" || finding.fault == "motion_blur" || finding.fault == "black_image";
}

CheckReport check_sequence(const CheckArguments& arguments, const Sequence& sequence,
                           const std::optional<ModelLibrary>& library) {
  CheckReport report;
  report.measured = value_or_throw(
      measure_sequence(sequence, {.max_views = arguments.max_views, .num_threads = arguments.num_threads}));
  report.findings = find_faults(report.measured);
  report.facts = list_facts(report.measured);
  if (sequence.has_poses() && std::ranges::all_of(report.findings, leaves_depth_alone))
    add_depth_bias(arguments, sequence, report);
  if (library) add_model_sizes(arguments, sequence, *library, report);
  for (std::string& what : list_unmeasured(report.measured, report.knows_sizes))
    report.unmeasured.push_back(std::move(what));
  return report;
}

CheckJson soundness(const CheckReport& report) {
  if (!report.findings.empty()) return false;
  return report.unmeasured.empty() ? CheckJson(true) : CheckJson(nullptr);
}

std::string format_json(const CheckArguments& arguments, const CheckReport& report, const Sequence& sequence) {
  CheckJson json = {{"path", arguments.sequence.string()},
                    {"sound", soundness(report)},
                    {"inspected_views", report.measured.views.size()},
                    {"matched_pairs", report.measured.pairs.size()},
                    {"findings", CheckJson::array()},
                    {"facts", report.facts},
                    {"not_measured", report.unmeasured}};
  for (const Finding& f : report.findings) json["findings"].push_back(to_json(f, sequence));
  const std::vector<std::string> pictures = picture_names(report.findings);
  for (std::size_t i = 0; arguments.out && i < pictures.size(); ++i) json["findings"][i]["picture"] = pictures[i];
  return to_json_text(json, kIndentedJson) + "\n";
}

/// Writes findings.json even if there are none: it tells which pictures belong to this check, and it marks the folder
/// as one that the next check may fill.
void write_findings(const CheckArguments& arguments, const CheckReport& report, const Sequence& sequence) {
  auto folder = value_or_throw(PendingDirectory::create(*arguments.out, ExistingFolder::kFill));
  const std::vector<std::string> pictures = picture_names(report.findings);
  for (std::size_t i = 0; i < pictures.size(); ++i)
    value_or_throw(
        write_color(folder.path() / pictures[i], draw_finding(report.findings[i], report.measured, sequence)));
  value_or_throw(write_file(folder.path() / "findings.json", format_json(arguments, report, sequence)));
  value_or_throw(folder.commit());
}

void print_lines(const CheckArguments& arguments, const CheckReport& report, const Sequence& sequence) {
  for (const Finding& f : report.findings)
    print("{}: {}\n  margin {:.2g}, view {}; remedy: {}\n", f.fault, f.message, f.margin, sequence.view_name(f.view),
          f.remedy);
  for (const std::string& fact : report.facts) print("fact: {}\n", fact);
  for (const std::string& what : report.unmeasured) print("not measured: {}\n", what);
  const std::string verdict = report.is_sound()             ? "sound"
                              : report.findings.empty()     ? "no fault found in what could be measured"
                              : report.findings.size() == 1 ? "1 finding"
                                                            : fmt::format("{} findings", report.findings.size());
  print("{}: {} of {} views inspected, {} pairs of views matched: {}\n", arguments.sequence.string(),
        report.measured.views.size(), report.measured.num_views, report.measured.pairs.size(), verdict);
}

}  // namespace

bool run_check(const CheckArguments& arguments) {
  if (arguments.out) check_output_folder(*arguments.out, "check", {arguments.sequence});
  const std::optional<ModelLibrary> library = load_models(arguments);
  const auto sequence = open_input(arguments.sequence, arguments.input);
  const CheckReport report = check_sequence(arguments, *sequence, library);
  if (arguments.out) write_findings(arguments, report, *sequence);
  if (arguments.as_json)
    print_json(format_json(arguments, report, *sequence));
  else
    print_lines(arguments, report, *sequence);
  return report.findings.empty();
}

}  // namespace resight::app
