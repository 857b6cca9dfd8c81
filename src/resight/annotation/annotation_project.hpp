// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "resight/annotation/annotation_action.hpp"
#include "resight/annotation/annotation_journal.hpp"

namespace resight {

/// What became of an action.
struct ActionOutcome {
  enum class Kind {
    kApplied,
    kStale,       ///< The document has changed since `based_on`; nothing happened.
    kInvalid,     ///< The action is wrong, or there is nothing to undo or redo; nothing happened.
    kNotWritten,  ///< The journal could not be written; nothing happened.
  };
  Kind kind = Kind::kApplied;
  std::string message;  ///< Why not; empty if applied.
};

/// A document on the disk: every action is written to the journal of its folder before it counts. Undo and redo are
/// actions, too, so nothing that was ever done is lost.
class AnnotationProject {
 public:
  /// Opens the project in `folder`, which is created if it is missing. `inputs` identifies the views and models,
  /// `earlier_inputs` does so in projects of earlier versions (identify_inputs()). Fails if another process has it
  /// open, it belongs to other inputs, or it is damaged.
  [[nodiscard]] static Result<std::unique_ptr<AnnotationProject>> open(const std::filesystem::path& folder,
                                                                       const AnnotationLimits& limits,
                                                                       const std::string& inputs,
                                                                       const std::string& earlier_inputs = "");

  /// Whether the folder holds a project.
  [[nodiscard]] static bool is_in(const std::filesystem::path& folder);

  [[nodiscard]] const AnnotationDocument& document() const { return document_; }
  [[nodiscard]] const AnnotationLimits& limits() const { return limits_; }
  /// Number of actions so far.
  [[nodiscard]] int revision() const { return revision_; }
  /// Titles of the edits that undo and redo would concern next; empty if there are none.
  [[nodiscard]] std::string undo_title() const;
  [[nodiscard]] std::string redo_title() const;
  [[nodiscard]] bool was_cut_off() const { return was_cut_off_; }

  /// Applies an action to revision `based_on`.
  [[nodiscard]] ActionOutcome act(const AnnotationAction& action, int based_on);

 private:
  /// An edit as applied, with the changes that undo it, last first.
  struct Step {
    AnnotationEdit edit;
    std::vector<AnnotationChange> undo;
    int next_id = 0;  ///< Of the document before.
    int next_track = 0;
  };
  /// Writes an action before it counts.
  using Append = std::function<Result<void>(const AnnotationAction&)>;
  AnnotationProject(AnnotationJournal journal, const AnnotationLimits& limits)
      : journal_(std::move(journal)), limits_(limits) {}
  [[nodiscard]] Result<void> replay(const std::vector<std::string>& lines);
  [[nodiscard]] ActionOutcome apply(const AnnotationAction& action, const Append& append);
  [[nodiscard]] ActionOutcome undo(const Append& append);
  /// All changes of an edit, or none.
  [[nodiscard]] Result<Step> apply_edit(AnnotationEdit edit);
  void take_back(Step& step);
  void revert(Step& step);  ///< Same, as if it had never been done: its numbers are free again.

  AnnotationJournal journal_;
  AnnotationLimits limits_;
  AnnotationDocument document_;
  std::vector<Step> done_;
  std::vector<AnnotationEdit> undone_;
  int revision_ = 0;
  bool was_cut_off_ = false;
};

}  // namespace resight
