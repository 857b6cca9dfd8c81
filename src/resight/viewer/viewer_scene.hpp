// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "resight/io/model_source.hpp"
#include "resight/io/recognition_results.hpp"
#include "resight/models/object_model.hpp"
#include "resight/sensor/sequence.hpp"

namespace resight {

/// Results to be shown, with a name that tells them apart.
struct ViewerRun {
  std::string name;
  RecognitionResults results;
};

/// What is shown: views, the models of their objects, and any number of results on these views. Each part may be
/// missing.
struct ViewerScene {
  std::string title;
  std::shared_ptr<const Sequence> sequence;
  std::shared_ptr<const ModelLibrary> library;
  std::vector<ModelLocation> models;  ///< Shown where there is no library.
  std::vector<ViewerRun> runs;
  std::filesystem::path changes;  ///< Folder of `resight changes` on these views: <name of the view>.ply.
  bool is_live = false;           ///< Views are still being added to the runs.
  bool is_annotated = false;      ///< The page annotates the views (AnnotationService).
};

}  // namespace resight
