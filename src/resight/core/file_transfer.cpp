// SPDX-License-Identifier: Apache-2.0
#include "resight/core/internal/file_transfer.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <string>
#include <utility>

#include "resight/core/files.hpp"
#include "resight/core/input_file.hpp"
#include "resight/core/internal/write_all.hpp"
#include "resight/core/unfinished_folder.hpp"

namespace resight {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kJournalFormat = "resight unfinished 1";
constexpr std::string_view kBeside = "../";
constexpr std::string_view kPartialEnd = ".resight-partial";

std::string reason_of_transfer(const std::error_code& error) { return "cannot be written (" + error.message() + ")"; }

/// Tells a folder from its copies, and from a folder unpacked from the archive of a stranger.
std::string identity_of(const fs::path& folder) {
  struct stat status {};
  if (::stat(folder.c_str(), &status) != 0) return "";
  return std::to_string(status.st_dev) + " " + std::to_string(status.st_ino);
}

/// Splits at zero bytes, which no name holds.
std::vector<std::string> split_fields(std::string_view text) {
  std::vector<std::string> fields;
  for (std::size_t end = text.find('\0'); end != text.npos; end = text.find('\0')) {
    fields.emplace_back(text.substr(0, end));
    text.remove_prefix(end + 1);
  }
  return fields;
}

/// Keeps a folder locked. Without a descriptor, it was not there, or another process has it.
class FolderLock {
 public:
  explicit FolderLock(const fs::path& folder)
      : descriptor_(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC)) {}
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;
  ~FolderLock() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }
  [[nodiscard]] bool is_there() const { return descriptor_ >= 0; }
  [[nodiscard]] bool lock() const { return ::flock(descriptor_, LOCK_EX | LOCK_NB) == 0; }

 private:
  int descriptor_;
};

}  // namespace

FileTransfer::FileTransfer(fs::path from, fs::path to)
    : from_(std::move(from)), to_(std::move(to)), replaced_(from_ / ".replaced") {}

Result<void> FileTransfer::run() {
  if (auto begun = begin(); !begun) return begun;
  for (std::size_t i = 0; i < files_.size(); ++i)
    if (const std::error_code error = move(i); error) {
      for (std::size_t moved = i; moved-- > 0;) move_back(moved);
      remove_new_folders();
      std::error_code ignored;
      fs::remove(to_ / kTransferJournal, ignored);
      return file_error(to_ / files_[i], reason_of_transfer(error));
    }
  end();
  return {};
}

Result<void> FileTransfer::begin() {
  if (auto listed = list(); !listed) return listed;
  // The journal comes first: what it names and is not there yet is not undone.
  std::error_code error;
  fs::create_directory(replaced_, error);
  if (error) return file_error(to_, reason_of_transfer(error));
  if (auto written = write_journal(); !written) return written;
  for (const fs::path& folder : new_folders_)
    if (!error) fs::create_directory(to_ / folder, error);
  if (!error) return {};
  remove_new_folders();
  std::error_code ignored;
  fs::remove(to_ / kTransferJournal, ignored);
  return file_error(to_, reason_of_transfer(error));
}

void FileTransfer::end() {
  std::error_code ignored;
  fs::remove(to_ / kTransferJournal, ignored);  // From here on, the new files count.
  fs::remove_all(from_, ignored);
}

/// Checks before anything is moved that no file takes the place of a folder, nor a folder that of a file.
Result<void> FileTransfer::list() {
  std::error_code error;
  for (fs::recursive_directory_iterator it(from_, error), end; !error && it != end; it.increment(error)) {
    const fs::path name = it->path().lexically_relative(from_);
    const fs::file_status there = fs::status(to_ / name, error);
    error.clear();
    const bool is_folder = fs::is_directory(it->symlink_status());
    if (is_folder && fs::exists(there) && !fs::is_directory(there))
      return file_error(to_ / name, "is a file where a folder is to be written");
    if (!is_folder && fs::is_directory(there))
      return file_error(to_ / name, "is a folder where a file is to be written");
    if (!is_folder)
      files_.push_back(name);
    else if (!fs::exists(there))
      new_folders_.push_back(name);
  }
  if (error) return file_error(from_, "cannot be read (" + error.message() + ")");
  return {};
}

fs::path FileTransfer::replaced(std::size_t file) const { return replaced_ / std::to_string(file); }

std::error_code FileTransfer::move(std::size_t file) {
  std::error_code error;
  if (fs::exists(fs::symlink_status(to_ / files_[file], error)))
    fs::rename(to_ / files_[file], replaced(file), error);
  else
    error.clear();
  if (error) return error;
  fs::rename(from_ / files_[file], to_ / files_[file], error);
  std::error_code ignored;
  if (error && fs::exists(replaced(file), ignored)) fs::rename(replaced(file), to_ / files_[file], ignored);
  return error;
}

