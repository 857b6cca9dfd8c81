// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "commands.hpp"
#include "resight/recognition/recognizer_config.hpp"

namespace resight::app {

struct EvaluationSequence {
  std::string name;  ///< Of its folder.
  std::filesystem::path folder;
  std::filesystem::path events_file;     ///< May not exist.
  std::filesystem::path unknown_models;  ///< May not exist.
};

/// One configuration on one sequence.
struct EvaluationUnit {
  std::string name;         ///< Unique; names its file.
  std::string fingerprint;  ///< Of all that its result depends on but the views.
  EvaluationSequence sequence;
  RecognizerConfig config;
  int group = 0;  ///< Units of one group share the hypotheses of each view; they follow each other.
  int shard = 1;  ///< 1..n; a group lies in one shard.
};

struct EvaluationPlan {
  std::string dataset_name;
  std::filesystem::path models;  ///< Of the data set; may not exist.
  std::vector<EvaluationUnit> units;
};

/// "0-7", "0,5" or "0-2,5": ascending, each once. InputError for anything else.
[[nodiscard]] std::vector<int> parse_previous_views(const std::string& text);
/// "2/8": shard and number of shards. InputError for anything else.
void parse_shard(const std::string& text, int& shard, int& num_shards);

/// Lists the sequences (the data set is one, or holds them in its folder test/ or in itself) and all runs over them.
[[nodiscard]] EvaluationPlan make_evaluation_plan(const EvaluateArguments& arguments);

}  // namespace resight::app
