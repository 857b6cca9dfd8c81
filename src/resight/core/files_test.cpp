// SPDX-License-Identifier: Apache-2.0
#include "resight/core/files.hpp"

#include <gmock/gmock.h>
#include <unistd.h>

#include <fstream>

namespace resight {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// Creates a folder for each test and removes it afterwards.
class FilesTest : public ::testing::Test {
 protected:
  FilesTest() : folder_(fs::path(::testing::TempDir()) / ("resight_files_" + std::to_string(::getpid()))) {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  ~FilesTest() override { fs::remove_all(folder_); }

  static void write(const fs::path& file, const std::string& text) { std::ofstream(file) << text; }
  static std::string read(const fs::path& file) {
    std::ifstream in(file);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  /// All entries below the folder of the test, hidden ones included, in order.
  [[nodiscard]] std::vector<std::string> entries() const {
    std::vector<std::string> names;
    for (const auto& entry : fs::recursive_directory_iterator(folder_))
      names.push_back(fs::relative(entry.path(), folder_).string());
    std::sort(names.begin(), names.end());
    return names;
  }

  fs::path folder_;
};

TEST_F(FilesTest, AFileIsWrittenWholeWithItsFolder) {
  ASSERT_TRUE(write_file(folder_ / "a/b.txt", {"one ", "two"}).ok());
  EXPECT_EQ(read(folder_ / "a/b.txt"), "one two");
  ASSERT_TRUE(write_file(folder_ / "a/b.txt", "three").ok()) << "must replace an older file";
  EXPECT_EQ(read(folder_ / "a/b.txt"), "three");
  EXPECT_THAT(entries(), ElementsAre("a", "a/b.txt"));
}

// Whoever can guess the temporary name can make us write through a link placed there.
TEST_F(FilesTest, ALinkAtAGuessableNameIsNotWrittenThrough) {
  write(folder_ / "victim", "precious");
  for (int i = 0; i < 50; ++i)
    fs::create_symlink("victim", folder_ / (".a.txt.partial-" + std::to_string(::getpid()) + "-" + std::to_string(i)));
  ASSERT_TRUE(write_file(folder_ / "a.txt", "new").ok());
  EXPECT_EQ(read(folder_ / "victim"), "precious");
  EXPECT_FALSE(fs::is_symlink(folder_ / "a.txt"));
  EXPECT_EQ(read(folder_ / "a.txt"), "new");
}

TEST_F(FilesTest, ALinkIsReplacedNotFollowed) {
  write(folder_ / "victim", "precious");
  fs::create_symlink("victim", folder_ / "link");
  ASSERT_TRUE(write_file(folder_ / "link", "new").ok());
  EXPECT_EQ(read(folder_ / "victim"), "precious");
  EXPECT_EQ(read(folder_ / "link"), "new");
}

TEST_F(FilesTest, LongNamesLeaveRoomForTheTemporaryOne) {
  ASSERT_TRUE(write_file(folder_ / std::string(250, 'a'), "x").ok());
  EXPECT_THAT(write_file(folder_ / std::string(300, 'a'), "x").error().message, HasSubstr("cannot be written"));
  EXPECT_THAT(entries(), ElementsAre(std::string(250, 'a')));
}

TEST_F(FilesTest, WhatCannotBeWrittenLeavesNothingBehind) {
  fs::create_directories(folder_ / "taken/full");
  write(folder_ / "file", "");
  EXPECT_THAT(write_file(folder_ / "taken", "x").error().message, HasSubstr("taken: cannot be written"));
  EXPECT_THAT(write_file(folder_ / "file/below", "x").error().message, HasSubstr("file: cannot be created"));
  EXPECT_THAT(entries(), ElementsAre("file", "taken", "taken/full"));
}

TEST_F(FilesTest, WritablePlacesAreKnownBeforehand) {
  write(folder_ / "file", "");
  EXPECT_TRUE(check_writable(folder_).ok());
  EXPECT_TRUE(check_writable(folder_ / "new/er/est").ok());
  EXPECT_TRUE(check_writable(folder_ / "file").ok());
  EXPECT_THAT(check_writable(folder_ / "file/below").error().message, HasSubstr("file is not a folder"));
  EXPECT_THAT(check_writable(folder_ / std::string(300, 'a')).error().message, HasSubstr("name is too long"));
  EXPECT_THAT(entries(), ElementsAre("file")) << "the check must not change anything";
  if (::geteuid() == 0) return;  // root may write anywhere
  fs::permissions(folder_, fs::perms::owner_read | fs::perms::owner_exec);
  EXPECT_THAT(check_writable(folder_ / "new").error().message, HasSubstr("no permission"));
  fs::permissions(folder_, fs::perms::owner_all);
}

TEST_F(FilesTest, FolderNamesDoNotHangOnASlash) {
  EXPECT_EQ(folder_name("a/b"), "b");
  EXPECT_EQ(folder_name("a/b/"), "b");
  EXPECT_EQ(folder_name("a/b/.."), "a");
  EXPECT_EQ(folder_name("."), fs::current_path().filename());
}

TEST_F(FilesTest, APendingDirectoryAppearsOnlyWhenComplete) {
  {
    const auto pending = PendingDirectory::create(folder_ / "new/er/out");
    ASSERT_TRUE(pending.ok());
    write(pending->path() / "a.txt", "a");
    EXPECT_FALSE(fs::exists(folder_ / "new/er/out"));
  }
  EXPECT_THAT(entries(), ElementsAre()) << "a discarded folder must leave nothing";
  auto pending = PendingDirectory::create(folder_ / "out/");
  ASSERT_TRUE(pending.ok());
  write(pending->path() / "a.txt", "a");
  PendingDirectory moved = *std::move(pending);
  ASSERT_TRUE(moved.commit().ok());
  EXPECT_THAT(entries(), ElementsAre("out", "out/a.txt"));
  EXPECT_THROW((void)moved.commit(), std::invalid_argument);
}

TEST_F(FilesTest, APendingDirectoryNeverWritesOverDataUnlessAskedTo) {
  fs::create_directories(folder_ / "out");
  auto into_empty = PendingDirectory::create(folder_ / "out");
  ASSERT_TRUE(into_empty.ok());
  write(into_empty->path() / "a.txt", "old");
  ASSERT_TRUE(into_empty->commit().ok());
  write(folder_ / "out/mine.txt", "mine");
  write(folder_ / "file", "");

  EXPECT_THAT(PendingDirectory::create(folder_ / "out").error().message, HasSubstr("exists already"));
  EXPECT_THAT(PendingDirectory::create(folder_ / "file").error().message, HasSubstr("not a folder"));
  EXPECT_THAT(PendingDirectory::create(folder_ / "file/out").error().message, HasSubstr("cannot be created"));
  for (const bool committed : {false, true}) {
    auto filling = PendingDirectory::create(folder_ / "out", ExistingFolder::kFill);
    ASSERT_TRUE(filling.ok());
    write(filling->path() / "a.txt", "new");
    if (committed) {
      ASSERT_TRUE(filling->commit().ok());
    }
    *filling = *PendingDirectory::create(folder_ / "other");  // gives up what was not committed
    EXPECT_EQ(read(folder_ / "out/a.txt"), committed ? "new" : "old");
  }
  EXPECT_THAT(entries(), ElementsAre("file", "out", "out/a.txt", "out/mine.txt"));
}

}  // namespace
}  // namespace resight
