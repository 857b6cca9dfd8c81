// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include "resight/core/result.hpp"

namespace resight {

/// The outermost component of the path that does not exist; empty if the path exists.
[[nodiscard]] std::filesystem::path first_missing(const std::filesystem::path& path);

/// A temporary file or folder that becomes another one when it is complete, or is removed. Its name is that of the
/// final one with a dot before and ".resight-partial" behind. It is locked as long as its process lives: a process that
/// wants the same name knows by the lock whether the place is in use, or was left behind, and removes it.
class PendingPlace {
 public:
  enum class Kind { kFile, kFolder };

  /// Creates `folder` and the place in it. `wait_s`: how long another process may use the place before this fails. The
  /// error says why, without a name.
  [[nodiscard]] static Result<std::unique_ptr<PendingPlace>> create(const std::filesystem::path& folder,
                                                                    const std::string& name, Kind kind, double wait_s);
  PendingPlace(const PendingPlace&) = delete;
  PendingPlace& operator=(const PendingPlace&) = delete;
  /// Removes what was not moved away, and the folders that were created for it, as far as they are empty.
  ~PendingPlace();

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  /// The open file or folder.
  [[nodiscard]] int descriptor() const { return descriptor_; }
  /// Runs `move`, which moves the content to its final place, while no interruption can remove it.
  [[nodiscard]] Result<void> finish(const std::function<Result<void>()>& move);
  /// Whether it is no longer there to be removed: finish() has succeeded.
  [[nodiscard]] bool is_finished() const { return is_finished_; }

  /// Creates a place in the folder, under a name that no output has, and removes it.
  [[nodiscard]] static Result<void> try_out(const std::filesystem::path& folder);
  /// Same as clear(), but a place in use is no failure.
  [[nodiscard]] static Result<void> clear_unused(const std::filesystem::path& path);

  /// The name of the place for a final name.
  [[nodiscard]] static std::string name_for(const std::string& final_name);
  /// Removes what a process that no longer lives has left under this name. Fails if the place is in use, or not ours.
  [[nodiscard]] static Result<void> clear(const std::filesystem::path& path);
  /// Removes all places of this process. Other threads can create none afterwards: they wait for the end of the
  /// process.
  static void remove_all() noexcept;

 private:
  PendingPlace(std::filesystem::path path, int descriptor, std::filesystem::path first_made);
  void remove() noexcept;

  std::filesystem::path path_;
  int descriptor_;
  std::filesystem::path first_made_;  ///< The outermost folder that was created for it; empty if none.
  bool is_finished_ = false;
};

}  // namespace resight
