// SPDX-License-Identifier: Apache-2.0
#include "resight/core/input_file.hpp"

#include <gmock/gmock.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fstream>

namespace resight {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

class InputFileTest : public ::testing::Test {
 protected:
  InputFileTest() : folder_(fs::path(::testing::TempDir()) / ("resight_input_" + std::to_string(::getpid()))) {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    std::ofstream(folder_ / "text", std::ios::binary) << std::string("one\0two", 7);
  }
  ~InputFileTest() override { fs::remove_all(folder_); }
  fs::path folder_;
};

TEST_F(InputFileTest, FilesAreReadToTheByte) {
  EXPECT_EQ(*read_file(folder_ / "text"), std::string("one\0two", 7));
  EXPECT_EQ(*read_file_start(folder_ / "text", 3), "one");
  EXPECT_EQ(read_file_start(folder_ / "text", 99)->size(), 7U);
  fs::create_symlink("text", folder_ / "link");
  EXPECT_EQ(read_file(folder_ / "link")->size(), 7U);
}

TEST_F(InputFileTest, AHoleIsNotReadIntoMemory) {
  const fs::path file = folder_ / "sparse";
  std::ofstream(file) << "";
  fs::resize_file(file, std::uintmax_t{1} << 40);
  EXPECT_NE(read_file(file, std::uintmax_t{1} << 41).error().message.find("begins with zeros only"), std::string::npos);
  fs::resize_file(file, 1 << 20);
  EXPECT_EQ(read_file(file, 1 << 20)->size(), std::size_t{1} << 20) << "a small file may hold zeros";
}

TEST_F(InputFileTest, SizesAreCheckedBeforeReading) {
  EXPECT_TRUE(read_file(folder_ / "text", 7).ok());
  EXPECT_THAT(read_file(folder_ / "text", 6).error().message, HasSubstr("text: 7 bytes are too many (at most 6)"));
  std::ofstream(folder_ / "sparse").close();
  fs::resize_file(folder_ / "sparse", kMaxTextBytes + 1);
  EXPECT_THAT(read_file(folder_ / "sparse").error().message, HasSubstr("too many"));
  auto file = InputFile::open(folder_ / "text");
  char bytes[8];
  EXPECT_THAT(file->read(bytes, sizeof(bytes)).error().message, HasSubstr("cannot be read to its end"));
}

// A pipe without a writer would wait for ever, and a device has no end.
TEST_F(InputFileTest, OnlyRegularFilesAreRead) {
  ASSERT_EQ(::mkfifo((folder_ / "pipe").c_str(), 0600), 0);
  EXPECT_THAT(read_file(folder_ / "pipe").error().message, HasSubstr("pipe: is not a file"));
  EXPECT_THAT(read_file("/dev/zero").error().message, HasSubstr("/dev/zero: is not a file"));
  EXPECT_THAT(read_file(folder_).error().message, HasSubstr("is not a file"));
}

TEST_F(InputFileTest, PathsThatLeadNowhereGiveOneLine) {
  EXPECT_THAT(read_file(folder_ / "none").error().message, HasSubstr("none: no such file"));
  EXPECT_THAT(read_file(folder_ / "text/below").error().message, HasSubstr("no such file"));
  fs::create_symlink("loop", folder_ / "loop");
  EXPECT_THAT(read_file(folder_ / "loop").error().message, HasSubstr("loop: cannot be opened"));
  EXPECT_THAT(read_file(folder_ / std::string(300, 'a')).error().message, HasSubstr("a: cannot be opened"));
}

}  // namespace
}  // namespace resight
