// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <memory>
#include <string_view>

#include "resight/core/result.hpp"

namespace resight {

class PendingPlace;

/// A file that is written in parts, so that it need not be in memory as a whole. It appears under its name with
/// commit(), replacing an older one; without it, nothing remains. Errors name the file.
class OutputFile {
 public:
  /// Creates the hidden temporary file, and its folder if it is missing. Waits up to 10 s for another process that
  /// writes the same file.
  [[nodiscard]] static Result<OutputFile> create(const std::filesystem::path& file);
  OutputFile(OutputFile&& other) noexcept;
  OutputFile& operator=(OutputFile&& other) noexcept;
  ~OutputFile();
  [[nodiscard]] Result<void> append(std::string_view bytes);
  /// May be called once. The content is on the disk before the name is: after a power failure, the old or the new file
  /// is there.
  [[nodiscard]] Result<void> commit();

 private:
  OutputFile(std::filesystem::path file, std::unique_ptr<PendingPlace> place);
  [[nodiscard]] Error fail_with(int code) const;
  std::filesystem::path file_;           ///< As the caller names it.
  std::unique_ptr<PendingPlace> place_;  ///< Null after a move.
};

}  // namespace resight
