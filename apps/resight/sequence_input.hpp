// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "resight/inspection/finding.hpp"
#include "resight/io/change_files.hpp"
#include "resight/io/model_source.hpp"
#include "resight/io/sequence.hpp"

namespace CLI {
class App;
}

namespace resight::app {

/// Options of the command line for a sequence that does not say everything itself. `given`: if not null, gets those
/// that the user gives, as name and value in turn.
void add_sequence_options(CLI::App* command, OpenSequenceOptions& options, std::vector<std::string>* given = nullptr);
/// Such options from the names and values that results keep. Throws an InputError.
[[nodiscard]] OpenSequenceOptions parse_sequence_options(std::vector<std::string> given);
/// --poses, where a command does not define it otherwise.
void add_pose_file_option(CLI::App* command, OpenSequenceOptions& options);

/// Prints what was assumed or left out to standard error.
void print_notes(const Sequence& sequence, const std::string& name = "");
/// Warns about faults, one line each on standard error. `name`: tells several sequences apart.
void warn_about(const std::vector<Finding>& findings, const std::string& name = "");
/// The same for faults that few views show (check_quickly()).
void warn_about_faults(const Sequence& sequence, bool uses_poses, const std::string& name = "");
/// Opens a sequence and prints its notes to standard error. Throws an InputError.
[[nodiscard]] std::unique_ptr<Sequence> open_input(const std::filesystem::path& where,
                                                   const OpenSequenceOptions& options);
/// Same for uses that need camera poses.
[[nodiscard]] std::unique_ptr<Sequence> open_posed_input(const std::filesystem::path& where,
                                                         const OpenSequenceOptions& options);

/// The files that state the true changes of a sequence. They number all views of its folder.
struct TrueChangeFiles {
  ChangeFiles files;
  bool sequence_lacks_views = false;  ///< The options leave views of the folder out, so that the numbers do not apply.
};
/// Those of `sequence`, which was opened at `where` with these options. Throws an InputError.
[[nodiscard]] TrueChangeFiles find_true_changes(const std::filesystem::path& where, OpenSequenceOptions options,
                                                const Sequence& sequence);

/// Models that `where` holds although it is no sequence. If one of its files is to blame, such as a damaged
/// models_info.json, throws an InputError that names it. None if there is nothing of the kind.
[[nodiscard]] std::optional<std::vector<ModelLocation>> find_models_to_show(const std::filesystem::path& where);

}  // namespace resight::app
