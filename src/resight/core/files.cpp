// SPDX-License-Identifier: Apache-2.0
#include "resight/core/files.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <climits>
#include <cstdio>
#include <system_error>
#include <utility>

#include "resight/core/check.hpp"
#include "resight/core/internal/file_transfer.hpp"
#include "resight/core/internal/pending_place.hpp"
#include "resight/core/internal/write_all.hpp"
#include "resight/core/output_file.hpp"

namespace resight {
namespace {

namespace fs = std::filesystem;

/// Makes the path absolute and removes a trailing slash, which filename() and parent_path() require. What ".." means is
/// asked of the file system: behind a link, it is not the folder that the text names. Empty if it means nothing.
fs::path clean_path(const fs::path& path) {
  std::error_code error;
  fs::path clean;
  for (const fs::path& part : fs::absolute(path, error)) {
    if (part != ".." && part != "." && !part.empty()) clean /= part;
    if (part == "..") clean = fs::canonical(clean / part, error);
    if (error) return {};
  }
  return clean;
}

constexpr std::string_view kNoSuchFolder = "cannot be written (it leads through a folder that does not exist)";

std::string reason_of(const std::error_code& error) { return "cannot be written (" + error.message() + ")"; }

/// Whether the folder holds anything but the hidden folder of this name.
bool is_filled(const fs::path& folder, const fs::path& hidden) {
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error))
    if (it->path().filename() != hidden) return true;
  return static_cast<bool>(error);
}

/// Moves a complete folder to its final place, which is new or empty.
Result<void> move_to_new(const fs::path& pending, const fs::path& target) {
  const Error filled = file_error(target, "was filled by another program meanwhile; choose another folder");
  if (pending.parent_path() == target)
    return is_filled(target, pending.filename()) ? filled : FileTransfer(pending, target).run();
  if (std::rename(pending.c_str(), target.c_str()) == 0) return {};
  if (errno == ENOTEMPTY || errno == EEXIST) return filled;
  return file_error(target, reason_of({errno, std::generic_category()}));
}

}  // namespace

void sync_folder(const fs::path& folder) {
  const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return;
  ::fsync(descriptor);
  ::close(descriptor);
}

int sync_file(int descriptor) { return ::fsync(descriptor) == 0 || errno == EINVAL ? 0 : errno; }

int write_all(int descriptor, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t count = ::write(descriptor, bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return errno;
    bytes.remove_prefix(static_cast<std::size_t>(count));
  }
  return 0;
}

Error file_error(const fs::path& file, std::string_view what) {
  return Error{file.string() + ": " + std::string(what)};
}

std::string folder_name(const fs::path& directory) {
  std::error_code error;
  return (fs::absolute(directory, error) / "").lexically_normal().parent_path().filename().string();
}

Result<void> check_writable(const fs::path& path) {
  if (path.empty()) return Error{"the name of the output is empty"};
  const fs::path target = clean_path(path);
  if (target.empty()) return file_error(path, kNoSuchFolder);
  const fs::path missing = first_missing(target);
  const fs::path folder = missing.empty() ? target : missing.parent_path();  // the innermost existing folder
  std::error_code error;
  if (!missing.empty() && fs::is_symlink(missing, error))
    return file_error(path, "cannot be written (" + missing.string() + " is a link that leads nowhere)");
  if (!missing.empty() && !fs::is_directory(folder, error))
    return file_error(path, "cannot be written (" + folder.string() + " is not a folder)");
  for (const fs::path& part : target.lexically_relative(folder))
    if (part.native().size() > NAME_MAX) return file_error(path, "cannot be written (its name is too long)");
  // A file is replaced by a new one, which its folder must allow.
  const bool is_file = missing.empty() && !fs::is_directory(target, error);
  if (::access(folder.c_str(), W_OK) != 0 || (is_file && ::access(target.parent_path().c_str(), W_OK | X_OK) != 0))
    return file_error(
        path, errno == EROFS ? "cannot be written (the disk is read-only)" : "cannot be written (no permission)");
  // Some file systems, such as /proc, take nothing whatever the permissions say: only a trial tells.
  if (auto taken = PendingPlace::try_out(is_file ? target.parent_path() : folder); !taken)
    return file_error(path, "cannot be written (" + taken.error().message + ")");
  // A killed command was moving files from this place. FileTransfer::undo() moves them back first.
  if (fs::exists(fs::symlink_status(target / kTransferJournal, error))) return {};
  const std::string place = PendingPlace::name_for(target.filename().string());
  if (auto cleared = PendingPlace::clear_unused(target.parent_path() / place); !cleared)
    return file_error(path, "cannot be written (" + cleared.error().message + ")");
  return {};
}

