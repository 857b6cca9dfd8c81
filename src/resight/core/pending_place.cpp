// SPDX-License-Identifier: Apache-2.0
#include "resight/core/internal/pending_place.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstdio>
#include <mutex>
#include <set>
#include <thread>
#include <utility>

#include "resight/core/hash.hpp"

namespace resight {
namespace {

namespace fs = std::filesystem;

constexpr const char* kInUse = "another command is writing it";

/// The places of this process.
struct PlaceRegistry {
  std::mutex mutex;
  std::set<PendingPlace*> places;
};

/// Never destroyed: an interruption may come while the process ends.
PlaceRegistry& registry() {
  static PlaceRegistry& only = *new PlaceRegistry;  // NOLINT(cppcoreguidelines-owning-memory)
  return only;
}

/// Removes created folders from the inside out, as far as they are empty.
void remove_empty_folders(const fs::path& innermost, const fs::path& outermost) {
  if (outermost.empty()) return;
  std::error_code error;
  for (fs::path folder = innermost;; folder = folder.parent_path())
    if (!fs::remove(folder, error) || folder == outermost) return;
}

/// Locks for this process alone. On file systems without locks, nobody is kept out.
bool lock_place(int descriptor) { return ::flock(descriptor, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK; }

/// Whether the open file or folder is still the one of this name. Another process may have taken it for a left-over
/// before it was locked, or may have moved it to its final name.
bool is_named(const fs::path& path, int descriptor) {
  struct stat named {};
  struct stat opened {};
  return ::lstat(path.c_str(), &named) == 0 && ::fstat(descriptor, &opened) == 0 && named.st_ino == opened.st_ino &&
         named.st_dev == opened.st_dev;
}

/// -1 and errno on failure, EEXIST if something has this name.
int create_place(const fs::path& path, PendingPlace::Kind kind) {
  if (kind == PendingPlace::Kind::kFile)
    // With O_EXCL, neither an existing file nor a link is opened.
    return ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
  if (::mkdir(path.c_str(), 0777) != 0) return -1;
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
  if (descriptor < 0) {
    const int reason = errno;
    ::rmdir(path.c_str());
    errno = reason;
  }
  return descriptor;
}

Error to_error(int code) { return Error{std::generic_category().message(code)}; }

struct OpenedPlace {
  int descriptor = -1;
  fs::path first_made;
};

/// Does not wait. `is_in_use` tells whether another try may succeed.
Result<OpenedPlace> open_place(const fs::path& path, PendingPlace::Kind kind, bool& is_in_use) {
  is_in_use = false;
  OpenedPlace opened;
  constexpr int kMaxAttempts = 100;  // Each fails only if another process interferes.
  bool is_refused = false;           // Folders such as /proc take no file, and say that it is missing.
  for (int attempt = 0; attempt < kMaxAttempts; ++attempt) {
    if (opened.first_made.empty()) opened.first_made = first_missing(path.parent_path());
    std::error_code error;
    fs::create_directories(path.parent_path(), error);
    if (error) {
      remove_empty_folders(path.parent_path(), opened.first_made);
      return Error{error.message()};
    }
    opened.descriptor = create_place(path, kind);
    is_refused = opened.descriptor < 0 && errno == ENOENT;
    if (is_refused) continue;  // its folder was removed meanwhile
    if (opened.descriptor < 0 && errno == EEXIST) {
      if (auto cleared = PendingPlace::clear(path); !cleared) {
        is_in_use = cleared.error().message == kInUse;
        return cleared.error();
      }
      continue;
    }
    if (opened.descriptor < 0) {
      const Error reason = to_error(errno);
      remove_empty_folders(path.parent_path(), opened.first_made);
      return reason;
    }
    if (lock_place(opened.descriptor) && is_named(path, opened.descriptor)) return opened;
    ::close(opened.descriptor);
  }
  if (is_refused) return to_error(ENOENT);
  is_in_use = true;
  return Error{kInUse};
}

}  // namespace

fs::path first_missing(const fs::path& path) {
  std::error_code error;
  fs::path missing;
  for (fs::path p = path; !p.empty() && !fs::exists(p, error) && p != p.root_path(); p = p.parent_path()) missing = p;
  return missing;
}

std::string PendingPlace::name_for(const std::string& final_name) {
  constexpr std::size_t kMaxShownBytes = 200;  // Leaves room for the rest.
  std::string shown = final_name;
  if (shown.size() > kMaxShownBytes)
    shown = shown.substr(0, kMaxShownBytes) + "-" + std::to_string(hash_text(final_name));
  return "." + shown + ".resight-partial";
}

Result<void> PendingPlace::clear(const fs::path& path) {
  struct stat shown {};
  if (::lstat(path.c_str(), &shown) != 0) return {};
  const bool is_folder = S_ISDIR(shown.st_mode);
  const Error foreign{path.filename().string() + " is in the way; delete it if no other command is running"};
  if ((!is_folder && !S_ISREG(shown.st_mode)) || shown.st_uid != ::geteuid()) return foreign;
  // Some file systems lock only what is open for writing.
  const int kind = is_folder ? O_RDONLY | O_DIRECTORY : O_RDWR;
  const int descriptor = ::open(path.c_str(), kind | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
  if (descriptor < 0) return errno == ENOENT ? Result<void>() : Result<void>(foreign);
  Result<void> cleared;
  if (::flock(descriptor, LOCK_EX | LOCK_NB) != 0) {
    cleared = errno == EWOULDBLOCK ? Error{kInUse} : foreign;
  } else if (is_named(path, descriptor)) {
    std::error_code error;
    fs::remove_all(path, error);
    if (error) cleared = foreign;
  }
  ::close(descriptor);
  return cleared;
}

Result<void> PendingPlace::clear_unused(const fs::path& path) {
  auto cleared = clear(path);
  return cleared || cleared.error().message == kInUse ? Result<void>() : cleared;
}

Result<std::unique_ptr<PendingPlace>> PendingPlace::create(const fs::path& folder, const std::string& name, Kind kind,
                                                           double wait_s) {
  const fs::path path = folder / name_for(name);
  const auto begin = std::chrono::steady_clock::now();
  for (;;) {
    bool is_in_use = false;
    {
      // Nothing is created while an interruption removes what there is.
      const std::lock_guard lock(registry().mutex);
      auto opened = open_place(path, kind, is_in_use);
      if (opened) {
        std::unique_ptr<PendingPlace> place(new PendingPlace(path, opened->descriptor, std::move(opened->first_made)));
        registry().places.insert(place.get());
        return place;
      }
      if (!is_in_use || std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count() >= wait_s)
        return opened.error();
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
}

Result<void> PendingPlace::try_out(const fs::path& folder) {
  const auto place = create(folder, "", Kind::kFolder, 0);
  return place || place.error().message == kInUse ? Result<void>() : place.error();
}

PendingPlace::PendingPlace(fs::path path, int descriptor, fs::path first_made)
    : path_(std::move(path)), descriptor_(descriptor), first_made_(std::move(first_made)) {}

PendingPlace::~PendingPlace() {
  const std::lock_guard lock(registry().mutex);
  registry().places.erase(this);
  if (!is_finished_) remove();
  ::close(descriptor_);
}

void PendingPlace::remove() noexcept {
  std::error_code error;
  // Another thread may add a folder meanwhile, if this is an interruption.
  constexpr int kMaxAttempts = 10;
  for (int attempt = 0; attempt < kMaxAttempts; ++attempt) {
    fs::remove_all(path_, error);
    if (!error) break;
  }
  remove_empty_folders(path_.parent_path(), first_made_);
}

Result<void> PendingPlace::finish(const std::function<Result<void>()>& move) {
  const std::lock_guard lock(registry().mutex);
  Result<void> moved = move();
  is_finished_ = moved.ok();
  return moved;
}

void PendingPlace::remove_all() noexcept {
  registry().mutex.lock();  // forever
  for (PendingPlace* place : registry().places)
    if (!place->is_finished_) place->remove();
}

}  // namespace resight
