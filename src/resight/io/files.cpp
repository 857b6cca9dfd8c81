// SPDX-License-Identifier: Apache-2.0
#include "resight/io/internal/files.hpp"

#include <algorithm>
#include <fstream>
#include <system_error>

#include "resight/io/internal/text.hpp"

namespace resight::io {
namespace {

std::vector<std::string> list_entries(const fs::path& directory, bool directories) {
  std::vector<std::string> names;
  std::error_code error;
  for (fs::directory_iterator it(directory, error), end; !error && it != end; it.increment(error)) {
    std::string name = it->path().filename().string();
    std::error_code ignored;
    if (!name.empty() && name[0] != '.' && (directories ? it->is_directory(ignored) : it->is_regular_file(ignored)))
      names.push_back(std::move(name));
  }
  std::ranges::sort(names, natural_less);
  return names;
}

Result<std::string> read_bytes(const fs::path& file, std::uintmax_t num_bytes) {
  std::ifstream in(file, std::ios::binary);
  if (!in) return file_error(file, "cannot be opened");
  std::string bytes(static_cast<std::size_t>(num_bytes), '\0');
  in.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (static_cast<std::size_t>(in.gcount()) != bytes.size()) return file_error(file, "cannot be read to its end");
  return bytes;
}

Result<std::uintmax_t> size_of(const fs::path& file) {
  std::error_code error;
  if (!fs::exists(file, error)) return file_error(file, "no such file");
  if (!fs::is_regular_file(file, error)) return file_error(file, "is not a file");
  const std::uintmax_t size = fs::file_size(file, error);
  if (error) return file_error(file, "cannot be read (" + error.message() + ")");
  return size;
}

}  // namespace

Result<std::string> read_file(const fs::path& file, std::uintmax_t max_bytes) {
  const auto size = size_of(file);
  if (!size) return size.error();
  if (*size > max_bytes)
    return file_error(file, std::to_string(*size) + " bytes are too many (at most " + std::to_string(max_bytes) + ")");
  return read_bytes(file, *size);
}

Result<std::string> read_file_start(const fs::path& file, std::size_t max_bytes) {
  const auto size = size_of(file);
  if (!size) return size.error();
  return read_bytes(file, std::min<std::uintmax_t>(*size, max_bytes));
}

std::vector<std::string> list_files(const fs::path& directory) { return list_entries(directory, false); }
std::vector<std::string> list_directories(const fs::path& directory) { return list_entries(directory, true); }

bool is_file(const fs::path& path) {
  std::error_code error;
  return fs::is_regular_file(path, error);
}

bool is_folder(const fs::path& path) {
  std::error_code error;
  return fs::is_directory(path, error);
}

std::string extension_of(const fs::path& path) {
  std::string extension = path.extension().string();
  if (!extension.empty()) extension.erase(0, 1);
  return to_lower(extension);
}

}  // namespace resight::io
