// SPDX-License-Identifier: Apache-2.0
#include "resight/annotation/annotation_journal.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <system_error>
#include <utility>

#include "resight/core/files.hpp"
#include "resight/core/input_file.hpp"

namespace resight {
namespace {

Error system_failure(const std::filesystem::path& file, std::string_view what) {
  return file_error(file, std::string(what) + " (" + std::generic_category().message(errno) + ")");
}

bool write_all(int descriptor, std::string_view bytes, std::size_t offset) {
  while (!bytes.empty()) {
    const ssize_t count = ::pwrite(descriptor, bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(count));
    offset += static_cast<std::size_t>(count);
  }
  return true;
}

/// Splits at line breaks. `num_bytes` receives the length of the whole lines.
std::vector<std::string> split_lines(std::string_view text, std::size_t& num_bytes) {
  std::vector<std::string> lines;
  num_bytes = 0;
  for (std::size_t end = text.find('\n'); end != text.npos; end = text.find('\n', num_bytes)) {
    lines.emplace_back(text.substr(num_bytes, end - num_bytes));
    num_bytes = end + 1;
  }
  return lines;
}

}  // namespace

Result<AnnotationJournal::Opened> AnnotationJournal::open(const std::filesystem::path& file,
                                                          const std::vector<std::string>& headers,
                                                          const std::function<bool(std::string_view)>& is_valid) {
  const int descriptor = ::open(file.c_str(), O_RDWR | O_CREAT | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC, 0666);
  if (descriptor < 0) return system_failure(file, "cannot be opened");
  AnnotationJournal journal(file, descriptor, 0);
  struct stat status {};
  if (::fstat(descriptor, &status) != 0 || !S_ISREG(status.st_mode)) return file_error(file, "is not a regular file");
  if (::flock(descriptor, LOCK_EX | LOCK_NB) != 0) {
    if (errno == EWOULDBLOCK) return file_error(file, "is open in another 'resight annotate' (end that one first)");
    return system_failure(file, "cannot be locked");
  }
  const auto text = read_file(file);
  if (!text) return text.error();
  std::vector<std::string> lines = split_lines(*text, journal.size_);
  bool was_cut_off = journal.size_ < text->size();
  if (lines.empty()) {
    if (was_cut_off && std::ranges::none_of(headers, [&](const std::string& h) { return h.starts_with(*text); }))
      return file_error(file, "exists already and is no journal of 'resight annotate'");
    if (was_cut_off && ::ftruncate(descriptor, 0) != 0) return system_failure(file, "cannot be repaired");
    if (const auto done = journal.append(headers.front()); !done) return done.error();
    sync_folder(file.parent_path());
    return Opened{.journal = std::move(journal), .lines = {}, .was_cut_off = was_cut_off};
  }
  if (std::ranges::find(headers, lines.front()) == headers.end())
    return file_error(file,
                      "belongs to another sequence (names, poses, cameras or pixels of the views differ), other models "
                      "or another version (choose another project)");
  lines.erase(lines.begin());
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (is_valid(lines[i])) continue;
    if (i + 1 < lines.size()) return file_error(file, "line " + std::to_string(i + 2) + " is damaged");
    journal.size_ -= lines[i].size() + 1;
    lines.pop_back();
    was_cut_off = true;
  }
  if (was_cut_off && ::ftruncate(descriptor, static_cast<off_t>(journal.size_)) != 0)
    return system_failure(file, "cannot be repaired");
  return Opened{.journal = std::move(journal), .lines = std::move(lines), .was_cut_off = was_cut_off};
}

AnnotationJournal::AnnotationJournal(AnnotationJournal&& other) noexcept
    : file_(std::move(other.file_)), descriptor_(std::exchange(other.descriptor_, -1)), size_(other.size_) {}

AnnotationJournal::~AnnotationJournal() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

Result<void> AnnotationJournal::append(std::string_view line) {
  std::string bytes(line);
  bytes += '\n';
  if (!write_all(descriptor_, bytes, size_) || ::fdatasync(descriptor_) != 0) {
    const Error failure = system_failure(file_, "cannot be written");
    if (::ftruncate(descriptor_, static_cast<off_t>(size_)) != 0) return failure;  // the next start drops the rest
    return failure;
  }
  size_ += bytes.size();
  return {};
}

}  // namespace resight
