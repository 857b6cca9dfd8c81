// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <initializer_list>
#include <memory>
#include <string>
#include <string_view>

#include "resight/core/result.hpp"

namespace resight {

/// Formats an error message about a file: "<file>: <what>".
[[nodiscard]] Error file_error(const std::filesystem::path& file, std::string_view what);

/// The last component of a path. Paths such as "a/b/" and "." are made absolute first.
[[nodiscard]] std::string folder_name(const std::filesystem::path& directory);

/// Checks before long work whether a file or folder can be created under this name, parent folders included. Tries it
/// out under a hidden temporary name, of which nothing remains. An existing file may be overwritten and an existing
/// folder may be filled, also one that another process is writing.
[[nodiscard]] Result<void> check_writable(const std::filesystem::path& path);

/// Writes `bytes` under a hidden temporary name beside `file`, then renames it. Creates the folder if it is missing.
/// Waits for another process that writes the same file, and removes what one that was killed has left.
[[nodiscard]] Result<void> write_file(const std::filesystem::path& file, std::string_view bytes);
/// Writes the parts one after the other.
[[nodiscard]] Result<void> write_file(const std::filesystem::path& file, std::initializer_list<std::string_view> parts);

/// Writes the entries of a folder to the disk, so that its new files survive a power failure. Ignores errors: some file
/// systems cannot.
void sync_folder(const std::filesystem::path& folder);
/// Writes the content of an open file to the disk. Returns 0, also for what cannot be synced, such as a pipe, or the
/// error number.
[[nodiscard]] int sync_file(int descriptor);

/// Behaviour of PendingDirectory if the folder exists and is not empty.
enum class ExistingFolder {
  kRefuse,  ///< Fails, so that no data are overwritten.
  kFill,    ///< Adds files and replaces those of the same name.
};

/// Same as check_writable(), for a folder that PendingDirectory is to create or to fill.
[[nodiscard]] Result<void> check_writable_folder(const std::filesystem::path& path, ExistingFolder existing);

class PendingPlace;

/// A folder that is filled under a hidden temporary name. The temporary folder lies beside the final one or, if that
/// exists, inside it. Files appear under the final name only with commit(), all or none; without it, nothing remains.
/// What a process that was killed has left is removed by the next one that writes to the same folder.
class PendingDirectory {
 public:
  /// Creates the hidden folder, and the parent folders of `final_path`. Fails if these cannot be written, if
  /// `final_path` is a file, or (with kRefuse) a folder that is not empty, or if another process is filling it for
  /// longer than `wait_s`.
  [[nodiscard]] static Result<PendingDirectory> create(const std::filesystem::path& final_path,
                                                       ExistingFolder existing = ExistingFolder::kRefuse,
                                                       double wait_s = 0);
  PendingDirectory(PendingDirectory&& other) noexcept;
  PendingDirectory& operator=(PendingDirectory&& other) noexcept;
  ~PendingDirectory();
  /// The hidden folder, to be filled.
  [[nodiscard]] const std::filesystem::path& path() const;
  [[nodiscard]] const std::filesystem::path& final_path() const { return final_; }
  /// Moves the files to final_path(). May be called once. Fails with kRefuse if another process has filled it
  /// meanwhile.
  [[nodiscard]] Result<void> commit();

 private:
  PendingDirectory(std::filesystem::path final_path, ExistingFolder existing, std::unique_ptr<PendingPlace> place);
  std::filesystem::path final_;
  ExistingFolder existing_;
  std::unique_ptr<PendingPlace> place_;  ///< Null after a move.
};

/// Removes all temporary files and folders of this process, as before a signal ends it. Nothing can be written
/// afterwards: other threads that try wait for the end of the process.
void remove_pending_files() noexcept;

}  // namespace resight
