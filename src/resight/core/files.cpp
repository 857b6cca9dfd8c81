// SPDX-License-Identifier: Apache-2.0
#include "resight/core/files.hpp"

#include <fcntl.h>
#include <sys/random.h>
#include <unistd.h>

#include <cerrno>
#include <climits>
#include <cstdint>
#include <cstdio>
#include <random>
#include <system_error>
#include <utility>
#include <vector>

namespace resight {
namespace {

namespace fs = std::filesystem;

/// A hidden name in `folder` that nobody can guess, so that nobody can place a link there. Long names are cut.
fs::path temporary_name(const fs::path& folder, const std::string& name) {
  constexpr std::size_t kMaxShownBytes = 100;
  std::uint64_t number = 0;
  if (::getrandom(&number, sizeof(number), 0) != static_cast<ssize_t>(sizeof(number))) number = std::random_device{}();
  std::string hidden(1, '.');
  hidden.append(name, 0, kMaxShownBytes).append(".partial-").append(std::to_string(number));
  return folder / hidden;
}

/// Makes the path absolute and removes a trailing slash, which filename() and parent_path() require.
fs::path clean_path(const fs::path& path) {
  std::error_code error;
  fs::path clean = fs::absolute(path, error).lexically_normal();
  if (!clean.has_filename()) clean = clean.parent_path();
  return clean;
}

/// The outermost component of the path that does not exist; empty if the path exists.
fs::path first_missing(const fs::path& path) {
  std::error_code error;
  fs::path missing;
  for (fs::path p = path; !p.empty() && !fs::exists(p, error) && p != p.root_path(); p = p.parent_path()) missing = p;
  return missing;
}

/// Moves entry by entry, so that a folder that cannot be replaced (a mount point, the current folder) can be filled.
std::error_code move_entries(const fs::path& from, const fs::path& to) {
  std::error_code error;
  std::vector<fs::path> names;
  for (fs::directory_iterator it(from, error), end; !error && it != end; it.increment(error))
    names.push_back(it->path().filename());
  for (const fs::path& name : names)
    if (!error) fs::rename(from / name, to / name, error);
  if (!error) fs::remove(from, error);
  return error;
}

/// A new file, open for writing, that is removed unless it is renamed.
class PendingFile {
 public:
  explicit PendingFile(fs::path path)
      : path_(std::move(path)),
        // With O_EXCL, neither an existing file nor a link is opened.
        descriptor_(::open(path_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666)) {}
  PendingFile(const PendingFile&) = delete;
  PendingFile& operator=(const PendingFile&) = delete;
  ~PendingFile() {
    if (descriptor_ < 0) return;
    ::close(descriptor_);
    if (!is_renamed_) ::unlink(path_.c_str());
  }

  [[nodiscard]] bool is_open() const { return descriptor_ >= 0; }
  bool write(std::string_view bytes) {
    while (!bytes.empty()) {
      const ssize_t count = ::write(descriptor_, bytes.data(), bytes.size());
      if (count < 0 && errno == EINTR) continue;
      if (count <= 0) return false;
      bytes.remove_prefix(static_cast<std::size_t>(count));
    }
    return true;
  }
  /// The content must be on the disk before the name is: after a power failure, the old or the new file is there.
  bool rename(const fs::path& target) {
    if (::fsync(descriptor_) != 0 && errno != EINVAL) return false;
    is_renamed_ = std::rename(path_.c_str(), target.c_str()) == 0;
    return is_renamed_;
  }

 private:
  fs::path path_;
  int descriptor_;
  bool is_renamed_ = false;
};

}  // namespace

Error file_error(const fs::path& file, std::string_view what) {
  return Error{file.string() + ": " + std::string(what)};
}

std::string folder_name(const fs::path& directory) { return clean_path(directory).filename().string(); }

Result<void> check_writable(const fs::path& path) {
  const fs::path target = clean_path(path);
  const fs::path missing = first_missing(target);
  const fs::path folder = missing.empty() ? target : missing.parent_path();  // the innermost existing folder
  std::error_code error;
  if (!missing.empty() && !fs::is_directory(folder, error))
    return file_error(path, "cannot be written (" + folder.string() + " is not a folder)");
  if (target.filename().native().size() > NAME_MAX) return file_error(path, "cannot be written (its name is too long)");
  if (::access(folder.c_str(), W_OK) != 0) return file_error(path, "cannot be written (no permission)");
  return {};
}

Result<void> write_file(const fs::path& file, std::string_view bytes) {
  return write_file(file, std::initializer_list<std::string_view>{bytes});
}

Result<void> write_file(const fs::path& file, std::initializer_list<std::string_view> parts) {
  const fs::path target = clean_path(file);
  std::error_code error;
  fs::create_directories(target.parent_path(), error);
  if (error) return file_error(target.parent_path(), "cannot be created (" + error.message() + ")");
  const auto fail = [&](int code) {
    return file_error(file, "cannot be written (" + std::generic_category().message(code) + ")");
  };
  PendingFile pending(temporary_name(target.parent_path(), target.filename().string()));
  if (!pending.is_open()) return fail(errno);
  for (const std::string_view bytes : parts)
    if (!pending.write(bytes)) return fail(errno);
  if (!pending.rename(target)) return fail(errno);
  return {};
}

Result<PendingDirectory> PendingDirectory::create(const fs::path& final_path, ExistingFolder existing) {
  const fs::path target = clean_path(final_path);
  std::error_code error;
  const bool exists = fs::exists(target, error);
  if (exists && !fs::is_directory(target, error)) return file_error(final_path, "exists already and is not a folder");
  if (exists && existing == ExistingFolder::kRefuse && !fs::is_empty(target, error))
    return file_error(final_path, "exists already; choose another folder or delete it first");
  fs::path first_made = first_missing(target.parent_path());
  const fs::path pending = temporary_name(exists ? target : target.parent_path(), target.filename().string());
  fs::create_directories(pending.parent_path(), error);
  if (!error && !fs::create_directory(pending, error) && !error) error = std::make_error_code(std::errc::file_exists);
  if (error) return file_error(final_path, "cannot be created (" + error.message() + ")");
  return PendingDirectory(target, pending, std::move(first_made));
}

PendingDirectory::PendingDirectory(PendingDirectory&& other) noexcept
    : final_(std::move(other.final_)),
      pending_(std::exchange(other.pending_, {})),
      first_made_(std::move(other.first_made_)) {}

PendingDirectory& PendingDirectory::operator=(PendingDirectory&& other) noexcept {
  if (this != &other) {
    discard();
    final_ = std::move(other.final_);
    pending_ = std::exchange(other.pending_, {});
    first_made_ = std::move(other.first_made_);
  }
  return *this;
}

PendingDirectory::~PendingDirectory() { discard(); }

void PendingDirectory::discard() noexcept {
  if (pending_.empty()) return;
  std::error_code error;
  fs::remove_all(pending_, error);
  pending_.clear();
  if (first_made_.empty()) return;
  // Removes created folders from the inside out, as far as they are empty.
  for (fs::path folder = final_.parent_path();; folder = folder.parent_path()) {
    if (!fs::remove(folder, error) || folder == first_made_) return;
  }
}

Result<void> PendingDirectory::commit() {
  require(!pending_.empty(), "PendingDirectory::commit: called twice");
  std::error_code error;
  if (fs::exists(final_, error))
    error = move_entries(pending_, final_);
  else
    fs::rename(pending_, final_, error);
  if (error) return file_error(final_, "cannot be written (" + error.message() + ")");
  pending_.clear();
  return {};
}

}  // namespace resight
