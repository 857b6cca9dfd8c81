// SPDX-License-Identifier: Apache-2.0
#include "resight/core/internal/file_transfer.hpp"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <sys/file.h>
#include <unistd.h>

#include <fstream>
#include <iterator>
#include <map>

#include "resight/core/files.hpp"
#include "resight/core/unfinished_folder.hpp"

namespace resight {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using Contents = std::map<std::string, std::string>;

/// A folder with results of a run before and a file of the user, which new results are moved into.
class FileTransferTest : public ::testing::Test {
 protected:
  FileTransferTest() : folder_(fs::path(::testing::TempDir()) / ("resight_transfer_" + std::to_string(::getpid()))) {
    fs::remove_all(folder_);
    put(out_ / "a.txt", "old a");
    put(out_ / "pages/1.txt", "old 1");
    put(out_ / "mine.txt", "mine");
    before_ = contents(out_);
    for (const char* name : {"a.txt", "b.txt", "pages/1.txt", "pages/2.txt", "new/er/c.txt"})
      put(hidden_ / name, "new");
  }
  ~FileTransferTest() override { fs::remove_all(folder_); }

  static void put(const fs::path& file, const std::string& text) {
    fs::create_directories(file.parent_path());
    std::ofstream(file, std::ios::binary) << text;
  }
  static std::string get(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  /// All files below a folder with their contents, and all folders.
  static Contents contents(const fs::path& folder) {
    Contents found;
    for (const auto& entry : fs::recursive_directory_iterator(folder))
      found[entry.path().lexically_relative(folder).string()] = entry.is_regular_file() ? get(entry.path()) : "folder";
    return found;
  }
  /// As if the process were killed after so many files.
  void begin_and_stop(std::size_t num_moved) const {
    FileTransfer transfer(hidden_, out_);
    ASSERT_TRUE(transfer.begin().ok());
    ASSERT_EQ(transfer.num_files(), 5U);
    for (std::size_t i = 0; i < num_moved; ++i) ASSERT_FALSE(transfer.move(i));
  }

  fs::path folder_;
  fs::path out_ = folder_ / "out";
  fs::path hidden_ = out_ / ".out.resight-partial";
  Contents before_;
};

TEST_F(FileTransferTest, AllFilesArriveAndNothingElseIsLeft) {
  ASSERT_TRUE(FileTransfer(hidden_, out_).run().ok());
  EXPECT_TRUE(check_finished(out_).ok());
  const Contents after = contents(out_);
  EXPECT_EQ(after.size(), 9U);  // six files, three folders
  EXPECT_EQ(after.at("a.txt"), "new");
  EXPECT_EQ(after.at("new/er/c.txt"), "new");
  EXPECT_EQ(after.at("mine.txt"), "mine");
}

TEST_F(FileTransferTest, AKilledOneIsToldAndUndoneWhereverItStopped) {
  for (std::size_t num_moved = 0; num_moved <= 5; ++num_moved) {
    begin_and_stop(num_moved);
    for (const fs::path& seen : {out_, out_ / "pages", out_ / "pages/"})
      EXPECT_THAT(check_finished(seen).error().message, HasSubstr("out: is not finished")) << num_moved;
    EXPECT_TRUE(check_finished(folder_).ok());
    ASSERT_TRUE(FileTransfer::undo(out_).ok());
    EXPECT_TRUE(check_finished(out_).ok());
    Contents after = contents(out_);
    std::erase_if(after, [](const auto& entry) { return entry.first.starts_with(".out.resight-partial"); });
    EXPECT_EQ(after, before_) << num_moved << " files were moved";
    EXPECT_EQ(get(hidden_ / "new/er/c.txt"), "new") << "nothing may be lost by undoing";
  }
}

TEST_F(FileTransferTest, ThePendingFolderOfTheNextCommandUndoesIt) {
  begin_and_stop(3);
  {
    const auto next = PendingDirectory::create(out_, ExistingFolder::kFill);
    ASSERT_TRUE(next.ok()) << next.error().message;
  }
  EXPECT_EQ(contents(out_), before_);
}

// The hidden folder lies beside the folder if that did not exist when the command began.
TEST_F(FileTransferTest, ThePendingFolderBesideIsNotLostBeforeItIsUndone) {
  const fs::path beside = folder_ / ".out.resight-partial";
  fs::rename(hidden_, beside);
  hidden_ = beside;
  begin_and_stop(3);
  EXPECT_TRUE(check_writable_folder(out_, ExistingFolder::kFill).ok());
  EXPECT_EQ(contents(out_), before_);
  EXPECT_EQ(get(beside / "new/er/c.txt"), "new");
  { EXPECT_TRUE(PendingDirectory::create(out_, ExistingFolder::kFill).ok()); }
  EXPECT_FALSE(fs::exists(beside));
}

TEST_F(FileTransferTest, AMixtureThatCannotBeUndoneStaysKnown) {
  begin_and_stop(3);
  fs::remove_all(hidden_);
  for (int attempt = 0; attempt < 2; ++attempt) {
    EXPECT_THAT(check_writable_folder(out_, ExistingFolder::kFill).error().message, HasSubstr("holds a mixture"));
    EXPECT_FALSE(check_finished(out_).ok());
  }
}

TEST_F(FileTransferTest, WhatCannotBeMovedIsNamedAndAllIsAsBefore) {
  const fs::path elsewhere = "/dev/shm/" + folder_.filename().string();
  std::error_code error;
  if (!fs::create_directory(elsewhere, error)) GTEST_SKIP() << "no /dev/shm";
  put(hidden_ / "other_disk/d.txt", "new");
  fs::create_directory_symlink(elsewhere, out_ / "other_disk");
  fs::rename(hidden_ / "other_disk/d.txt", elsewhere / "d.txt", error);
  if (!error) fs::remove_all(elsewhere);
  if (!error) GTEST_SKIP() << "/dev/shm is the same disk";
  const auto moved = FileTransfer(hidden_, out_).run();
  fs::remove_all(elsewhere);
  ASSERT_FALSE(moved.ok());
  EXPECT_THAT(moved.error().message, HasSubstr("out/other_disk/d.txt: cannot be written"));
  fs::remove(out_ / "other_disk");
  fs::remove_all(hidden_);
  EXPECT_EQ(contents(out_), before_);
}

// A data set is written into an empty folder only. What a killed command has left there is no data.
TEST_F(FileTransferTest, AFolderThatWasEmptyIsEmptyAgain) {
  const fs::path empty = folder_ / "empty";
  put(empty / ".empty.resight-partial/scene/a.txt", "new");
  {
    FileTransfer transfer(empty / ".empty.resight-partial", empty);
    ASSERT_TRUE(transfer.begin().ok());
    ASSERT_FALSE(transfer.move(0));
    ASSERT_TRUE(fs::exists(empty / "scene/a.txt"));
  }
  EXPECT_TRUE(check_writable_folder(empty, ExistingFolder::kRefuse).ok());
  { EXPECT_TRUE(PendingDirectory::create(empty).ok()); }
  EXPECT_THAT(contents(empty), IsEmpty());
}

TEST_F(FileTransferTest, OneThatIsStillAtWorkIsLeftAlone) {
  begin_and_stop(2);
  const int descriptor = ::open(hidden_.c_str(), O_RDONLY | O_DIRECTORY);
  ASSERT_EQ(::flock(descriptor, LOCK_EX | LOCK_NB), 0);
  const Contents before = contents(out_);
  EXPECT_TRUE(FileTransfer::undo(out_).ok());
  EXPECT_EQ(contents(out_), before);
  EXPECT_THAT(PendingDirectory::create(out_, ExistingFolder::kFill).error().message,
              HasSubstr("another command is writing it"));
  ::close(descriptor);
}

// A journal of a stranger, as in an archive, could otherwise name any file of the user.
TEST_F(FileTransferTest, AJournalOfAnotherFolderIsNotFollowed) {
  begin_and_stop(2);
  const fs::path copy = folder_ / "copy";
  fs::copy(out_, copy, fs::copy_options::recursive);
  const Contents before = contents(copy);
  EXPECT_THAT(FileTransfer::undo(copy).error().message, HasSubstr("copy: holds a mixture of old and new files"));
  EXPECT_EQ(contents(copy), before);
}

TEST_F(FileTransferTest, AJournalThatLeadsOutOfItsFolderIsNotFollowed) {
  begin_and_stop(0);
  put(folder_ / "victim", "precious");
  fs::create_directory_symlink("..", out_ / "up");
  const std::string journal = get(out_ / kTransferJournal);
  for (const std::string name : {"../victim", "up/victim", "./../victim", "/etc/passwd"}) {
    put(out_ / kTransferJournal, journal + name + '\0');
    EXPECT_THAT(FileTransfer::undo(out_).error().message, HasSubstr("holds a mixture")) << name;
  }
  for (const std::string& text : {std::string(), journal.substr(0, 30), std::string(1000, 'x')}) {
    put(out_ / kTransferJournal, text);
    EXPECT_FALSE(FileTransfer::undo(out_).ok());
  }
  EXPECT_EQ(get(folder_ / "victim"), "precious");
}

}  // namespace
}  // namespace resight
