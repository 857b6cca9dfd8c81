// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "resight/annotation/annotation_project.hpp"
#include "resight/annotation/change_proposals.hpp"
#include "resight/models/object_model.hpp"
#include "resight/sensor/sequence.hpp"
#include "resight/viewer/http_message.hpp"

namespace resight {

/// What is annotated, with what, and where the result goes.
struct AnnotationTask {
  std::shared_ptr<const Sequence> sequence;
  std::shared_ptr<const ModelLibrary> library;
  std::vector<ChangeProposal> regions;
  std::unique_ptr<AnnotationProject> project;
  std::string scene_name;  ///< Of the exported sequence.
  std::filesystem::path export_folder;
};

/// Answers the requests of the page that annotates (docs/annotate.md lists the addresses). To be called by one thread.
class AnnotationService {
 public:
  explicit AnnotationService(AnnotationTask task);
  ~AnnotationService();
  [[nodiscard]] const AnnotationProject& project() const;

  /// `parts`: of the path, behind /api/annotation.
  [[nodiscard]] HttpResponse answer(const HttpRequest& request, const std::vector<std::string_view>& parts);
  /// Writes the export, unless the last one is of the same revision.
  [[nodiscard]] Result<void> save();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace resight
