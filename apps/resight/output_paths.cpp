// SPDX-License-Identifier: Apache-2.0
#include "output_paths.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>

#include "commands.hpp"
#include "resight/core/files.hpp"
#include "resight/core/input_file.hpp"

namespace resight::app {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse_output(const fs::path& out, std::string_view why) {
  throw InputError(file_error(out, why).message);
}

/// A link to nowhere exists, too: it would be replaced.
bool is_there(const fs::path& path) {
  std::error_code error;
  return fs::symlink_status(path, error).type() != fs::file_type::not_found;
}

void check_not_input(const fs::path& out, const Paths& inputs) {
  for (const fs::path& input : inputs) {
    std::error_code error;
    if (fs::equivalent(out, input, error)) refuse_output(out, "is an input of this command (choose another output)");
  }
}

/// Links on the way are resolved. A link at the end is not: the output takes its place.
fs::path place_of(const fs::path& out) {
  std::error_code error;
  const fs::path absolute = fs::absolute(out / "", error).parent_path();  // without a slash at the end
  if (absolute.filename() == "." || absolute.filename() == "..") return fs::weakly_canonical(absolute, error);
  return fs::weakly_canonical(absolute.parent_path(), error) / absolute.filename();
}

/// Files by which the results of a command are known, and how they begin. `recognize` writes changes.json, too, so it
/// comes first.
struct ResultsMark {
  std::string_view command;
  std::string_view file;
  std::string_view signature;
};
constexpr ResultsMark kResultsMarks[] = {{"recognize", "summary.json", "{\n \"version\": "},
                                         {"recognize", "finished_views.jsonl", "{\"view\":"},
                                         {"evaluate", "results.json", "{\n \"format\": \"resight evaluation"},
                                         {"check", "findings.json", "{\n \"path\": "},
                                         {"annotate", "annotation.jsonl", "{\"format\":\"resight annotation"},
                                         {"annotate", "proposals.json", "{\"digest\":"},
                                         {"changes", "changes.json", "{\n \"version\": "}};
constexpr std::string_view kRunSignature = "{\"sequence\":";

/// Also if it was cut off: the command may have been killed.
bool begins_with(const fs::path& file, std::string_view signature) {
  const auto start = read_file_start(file, signature.size());
  return start.ok() && signature.starts_with(*start);
}

bool is_hidden(const fs::path& path) { return path.filename().string().starts_with('.'); }

/// Runs that `evaluate` has stored before its tables: nothing else is in the folder `runs`. Before the first one,
/// `runs` is all that it has written.
bool holds_only_runs(const fs::path& folder) {
  std::error_code error;
  int num_runs = 0;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder / "runs", error)) {
    if (is_hidden(entry)) continue;
    if (!begins_with(entry, kRunSignature)) return false;
    ++num_runs;
  }
  if (error || num_runs > 0) return !error;
  return std::ranges::all_of(fs::directory_iterator(folder, error), [](const fs::directory_entry& entry) {
    return is_hidden(entry) || entry.path().filename() == "runs";
  });
}

/// The command whose results the folder holds; empty if none.
std::string_view find_writer(const fs::path& folder) {
  for (const ResultsMark& mark : kResultsMarks)
    if (begins_with(folder / mark.file, mark.signature)) return mark.command;
  return holds_only_runs(folder) ? "evaluate" : std::string_view();
}

/// A folder with the name of a file, such as report.html, would keep the file from its place after all the work. Our
/// results lie in the folder and one level below.
void check_names_of_folders(const fs::path& out) {
  constexpr std::array<std::string_view, 9> kExtensions = {".csv", ".html", ".jpg", ".json", ".jsonl",
                                                           ".md",  ".ply",  ".png", ".svg"};
  std::error_code error;
  for (fs::recursive_directory_iterator it(out, fs::directory_options::skip_permission_denied, error), end;
       !error && it != end; it.increment(error)) {
    if (it.depth() > 0) it.disable_recursion_pending();
    std::error_code unknown;
    const std::string extension = it->path().extension().string();
    const bool is_file_name = std::ranges::find(kExtensions, extension) != kExtensions.end();
    if (is_file_name && it->is_directory(unknown))
      refuse_output(it->path(), "is a folder (a file of this name may be written)");
  }
}

}  // namespace

void check_output_file(const fs::path& out, std::string_view signature, std::string_view kind, const Paths& inputs) {
  std::error_code error;
  if (fs::is_directory(out, error)) refuse_output(out, "is a folder (the name of a file was expected)");
  check_not_input(out, inputs);
  value_or_throw(check_writable(out));
  if (!is_there(out)) return;
  const auto start = read_file_start(out, signature.size());
  if (start.ok() && start->empty() && !fs::is_symlink(out, error)) return;  // nothing can be lost
  if (!start.ok() || *start != signature)
    refuse_output(out, fmt::format("exists already and is no {} (choose another name or delete it first)", kind));
}

void check_new_file(const fs::path& out) {
  if (is_there(out)) refuse_output(out, "exists already (choose another name or delete it first)");
  value_or_throw(check_writable(out));
}

void check_new_folder(const fs::path& out) { value_or_throw(check_writable_folder(out, ExistingFolder::kRefuse)); }

void check_apart(const Paths& outputs) {
  std::map<fs::path, fs::path> out_at;  // By its place.
  for (const fs::path& out : outputs)
    if (!out_at.emplace(place_of(out), out).second) refuse_output(out, "would be written twice (choose another name)");
  for (const auto& [place, out] : out_at)
    for (fs::path above = place.parent_path(); above.has_relative_path(); above = above.parent_path())
      if (out_at.contains(above))
        refuse_output(out, fmt::format("lies below another output, {} (choose another name)", above.string()));
}

void check_output_folder(const fs::path& out, std::string_view command, const Paths& inputs) {
  check_not_input(out, inputs);
  value_or_throw(check_writable_folder(out, ExistingFolder::kFill));
  check_names_of_folders(out);
  const std::string_view writer = find_writer(out);
  if (writer == command || check_writable_folder(out, ExistingFolder::kRefuse).ok()) return;
  if (!writer.empty()) refuse_output(out, fmt::format("holds results of 'resight {}' (choose another folder)", writer));
  refuse_output(out, fmt::format("holds files that are no results of 'resight {}' (choose another folder)", command));
}

std::string path_from(const fs::path& folder, const fs::path& path) {
  std::error_code error;
  const fs::path relative = fs::relative(path, folder, error);
  return error || relative.empty() ? fs::absolute(path).string() : relative.string();
}

}  // namespace resight::app