/// A file that was not moved stays where it is.
void FileTransfer::move_back(std::size_t file) const {
  std::error_code ignored;
  if (!fs::exists(fs::symlink_status(from_ / files_[file], ignored)))
    fs::rename(to_ / files_[file], from_ / files_[file], ignored);
  if (fs::exists(fs::symlink_status(replaced(file), ignored))) fs::rename(replaced(file), to_ / files_[file], ignored);
}

void FileTransfer::remove_new_folders() const {
  std::error_code ignored;
  for (auto folder = new_folders_.rbegin(); folder != new_folders_.rend(); ++folder)
    fs::remove(to_ / *folder, ignored);  // Only if it is empty.
}

Result<void> FileTransfer::write_journal() const {
  std::string text;
  const auto add = [&text](std::string_view field) { text.append(field).push_back('\0'); };
  add(kJournalFormat);
  add(identity_of(to_));
  add((from_.parent_path() == to_ ? "" : kBeside.data()) + from_.filename().string());
  add(std::to_string(new_folders_.size()));
  for (const fs::path& folder : new_folders_) add(folder.native());
  for (const fs::path& file : files_) add(file.native());
  const fs::path journal = to_ / kTransferJournal;
  const int descriptor = ::open(journal.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
  int code = descriptor < 0 ? errno : write_all(descriptor, text);
  if (code == 0) code = sync_file(descriptor);
  if (descriptor >= 0) ::close(descriptor);
  if (code == 0) {
    sync_folder(to_);
    return {};
  }
  std::error_code ignored;
  if (descriptor >= 0) fs::remove(journal, ignored);
  return file_error(journal, reason_of_transfer({code, std::generic_category()}));
}

/// Names come from a file that anybody may have made: no path out of the folder, and no way through a link.
bool FileTransfer::is_inside(const fs::path& name) const {
  if (name.empty() || name.is_absolute() || name.lexically_normal() != name || *name.begin() == "..") return false;
  fs::path folder = to_;
  for (const fs::path& part : name.parent_path()) {
    folder /= part;
    std::error_code error;
    const fs::file_status status = fs::symlink_status(folder, error);
    if (fs::exists(status) && !fs::is_directory(status)) return false;
  }
  return true;
}

bool FileTransfer::read_journal() {
  const auto text = read_file(to_ / kTransferJournal);
  const std::vector<std::string> fields = text ? split_fields(*text) : std::vector<std::string>();
  constexpr std::size_t kNumHeaderFields = 4;
  if (fields.size() < kNumHeaderFields || fields[0] != kJournalFormat || fields[1] != identity_of(to_)) return false;
  const bool is_beside = fields[2].starts_with(kBeside);
  const fs::path hidden = fields[2].substr(is_beside ? kBeside.size() : 0);
  std::size_t num_folders = 0;
  std::from_chars(fields[3].data(), fields[3].data() + fields[3].size(), num_folders);
  if (hidden.has_parent_path() || !hidden.native().starts_with('.') || !hidden.native().ends_with(kPartialEnd) ||
      num_folders > fields.size() - kNumHeaderFields)
    return false;
  from_ = (is_beside ? to_.parent_path() : to_) / hidden;
  replaced_ = from_ / ".replaced";
  const auto first_file = fields.begin() + kNumHeaderFields + static_cast<std::ptrdiff_t>(num_folders);
  new_folders_.assign(fields.begin() + kNumHeaderFields, first_file);
  files_.assign(first_file, fields.end());
  for (const auto* names : {&new_folders_, &files_})
    for (const fs::path& name : *names)
      if (!is_inside(name)) return false;
  return true;
}

Result<void> FileTransfer::undo(const fs::path& to) {
  std::error_code error;
  if (!fs::exists(fs::symlink_status(to / kTransferJournal, error))) return {};
  const Error mixture = file_error(to, "holds a mixture of old and new files, which a command has left; delete it");
  FileTransfer transfer({}, to);
  if (!transfer.read_journal()) return mixture;
  const FolderLock hidden(transfer.from_);
  if (!hidden.is_there()) return mixture;  // Somebody has removed what was to be moved back.
  if (!hidden.lock()) return {};           // It is still at work, which the next step notices.
  for (std::size_t i = transfer.files_.size(); i-- > 0;) transfer.move_back(i);
  transfer.remove_new_folders();
  fs::remove(transfer.replaced_, error);
  fs::remove(to / kTransferJournal, error);
  if (error) return file_error(to, reason_of_transfer(error));
  return {};
}

Result<void> check_finished(const fs::path& folder) {
  std::error_code error;
  fs::path inner = fs::absolute(folder, error).lexically_normal();
  for (fs::path outer; inner != outer; outer = std::exchange(inner, inner.parent_path()))
    if (fs::exists(fs::symlink_status(inner / kTransferJournal, error)))
      return file_error(inner,
                        "is not finished: a command is writing it, or was killed while it did (run that command "
                        "again)");
  return {};
}

}  // namespace resight
