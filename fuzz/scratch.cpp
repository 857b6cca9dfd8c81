// SPDX-License-Identifier: Apache-2.0
#include <stdlib.h>  // NOLINT(modernize-deprecated-headers): mkdtemp() of POSIX

#include <cstdio>
#include <fstream>
#include <iterator>
#include <stdexcept>

#include "reader.hpp"

namespace resight::fuzz {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kSeparator = "\n@@@@\n";

struct Scratch {
  fs::path path;
  Scratch() {
    std::string name = (fs::temp_directory_path() / "resight_fuzz_XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("cannot create " + name);
    path = name;
  }
  ~Scratch() {
    std::error_code ignored;
    fs::remove_all(path, ignored);
  }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
};

std::string read_all(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) throw std::runtime_error("cannot read " + file.string());
  return {std::istreambuf_iterator<char>(in), {}};
}

}  // namespace

const fs::path& scratch_folder() {
  static const Scratch scratch;
  return scratch.path;
}

fs::path write_scratch(std::string_view name, std::string_view bytes) {
  fs::path file = scratch_folder() / name;
  // Faster than a stream: this runs once per execution.
  std::FILE* out = std::fopen(file.c_str(), "wb");
  if (out == nullptr) throw std::runtime_error("cannot write " + file.string());
  const bool is_written = std::fwrite(bytes.data(), 1, bytes.size(), out) == bytes.size();
  if (std::fclose(out) != 0 || !is_written) throw std::runtime_error("cannot write " + file.string());
  return file;
}

std::string bytes_written_by(std::string_view name, const std::function<void(const fs::path&)>& write) {
  const fs::path file = scratch_folder() / name;
  write(file);
  std::string bytes = read_all(file);
  fs::remove(file);
  return bytes;
}

std::string join_files(std::span<const std::string> files) {
  std::string joined;
  for (const std::string& file : files) {
    if (&file != &files.front()) joined += kSeparator;
    joined += file;
  }
  return joined;
}

const fs::path& write_bundle(std::string_view bytes, std::span<const char* const> names) {
  bool is_left = true;
  for (const char* name : names) {
    if (!is_left) {
      fs::remove(scratch_folder() / name);
      continue;
    }
    const std::size_t end = bytes.find(kSeparator);
    write_scratch(name, bytes.substr(0, end));
    is_left = end != bytes.npos;
    if (is_left) bytes.remove_prefix(end + kSeparator.size());
  }
  return scratch_folder();
}

std::string source_file(std::string_view path) { return read_all(fs::path(RESIGHT_SOURCE_DIR) / path); }

}  // namespace resight::fuzz
