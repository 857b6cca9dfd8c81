// SPDX-License-Identifier: Apache-2.0
#include "resight/annotation/annotation_project.hpp"

#include <fmt/format.h>

#include <limits>
#include <nlohmann/json.hpp>
#include <utility>

#include "resight/core/files.hpp"

namespace resight {
namespace {

constexpr const char* kJournalName = "annotation.jsonl";

std::string make_header(const std::string& inputs) {
  return nlohmann::json{{"format", "resight annotation 1"}, {"inputs", inputs}}.dump();
}

}  // namespace

Result<std::unique_ptr<AnnotationProject>> AnnotationProject::open(const std::filesystem::path& folder,
                                                                   const AnnotationLimits& limits,
                                                                   const std::string& inputs) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) return file_error(folder, "cannot be created (" + error.message() + ")");
  auto opened = AnnotationJournal::open(folder / kJournalName, make_header(inputs),
                                        [](std::string_view line) { return parse_action(line).ok(); });
  if (!opened) return opened.error();
  std::unique_ptr<AnnotationProject> project(new AnnotationProject(std::move(opened->journal), limits));
  project->was_cut_off_ = opened->was_cut_off;
  if (const auto done = project->replay(opened->lines); !done)
    return file_error(folder / kJournalName, done.error().message);
  return project;
}

Result<void> AnnotationProject::replay(const std::vector<std::string>& lines) {
  for (std::size_t i = 0; i < lines.size(); ++i) {
    auto action = parse_action(lines[i]);
    if (!action) return action.error();
    if (const auto done = apply(*action); !done) return Error{fmt::format("line {}: {}", i + 2, done.error().message)};
    ++revision_;
  }
  return {};
}

std::string AnnotationProject::undo_title() const { return done_.empty() ? "" : done_.back().edit.title; }
std::string AnnotationProject::redo_title() const { return undone_.empty() ? "" : undone_.back().title; }

Result<AnnotationProject::Step> AnnotationProject::apply_edit(AnnotationDocument& document, AnnotationEdit edit) const {
  Step step;
  for (AnnotationChange& change : edit.changes) {
    auto undo = apply_change(document, change, limits_);
    if (!undo) return undo.error();
    step.undo.insert(step.undo.begin(), *std::move(undo));
  }
  step.edit = std::move(edit);
  return step;
}

Result<void> AnnotationProject::apply(AnnotationAction& action) {
  AnnotationDocument next = document_;
  if (std::holds_alternative<UndoEdit>(action)) {
    if (done_.empty()) return Error{"there is nothing to undo"};
    for (AnnotationChange& change : done_.back().undo)
      if (auto undone = apply_change(next, change, limits_); !undone) return undone.error();
    undone_.push_back(std::move(done_.back().edit));
    done_.pop_back();
  } else if (std::holds_alternative<RedoEdit>(action)) {
    if (undone_.empty()) return Error{"there is nothing to redo"};
    auto step = apply_edit(next, undone_.back());
    if (!step) return step.error();
    undone_.pop_back();
    done_.push_back(*std::move(step));
  } else {
    auto step = apply_edit(next, std::get<AnnotationEdit>(std::move(action)));
    if (!step) return step.error();
    action = step->edit;  // with the numbers that were given
    done_.push_back(*std::move(step));
    undone_.clear();
  }
  document_ = std::move(next);
  return {};
}

ActionOutcome AnnotationProject::act(AnnotationAction action, int based_on) {
  using Kind = ActionOutcome::Kind;
  if (based_on != revision_)
    return {Kind::kStale, fmt::format("the annotation has changed: revision {} is not {}", based_on, revision_)};
  // Kept until the journal is written, because an action that is not written must not count.
  AnnotationDocument old_document = document_;
  auto old_done = done_;
  auto old_undone = undone_;
  if (const auto done = apply(action); !done) return {Kind::kInvalid, done.error().message};
  if (const auto written = journal_.append(format_action(action)); !written) {
    document_ = std::move(old_document);
    done_ = std::move(old_done);
    undone_ = std::move(old_undone);
    return {Kind::kNotWritten, written.error().message};
  }
  ++revision_;
  return {};
}

}  // namespace resight