Result<void> check_writable_folder(const fs::path& path, ExistingFolder existing) {
  if (auto writable = check_writable(path); !writable) return writable;
  const fs::path target = clean_path(path);
  std::error_code error;
  if (!fs::exists(target, error)) return {};
  if (!fs::is_directory(target, error)) return file_error(path, "exists already and is not a folder");
  if (auto undone = FileTransfer::undo(target); !undone) return undone;
  if (existing == ExistingFolder::kRefuse && is_filled(target, PendingPlace::name_for(target.filename().string())))
    return file_error(path, "exists already; choose another folder or delete it first");
  return {};
}

Result<void> write_file(const fs::path& file, std::string_view bytes) {
  return write_file(file, std::initializer_list<std::string_view>{bytes});
}

Result<void> write_file(const fs::path& file, std::initializer_list<std::string_view> parts) {
  auto out = OutputFile::create(file);
  if (!out) return out.error();
  for (const std::string_view bytes : parts)
    if (auto written = out->append(bytes); !written) return written;
  return out->commit();
}

Result<OutputFile> OutputFile::create(const fs::path& file) {
  constexpr double kWait_s = 10;  // Another process that writes the same file is soon done.
  const fs::path target = clean_path(file);
  if (target.empty()) return file_error(file, kNoSuchFolder);
  auto place =
      PendingPlace::create(target.parent_path(), target.filename().string(), PendingPlace::Kind::kFile, kWait_s);
  if (!place) return file_error(file, "cannot be written (" + place.error().message + ")");
  return OutputFile(file, std::move(*place));
}

OutputFile::OutputFile(fs::path file, std::unique_ptr<PendingPlace> place)
    : file_(std::move(file)), place_(std::move(place)) {}
OutputFile::OutputFile(OutputFile&& other) noexcept = default;
OutputFile& OutputFile::operator=(OutputFile&& other) noexcept = default;
OutputFile::~OutputFile() = default;

Error OutputFile::fail_with(int code) const { return file_error(file_, reason_of({code, std::generic_category()})); }

Result<void> OutputFile::append(std::string_view bytes) {
  if (const int code = write_all(place_->descriptor(), bytes); code != 0) return fail_with(code);
  return {};
}

Result<void> OutputFile::commit() {
  if (const int code = sync_file(place_->descriptor()); code != 0) return fail_with(code);
  return place_->finish([&]() -> Result<void> {
    if (std::rename(place_->path().c_str(), clean_path(file_).c_str()) != 0) return fail_with(errno);
    return {};
  });
}

Result<PendingDirectory> PendingDirectory::create(const fs::path& final_path, ExistingFolder existing, double wait_s) {
  if (auto writable = check_writable_folder(final_path, existing); !writable) return writable.error();
  const fs::path target = clean_path(final_path);
  const std::string name = target.filename().string();
  std::error_code error;
  const bool exists = fs::exists(target, error);
  // Another command may have begun when the folder did not exist yet.
  if (exists)
    if (auto cleared = PendingPlace::clear(target.parent_path() / PendingPlace::name_for(name)); !cleared)
      return file_error(final_path, "cannot be written (" + cleared.error().message + ")");
  auto place = PendingPlace::create(exists ? target : target.parent_path(), name, PendingPlace::Kind::kFolder, wait_s);
  if (!place) return file_error(final_path, "cannot be created (" + place.error().message + ")");
  return PendingDirectory(target, existing, std::move(*place));
}

PendingDirectory::PendingDirectory(fs::path final_path, ExistingFolder existing, std::unique_ptr<PendingPlace> place)
    : final_(std::move(final_path)), existing_(existing), place_(std::move(place)) {}
PendingDirectory::PendingDirectory(PendingDirectory&& other) noexcept = default;
PendingDirectory& PendingDirectory::operator=(PendingDirectory&& other) noexcept = default;
PendingDirectory::~PendingDirectory() = default;

const fs::path& PendingDirectory::path() const { return place_->path(); }

Result<void> PendingDirectory::commit() {
  require(place_ != nullptr && !place_->is_finished(), "PendingDirectory::commit: called twice");
  return place_->finish([&]() -> Result<void> {
    std::error_code error;
    if (existing_ == ExistingFolder::kRefuse || !fs::exists(final_, error)) return move_to_new(path(), final_);
    return FileTransfer(path(), final_).run();
  });
}

void remove_pending_files() noexcept { PendingPlace::remove_all(); }

}  // namespace resight
