// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "commands.hpp"
#include "resight/io/change_files.hpp"
#include "resight/recognition/recognizer_config.hpp"

namespace resight::app {

struct EvaluationSequence {
  std::string name;  ///< Unique: name of its folder or, if others have it, too, their path with '_' for '/'.
  std::filesystem::path folder;
  int num_views = 0;
  std::filesystem::path annotations;     ///< Folder of the TUW annotations; `folder` if there are none.
  ChangeFiles changes;                   ///< What it holds of the true changes.
  std::filesystem::path unknown_models;  ///< May not exist.
};

/// One configuration on one sequence.
struct EvaluationUnit {
  std::string name;         ///< Unique; also the name of its file.
  std::string fingerprint;  ///< Hash of everything its result depends on: program, settings, models, views, truth.
  EvaluationSequence sequence;
  RecognizerConfig config;
  int group = 0;  ///< Units of one group share the hypotheses of each view and are consecutive.
  int shard = 1;  ///< 1..n; all units of a group are in one shard.
};

struct EvaluationPlan {
  std::string dataset_name;
  std::filesystem::path models;  ///< Models of the data set; may not exist.
  std::vector<EvaluationUnit> units;
};

/// Parses "0-7", "0,5" or "0-2,5" to ascending numbers without duplicates. Throws InputError for other text.
[[nodiscard]] std::vector<int> parse_previous_views(const std::string& text);
/// Parses "2/8" to shard and number of shards. Throws InputError for other text.
void parse_shard(const std::string& text, int& shard, int& num_shards);

/// Lists the sequences (the data set is one, or contains them in test/ or directly) and all runs over them. Throws
/// InputError if there are none.
[[nodiscard]] EvaluationPlan make_evaluation_plan(const EvaluateArguments& arguments);

}  // namespace resight::app
