// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

/// One entry per reader of bytes that others have written.
namespace resight::fuzz {

struct FuzzReader {
  std::string_view name;
  std::function<std::vector<std::string>()> make_seeds;  ///< Small valid inputs.
  std::function<void(std::string_view)> read;            ///< Must return, whatever the bytes are.
  int num_short_runs = 3000;                             ///< Executions in the continuous integration.
  bool may_lose_memory = false;                          ///< Assimp does when it gives up a file.
};

[[nodiscard]] std::vector<FuzzReader> mesh_readers();
[[nodiscard]] std::vector<FuzzReader> image_readers();
[[nodiscard]] std::vector<FuzzReader> dataset_readers();
[[nodiscard]] std::vector<FuzzReader> sequence_readers();
[[nodiscard]] std::vector<FuzzReader> stored_readers();
[[nodiscard]] std::vector<FuzzReader> recording_readers();
[[nodiscard]] std::vector<FuzzReader> http_readers();

/// A folder of this process, for readers that take a path. $TMPDIR should be in memory.
[[nodiscard]] const std::filesystem::path& scratch_folder();
/// Writes a file there and returns its path.
std::filesystem::path write_scratch(std::string_view name, std::string_view bytes);
/// What `write` writes to the file that it is given.
[[nodiscard]] std::string bytes_written_by(std::string_view name,
                                           const std::function<void(const std::filesystem::path&)>& write);

/// Several files in one input, one after the other, with a separator between them.
[[nodiscard]] std::string join_files(std::span<const std::string> files);
/// Writes the parts of an input under these names, and removes the files of names without a part. Returns the folder.
const std::filesystem::path& write_bundle(std::string_view bytes, std::span<const char* const> names);

/// A small file of the source tree; throws if it is missing.
[[nodiscard]] std::string source_file(std::string_view path);

}  // namespace resight::fuzz
