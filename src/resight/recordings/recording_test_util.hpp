// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <fmt/format.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "resight/recordings/recording.hpp"

/// Recordings as files, for the tests of their reader.
namespace resight::test {

namespace fs = std::filesystem;

/// Files that other programs have written (tests/data/recordings/README.md).
inline fs::path recorded(const std::string& name) {
  return fs::path(RESIGHT_SOURCE_DIR) / "tests/data/recordings" / name;
}

inline const std::vector<std::string> kRos1 = {"none.bag", "lz4.bag", "bz2.bag"};
inline const std::vector<std::string> kRos2 = {"none.mcap",     "zstd.mcap", "lz4.mcap",     "no_chunks.mcap",
                                               "no_index.mcap", "ros2.db3",  "ros2_zstd.db3"};

inline std::vector<std::string> all_recordings() {
  std::vector<std::string> all = kRos1;
  all.insert(all.end(), kRos2.begin(), kRos2.end());
  return all;
}

inline std::string read_bytes(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// A file for the running test that is removed at its end.
class TemporaryFile {
 public:
  TemporaryFile() {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    path_ = fs::temp_directory_path() / fmt::format("resight_recordings_{}_{}", ::getpid(), test->name());
  }
  ~TemporaryFile() {
    std::error_code ignored;
    fs::remove(path_, ignored);
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  const fs::path& write(const std::string& bytes) {
    std::ofstream(path_, std::ios::binary) << bytes;
    return path_;
  }

 private:
  fs::path path_;
};

/// All messages of a recording, in order; "" for those that cannot be read.
inline std::vector<std::string> read_all(const Recording& recording) {
  std::vector<std::string> all;
  for (const MessageEntry& entry : recording.messages()) {
    const auto bytes = recording.read(entry, kMaxMessageBytes);
    all.push_back(bytes.ok() ? *bytes : "");
  }
  return all;
}

}  // namespace resight::test
