// SPDX-License-Identifier: Apache-2.0
#include "resight/io/internal/files.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <fstream>
#include <system_error>

#include "resight/io/internal/text.hpp"

namespace resight::io {
namespace {

/// A hidden name beside `path` that no other writer uses.
fs::path temporary_sibling(const fs::path& path) {
  static std::atomic<unsigned> counter{0};
  return path.parent_path() / fmt::format(".{}.partial-{}-{}", path.filename().string(), getpid(), counter++);
}

/// Absolute and without a trailing slash, so that filename() and parent_path() mean what they say.
fs::path clean_path(const fs::path& path) {
  std::error_code error;
  fs::path clean = fs::absolute(path, error).lexically_normal();
  if (!clean.has_filename()) clean = clean.parent_path();
  return clean;
}

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

Error file_error(const fs::path& file, std::string_view what) {
  return Error{file.string() + ": " + std::string(what)};
}

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

Result<void> write_file(const fs::path& file, std::string_view bytes) {
  const fs::path target = clean_path(file);
  std::error_code error;
  fs::create_directories(target.parent_path(), error);
  if (error) return file_error(target.parent_path(), "cannot be created (" + error.message() + ")");
  const fs::path pending = temporary_sibling(target);
  {
    std::ofstream out(pending, std::ios::binary);
    out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    out.close();
    if (!out) {
      fs::remove(pending, error);
      return file_error(file, "cannot be written (no space, no permission?)");
    }
  }
  fs::rename(pending, target, error);
  if (!error) return {};
  const std::string why = error.message();
  fs::remove(pending, error);
  return file_error(file, "cannot be written (" + why + ")");
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

std::string folder_name(const fs::path& directory) { return clean_path(directory).filename().string(); }

Result<PendingDirectory> PendingDirectory::create(const fs::path& final_path) {
  const fs::path target = clean_path(final_path);
  std::error_code error;
  if (fs::exists(target, error) && !(fs::is_directory(target, error) && fs::is_empty(target, error)))
    return file_error(final_path, "exists already; choose another folder or delete it first");
  const fs::path pending = temporary_sibling(target);
  fs::create_directories(pending, error);
  if (error) return file_error(final_path, "cannot be created (" + error.message() + ")");
  return PendingDirectory(target, pending);
}

PendingDirectory::PendingDirectory(PendingDirectory&& other) noexcept
    : final_(std::move(other.final_)), pending_(std::move(other.pending_)) {
  other.pending_.clear();
}

PendingDirectory& PendingDirectory::operator=(PendingDirectory&& other) noexcept {
  if (this != &other) {
    discard();
    final_ = std::move(other.final_);
    pending_ = std::move(other.pending_);
    other.pending_.clear();
  }
  return *this;
}

PendingDirectory::~PendingDirectory() { discard(); }

void PendingDirectory::discard() noexcept {
  std::error_code ignored;
  if (!pending_.empty()) fs::remove_all(pending_, ignored);
  pending_.clear();
}

Result<void> PendingDirectory::commit() {
  require(!pending_.empty(), "PendingDirectory::commit: called twice");
  std::error_code error;
  fs::rename(pending_, final_, error);  // replaces an empty directory
  if (error) return file_error(final_, "cannot be created (" + error.message() + ")");
  pending_.clear();
  return {};
}

}  // namespace resight::io
