// SPDX-License-Identifier: Apache-2.0
#include "resight/io/change_files.hpp"

#include <algorithm>

#include "resight/io/internal/files.hpp"
#include "resight/io/internal/text.hpp"
#include "resight/io/tuw_ground_truth.hpp"

namespace resight {
namespace {

using io::fs::path;

/// Links that lead nowhere and pipes count. Reading them fails; without them, the sequence would have no changes.
bool is_no_folder(const path& candidate) {
  std::error_code error;
  return io::fs::exists(io::fs::symlink_status(candidate, error)) && !io::is_folder(candidate);
}

path first_file(const std::vector<path>& candidates) {
  const auto found = std::ranges::find_if(candidates, is_no_folder);
  return found == candidates.end() ? path() : *found;
}

// The file `*.changes` of a folder, if there is exactly one.
path only_changes_file(const path& folder) {
  path found;
  for (const std::string& name : io::list_files(folder)) {
    if (io::extension_of(name) != "changes") continue;
    if (!found.empty()) return {};
    found = folder / name;
  }
  return found;
}

// The folders must be absolute and normal: the parent of a link is the folder that holds the link.
path find_changes_file(const path& sequence, const path& annotations) {
  const std::string file = sequence.filename().string() + ".changes";
  const path test = sequence.parent_path();
  std::vector<path> candidates;
  for (const path& folder : {sequence, test, annotations, annotations.parent_path()})
    candidates.push_back(folder / file);
  for (const path& set : {test, test.parent_path()}) {
    candidates.push_back(set / file);
    for (const std::string& folder : io::list_directories(set))
      if (io::to_lower(folder).ends_with("changes")) candidates.push_back(set / folder / file);
  }
  candidates.push_back(only_changes_file(sequence));
  candidates.push_back(only_changes_file(annotations));
  return first_file(candidates);
}

}  // namespace

ChangeFiles find_change_files(const path& sequence, const std::vector<std::string>& views) {
  const path folder = (io::fs::absolute(sequence) / "").lexically_normal().parent_path();
  const path test = folder.parent_path();
  std::vector<path> events{folder / "events.json", test / (folder.filename().string() + ".events.json")};
  // The file of a data set does not name a sequence, so it counts only if there is one.
  if (io::list_directories(test).size() == 1) events.push_back(test.parent_path() / "events.json");
  return {first_file(events), find_changes_file(folder, find_tuw_annotation_directory(folder, views))};
}

}  // namespace resight
