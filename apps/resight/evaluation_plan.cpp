// SPDX-License-Identifier: Apache-2.0
#include "evaluation_plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <fstream>
#include <map>
#include <set>
#include <sstream>

#include "recognition_run.hpp"
#include "resight/core/hash.hpp"
#include "resight/io/sequence.hpp"
#include "resight/recognition/view_hypotheses.hpp"

namespace resight::app {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> parts;
  std::istringstream stream(text);
  for (std::string part; std::getline(stream, part, separator);) parts.push_back(part);
  return parts;
}

int to_int(const std::string& text, const std::string& option, const std::string& expected) {
  int value = -1;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || value < 0)
    throw InputError(fmt::format("{}: '{}' ({} was expected)", option, text, expected));
  return value;
}

EvaluationSequence describe(const fs::path& folder) {
  EvaluationSequence sequence;
  sequence.folder = folder;
  sequence.name = folder.filename().string();
  sequence.events_file = folder.parent_path() / (sequence.name + ".events.json");
  const fs::path dataset = folder.parent_path().parent_path();
  if (!fs::exists(sequence.events_file)) sequence.events_file = dataset / "events.json";
  sequence.unknown_models = dataset / "unknown" / "models";
  return sequence;
}

// Finds the sequences: the data set itself, or those in its folder test/, or those directly below it.
std::vector<EvaluationSequence> find_sequences(const fs::path& given) {
  const fs::path dataset = fs::absolute(given / "").parent_path().lexically_normal();
  if (!fs::is_directory(dataset)) throw InputError(fmt::format("{}: is not a folder", given.string()));
  const fs::path root = fs::is_directory(dataset / "test") ? dataset / "test" : dataset;
  std::vector<fs::path> folders;
  for (const auto& entry : fs::directory_iterator(root))
    if (entry.is_directory() && entry.path().filename().string().front() != '.') folders.push_back(entry.path());
  std::ranges::sort(folders);
  std::vector<EvaluationSequence> sequences;
  if (root == dataset && open_posed_sequence(dataset).ok()) return {describe(dataset)};
  for (const fs::path& folder : folders)
    if (open_posed_sequence(folder).ok()) sequences.push_back(describe(folder));
  if (sequences.empty()) throw InputError(open_posed_sequence(dataset).error().message);
  return sequences;
}

// Hash of settings, models and version. Stored runs with another fingerprint are stale.
std::string fingerprint(const RecognizerConfig& config, const std::string& models_hash) {
  std::string text = std::string(RESIGHT_VERSION) + "\n" + models_hash + "\n";
  for (const auto& [name, value] : config.to_settings()) text += name + "=" + value + "\n";
  return fmt::format("{:016x}", hash_text(text));
}

std::string hash_of_file(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  const std::vector<char> bytes{std::istreambuf_iterator<char>(stream), {}};
  return fmt::format("{:016x}", checksum_bytes({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()}));
}

std::vector<RecognizerConfig> make_configs(const EvaluateArguments& arguments) {
  std::vector<RecognizerConfig> configs;
  const std::vector<int> previous_views = parse_previous_views(arguments.previous_views);
  for (const std::string& preset : split(arguments.presets, ','))
    for (const bool clustered : {true, false}) {
      if (!clustered && !arguments.without_clustering) continue;
      for (const int k : previous_views) {
        RecognizerConfig config;
        try {
          config = make_config(preset, arguments.config, k, arguments.num_threads);
        } catch (const std::invalid_argument& error) {
          throw InputError(fmt::format("--presets: {}", error.what()));
        }
        if (arguments.seed) config.set_seed(*arguments.seed);
        if (!clustered) config.hypotheses.cluster.reset();
        configs.push_back(config);
      }
    }
  return configs;
}

}  // namespace

std::vector<int> parse_previous_views(const std::string& text) {
  const std::string expected = "numbers and ranges like 0-2,5";
  std::set<int> values;
  for (const std::string& part : split(text, ',')) {
    const std::size_t dash = part.find('-');
    const int low = to_int(part.substr(0, dash), "--previous-views", expected);
    const int high = dash == std::string::npos ? low : to_int(part.substr(dash + 1), "--previous-views", expected);
    if (high < low || high > 1000)
      throw InputError(fmt::format("--previous-views: '{}' ({} was expected)", part, expected));
    for (int k = low; k <= high; ++k) values.insert(k);
  }
  if (values.empty()) throw InputError(fmt::format("--previous-views: '{}' ({} was expected)", text, expected));
  return {values.begin(), values.end()};
}

void parse_shard(const std::string& text, int& shard, int& num_shards) {
  const std::string expected = "I/N with 1 <= I <= N";
  const std::size_t slash = text.find('/');
  if (slash == std::string::npos) throw InputError(fmt::format("--shard: '{}' ({} was expected)", text, expected));
  shard = to_int(text.substr(0, slash), "--shard", expected);
  num_shards = to_int(text.substr(slash + 1), "--shard", expected);
  if (shard < 1 || shard > num_shards) throw InputError(fmt::format("--shard: '{}' ({} was expected)", text, expected));
}

EvaluationPlan make_evaluation_plan(const EvaluateArguments& arguments) {
  EvaluationPlan plan;
  plan.dataset_name = fs::absolute(arguments.dataset / "").parent_path().filename().string();
  const std::string models_hash = hash_of_file(arguments.models);
  const std::vector<RecognizerConfig> configs = make_configs(arguments);
  int num_groups = 0;
  for (const EvaluationSequence& sequence : find_sequences(arguments.dataset)) {
    std::map<std::string, int> group_of;
    for (const RecognizerConfig& config : configs) {
      const auto [entry, is_new] = group_of.try_emplace(generation_settings(config), num_groups);
      num_groups += is_new ? 1 : 0;
      const std::string name = fmt::format("{}.{}.k{}{}", sequence.name, config.preset, config.num_previous_views,
                                           config.hypotheses.cluster ? "" : ".unclustered");
      plan.units.push_back({name, fingerprint(config, models_hash), sequence, config, entry->second,
                            entry->second % arguments.num_shards + 1});
    }
  }
  const fs::path data = plan.units.front().sequence.folder.parent_path();
  plan.models = (data.filename() == "test" ? data.parent_path() : data) / "models";
  std::ranges::stable_sort(plan.units, {}, &EvaluationUnit::group);
  return plan;
}

}  // namespace resight::app
