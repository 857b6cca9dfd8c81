// SPDX-License-Identifier: Apache-2.0
#include "resight/annotation/annotation_project.hpp"

#include <fmt/format.h>

#include <cassert>
#include <nlohmann/json.hpp>
#include <utility>

#include "resight/core/files.hpp"

namespace resight {
namespace {

constexpr const char* kJournalName = "annotation.jsonl";

std::string make_header(const std::string& inputs) {
  return nlohmann::json{{"format", "resight annotation 2"}, {"inputs", inputs}}.dump();
}

}  // namespace

Result<std::unique_ptr<AnnotationProject>> AnnotationProject::open(const std::filesystem::path& folder,
                                                                   const AnnotationLimits& limits,
                                                                   const std::string& inputs,
                                                                   const std::string& earlier_inputs) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) return file_error(folder, "cannot be created (" + error.message() + ")");
  std::vector<std::string> headers{make_header(inputs)};
  if (!earlier_inputs.empty()) headers.push_back(make_header(earlier_inputs));
  auto opened = AnnotationJournal::open(folder / kJournalName, headers,
                                        [](std::string_view line) { return parse_action(line).ok(); });
  if (!opened) return opened.error();
  std::unique_ptr<AnnotationProject> project(new AnnotationProject(std::move(opened->journal), limits));
  project->was_cut_off_ = opened->was_cut_off;
  if (const auto done = project->replay(opened->lines); !done)
    return file_error(folder / kJournalName, done.error().message);
  return project;
}

bool AnnotationProject::is_in(const std::filesystem::path& folder) {
  std::error_code error;
  return std::filesystem::exists(folder / kJournalName, error);
}

Result<void> AnnotationProject::replay(const std::vector<std::string>& lines) {
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const auto action = parse_action(lines[i]);
    if (!action) return action.error();
    const ActionOutcome outcome = apply(*action, [](const AnnotationAction&) { return Result<void>(); });
    if (outcome.kind != ActionOutcome::Kind::kApplied) return Error{fmt::format("line {}: {}", i + 2, outcome.message)};
    ++revision_;
  }
  return {};
}

std::string AnnotationProject::undo_title() const { return done_.empty() ? "" : done_.back().edit.title; }
std::string AnnotationProject::redo_title() const { return undone_.empty() ? "" : undone_.back().title; }

Result<AnnotationProject::Step> AnnotationProject::apply_edit(AnnotationEdit edit) {
  Step step{.edit = {}, .undo = {}, .next_id = document_.next_id, .next_track = document_.next_track};
  for (AnnotationChange& change : edit.changes) {
    auto undo = apply_change(document_, change, limits_);
    if (!undo) {
      revert(step);
      return undo.error();
    }
    step.undo.insert(step.undo.begin(), *std::move(undo));
  }
  step.edit = std::move(edit);
  return step;
}

void AnnotationProject::take_back(Step& step) {
  for (AnnotationChange& change : step.undo) {
    [[maybe_unused]] const auto undone = apply_change(document_, change, limits_);
    assert(undone.ok());
  }
}

void AnnotationProject::revert(Step& step) {
  take_back(step);
  document_.next_id = step.next_id;
  document_.next_track = step.next_track;
}

ActionOutcome AnnotationProject::undo(const Append& append) {
  if (done_.empty()) return {ActionOutcome::Kind::kInvalid, "there is nothing to undo"};
  if (const auto written = append(UndoEdit{}); !written)
    return {ActionOutcome::Kind::kNotWritten, written.error().message};
  take_back(done_.back());
  undone_.push_back(std::move(done_.back().edit));
  done_.pop_back();
  return {};
}

ActionOutcome AnnotationProject::apply(const AnnotationAction& action, const Append& append) {
  if (std::holds_alternative<UndoEdit>(action)) return undo(append);
  const bool is_redo = std::holds_alternative<RedoEdit>(action);
  if (is_redo && undone_.empty()) return {ActionOutcome::Kind::kInvalid, "there is nothing to redo"};
  auto step = apply_edit(is_redo ? undone_.back() : std::get<AnnotationEdit>(action));
  if (!step) return {ActionOutcome::Kind::kInvalid, step.error().message};
  // The step has the numbers that were given, and an action that is not written must not count.
  if (const auto written = append(is_redo ? action : AnnotationAction(step->edit)); !written) {
    revert(*step);
    return {ActionOutcome::Kind::kNotWritten, written.error().message};
  }
  if (is_redo)
    undone_.pop_back();
  else
    undone_.clear();
  done_.push_back(*std::move(step));
  return {};
}

ActionOutcome AnnotationProject::act(const AnnotationAction& action, int based_on) {
  if (based_on != revision_)
    return {ActionOutcome::Kind::kStale,
            fmt::format("the annotation has changed: revision {} is not {}", based_on, revision_)};
  ActionOutcome outcome =
      apply(action, [this](const AnnotationAction& done) { return journal_.append(format_action(done)); });
  if (outcome.kind == ActionOutcome::Kind::kApplied) ++revision_;
  return outcome;
}

}  // namespace resight
