// SPDX-License-Identifier: Apache-2.0
#include "evaluation_plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <map>
#include <set>
#include <sstream>

#include "folder_files.hpp"
#include "recognition_run.hpp"
#include "resight/core/files.hpp"
#include "resight/core/hash.hpp"
#include "resight/core/input_file.hpp"
#include "resight/core/unfinished_folder.hpp"
#include "resight/io/sequence.hpp"
#include "resight/io/tuw_ground_truth.hpp"
#include "resight/recognition/view_hypotheses.hpp"

namespace resight::app {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxNameBytes = 255 - std::string_view("..json.resight-partial").size();  // Of a run.

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

EvaluationSequence describe(const fs::path& folder, const Sequence& opened) {
  EvaluationSequence sequence;
  sequence.folder = folder;
  sequence.name = folder.filename().string();
  sequence.num_views = opened.num_views();
  const std::vector<std::string> views = view_names(opened);
  sequence.changes = find_change_files(folder, views);
  for (const fs::path& file : {sequence.changes.events, sequence.changes.changes})
    if (!file.empty()) value_or_throw(InputFile::open(file));
  sequence.annotations = find_tuw_annotation_directory(folder, views);
  sequence.unknown_models = folder.parent_path().parent_path() / "unknown" / "models";
  return sequence;
}

// Runs are stored by these names. Folders of the same name are told apart by their paths from the root.
void make_names_unique(const fs::path& root, std::vector<EvaluationSequence>& sequences) {
  std::map<std::string, int> num_folders;
  for (const EvaluationSequence& sequence : sequences) ++num_folders[sequence.name];
  std::set<std::string> taken;
  for (EvaluationSequence& sequence : sequences) {
    if (num_folders.at(sequence.name) > 1) {
      sequence.name = sequence.folder.lexically_relative(root).string();
      std::ranges::replace(sequence.name, '/', '_');
    }
    if (!taken.insert(sequence.name).second)
      throw InputError(
          fmt::format("{}: several sequences would be called '{}' (rename a folder)", root.string(), sequence.name));
  }
}

// The folders that may hold a sequence each. A link that leads nowhere might have led to one.
std::vector<fs::path> list_folders(const fs::path& root) {
  std::vector<fs::path> folders;
  std::error_code error;
  for (fs::directory_iterator it(root, error), end; !error && it != end; it.increment(error)) {
    std::error_code unreadable;
    if (it->path().filename().string().front() == '.') continue;
    if (it->is_directory(unreadable))
      folders.push_back(it->path());
    else if (it->is_symlink(unreadable) && !it->exists(unreadable))
      print_warning(file_error(it->path(), "is a link that leads nowhere; it is left out").message);
  }
  if (error) throw InputError(fmt::format("{}: cannot be listed ({})", root.string(), error.message()));
  std::ranges::sort(folders);
  std::set<fs::path> places;
  std::erase_if(folders, [&](const fs::path& folder) {
    std::error_code unknown;
    const bool is_new = places.insert(fs::canonical(folder, unknown)).second || unknown;
    if (!is_new) print_warning(file_error(folder, "is the same folder as another one; it is left out").message);
    return !is_new;
  });
  return folders;
}

bool is_sequence(const fs::path& folder) {
  const auto sequence = find_sequence_folder(folder);
  return sequence.ok() && *sequence == folder;
}

// BOP scenes for training are only evaluated by themselves.
bool is_training_split(const fs::path& folder) {
  return folder.filename().string().starts_with("train") && !is_sequence(folder);
}

// The root itself if it is a sequence, or those directly below it.
std::vector<fs::path> list_sequences(const fs::path& root) {
  if (is_sequence(root)) return {root};
  std::vector<fs::path> sequences;
  for (const fs::path& folder : list_folders(root)) {
    value_or_throw(check_finished(folder));  // Half a sequence would be passed over.
    if (is_training_split(folder)) continue;
    if (const auto sequence = value_or_throw(find_sequence_folder(folder))) sequences.push_back(*sequence);
  }
  if (!sequences.empty()) return sequences;
  const auto only = find_sequence_folder(root);
  return only.ok() && *only ? std::vector{**only} : sequences;
}

bool lies_in(const fs::path& path, const fs::path& folder) {
  std::error_code unknown;
  const fs::path relative = fs::canonical(path, unknown).lexically_relative(fs::canonical(folder, unknown));
  return !relative.empty() && *relative.begin() != "..";
}

// Sequences beside the folder test/ do not count. Training splits and models are not expected to.
void warn_about_others(const fs::path& dataset, const fs::path& test) {
  std::set<fs::path> others;
  std::error_code error;
  for (fs::directory_iterator it(dataset, error), end; !error && it != end; it.increment(error)) {
    std::error_code unreadable;
    const fs::path& folder = it->path();
    const std::string name = folder.filename().string();
    if (!it->is_directory(unreadable) || name.starts_with('.') || name.starts_with("models")) continue;
    if (is_training_split(folder)) continue;
    for (const fs::path& sequence : find_sequence_folders(folder))
      if (!lies_in(sequence, test)) others.insert(sequence);
  }
  if (others.empty()) return;
  const std::string what = others.size() == 1
                               ? "looks like a sequence, but is"
                               : fmt::format("and {} more look like sequences, but are", others.size() - 1);
  print_warning(fmt::format("{} {} not below {}: not evaluated", others.begin()->string(), what, test.string()));
}

// Finds the sequences: the data set itself, or those in its folder test/, or, without that, those directly below it. A
// damaged sequence, and several in one folder, are errors: scores without them would pass for those of the whole set.
std::vector<EvaluationSequence> find_sequences(const fs::path& given) {
  const fs::path dataset = fs::absolute(given / "").parent_path().lexically_normal();
  std::error_code error;
  if (!fs::is_directory(dataset, error)) throw InputError(fmt::format("{}: is not a folder", given.string()));
  const bool has_test = !is_sequence(dataset) && fs::is_directory(dataset / "test", error);
  const fs::path root = has_test ? dataset / "test" : dataset;
  std::vector<EvaluationSequence> sequences;
  for (const fs::path& folder : list_sequences(root)) {
    if (const auto any = open_sequence(folder); !any) throw InputError(any.error().message);
    const auto opened = open_posed_sequence(folder);
    if (opened)
      sequences.push_back(describe(folder, **opened));
    else
      print_warning(opened.error().message);
  }
  if (sequences.empty()) throw InputError(open_posed_sequence(root).error().message);
  if (has_test) warn_about_others(dataset, root);
  make_names_unique(root, sequences);
  return sequences;
}

// Chained with the hash before. A file that cannot be read counts as empty.
std::uint64_t hash_file(const fs::path& file, std::uint64_t hash) {
  constexpr std::size_t kBlockBytes = std::size_t{16} << 20;
  auto input = InputFile::open(file);
  if (!input) return checksum_bytes({}, hash);
  std::vector<std::uint8_t> block(std::min<std::uintmax_t>(input->size(), kBlockBytes));
  for (std::uintmax_t left = input->size(); left > 0; left -= block.size()) {
    block.resize(std::min<std::uintmax_t>(left, kBlockBytes));
    if (!input->read(block.data(), block.size())) return hash;
    hash = checksum_bytes(block, hash);
  }
  return hash;
}

// Names and contents of all files of a folder. One that does not exist counts as empty.
std::uint64_t hash_folder(const fs::path& folder, std::uint64_t hash, const fs::path& skipped = {}) {
  for (const fs::path& file : list_files(folder, skipped))
    hash = hash_file(file, hash_text(file.lexically_relative(folder).string(), hash));
  return hash;
}

// Names and symmetries of the true objects of a BOP data set, in the folders in which its reader looks for them.
std::uint64_t hash_object_names(const fs::path& sequence, std::uint64_t hash) {
  fs::path dataset = sequence;
  for (int level = 0; level < 3; ++level) {
    dataset = dataset.parent_path();
    for (const char* models : {"models", "models_eval", "models_cad", "models_fine"})
      hash = hash_file(dataset / models / "models_info.json", hash);
  }
  return hash;
}

// The models for BOP errors: those that the benchmark evaluates with, or else those of the data set. May not exist.
fs::path find_meshes(const fs::path& sequence) {
  fs::path dataset = sequence;
  for (int level = 0; level < 3; ++level) {
    dataset = dataset.parent_path();
    for (const char* models : {"models_eval", "models"})
      if (std::error_code error; fs::is_directory(dataset / models, error)) return dataset / models;
  }
  return sequence.parent_path().parent_path() / "models";
}

// The views and the truth of a sequence. Results may lie among them.
std::uint64_t hash_sequence(const EvaluationSequence& sequence, const fs::path& out, std::uint64_t hash) {
  hash = hash_object_names(sequence.folder, hash_folder(sequence.unknown_models, hash));
  hash = hash_file(sequence.changes.events, hash_folder(sequence.folder, hash, out));
  if (sequence.annotations != sequence.folder) hash = hash_folder(sequence.annotations, hash);
  return sequence.changes.changes.empty() ? hash : hash_file(sequence.changes.changes, hash);
}

// Stored runs with another fingerprint are stale.
std::string fingerprint(const RecognizerConfig& config, std::uint64_t hash) {
  std::string text;
  for (const auto& [name, value] : config.to_settings()) text += name + "=" + value + "\n";
  return fmt::format("{:016x}", hash_text(text, hash));
}

std::vector<RecognizerConfig> make_configs(const EvaluateArguments& arguments) {
  std::vector<RecognizerConfig> configs;
  std::vector<std::optional<int>> previous_views{std::nullopt};
  if (arguments.previous_views) {
    const std::vector<int> given = parse_previous_views(*arguments.previous_views);
    previous_views.assign(given.begin(), given.end());
  }
  std::vector<std::string> presets;
  for (const std::string& preset : split(arguments.presets, ','))
    if (std::ranges::find(presets, preset) == presets.end()) presets.push_back(preset);
  if (presets.empty()) throw InputError("--presets: '' (names like mvr,default were expected)");
  for (const std::string& preset : presets)
    for (const bool clustered : {true, false}) {
      if (!clustered && !arguments.without_clustering) continue;
      for (const std::optional<int> k : previous_views) {
        RecognizerConfig config;
        try {
          config = make_config(preset, arguments.config, k, arguments.num_threads);
        } catch (const std::invalid_argument& error) {
          throw InputError(fmt::format("--presets: {}", error.what()));
        } catch (const InputError& error) {
          throw InputError(fmt::format("{} (preset {})", error.what(), preset));
        }
        if (arguments.seed) config.set_seed(*arguments.seed);
        if (arguments.without_clustering && !config.hypotheses.cluster)
          throw InputError("--without-clustering: has no effect, because the settings do without clustering");
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
  const std::vector<RecognizerConfig> configs = make_configs(arguments);
  int num_groups = 0;
  const std::vector<EvaluationSequence> sequences = find_sequences(arguments.dataset);
  const std::uint64_t common_hash = hash_file(arguments.models, hash_file("/proc/self/exe", kHashSeed));
  for (const EvaluationSequence& sequence : sequences) {
    const std::uint64_t hash = hash_sequence(sequence, arguments.out, common_hash);
    std::map<std::string, int> group_of;
    for (const RecognizerConfig& config : configs) {
      const auto [entry, is_new] = group_of.try_emplace(generation_settings(config), num_groups);
      num_groups += is_new ? 1 : 0;
      const std::string name = fmt::format("{}.{}.k{}{}", sequence.name, config.preset, config.num_previous_views,
                                           config.hypotheses.cluster ? "" : ".unclustered");
      if (name.size() > kMaxNameBytes)
        throw InputError(file_error(sequence.folder, "has a name that is too long for files of results").message);
      plan.units.push_back(
          {name, fingerprint(config, hash), sequence, config, entry->second, entry->second % arguments.num_shards + 1});
    }
  }
  plan.models = find_meshes(plan.units.front().sequence.folder);
  std::ranges::stable_sort(plan.units, {}, &EvaluationUnit::group);
  return plan;
}

}  // namespace resight::app
