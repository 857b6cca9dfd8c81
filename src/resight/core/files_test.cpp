// SPDX-License-Identifier: Apache-2.0
#include "resight/core/files.hpp"

#include <gmock/gmock.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <fstream>
#include <functional>
#include <iterator>
#include <vector>

#include "resight/core/output_file.hpp"

namespace resight {
namespace {

namespace fs = std::filesystem;
using ::testing::Contains;
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

TEST_F(FilesTest, AFileInPartsAppearsWhenItIsComplete) {
  write(folder_ / "a.txt", "old");
  {
    auto out = OutputFile::create(folder_ / "a.txt");
    ASSERT_TRUE(out.ok());
    ASSERT_TRUE(out->append("one ").ok());
    EXPECT_EQ(read(folder_ / "a.txt"), "old");
  }
  EXPECT_THAT(entries(), ElementsAre("a.txt")) << "a discarded file must leave nothing";
  auto out = OutputFile::create(folder_ / "a.txt");
  for (const char* part : {"one ", "", "two"}) ASSERT_TRUE(out->append(part).ok());
  ASSERT_TRUE(out->commit().ok());
  EXPECT_EQ(read(folder_ / "a.txt"), "one two");
  EXPECT_THAT(entries(), ElementsAre("a.txt"));
  EXPECT_THAT(OutputFile::create(folder_ / "a.txt/b").error().message, HasSubstr("b: cannot be written"));
}

// Whoever can write into the folder could make us write through a link at the temporary name.
TEST_F(FilesTest, ALinkAtTheTemporaryNameIsNotWrittenThrough) {
  write(folder_ / "victim", "precious");
  fs::create_symlink("victim", folder_ / ".a.txt.resight-partial");
  EXPECT_THAT(write_file(folder_ / "a.txt", "new").error().message, HasSubstr(".a.txt.resight-partial is in the way"));
  fs::create_symlink(".", folder_ / ".out.resight-partial");
  EXPECT_THAT(PendingDirectory::create(folder_ / "out").error().message, HasSubstr("is in the way"));
  EXPECT_EQ(read(folder_ / "victim"), "precious");
  EXPECT_FALSE(fs::exists(folder_ / "a.txt"));
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
  {
    const auto one = PendingDirectory::create(folder_ / (std::string(249, 'a') + "b"));
    const auto other = PendingDirectory::create(folder_ / (std::string(249, 'a') + "c"));
    EXPECT_TRUE(one.ok() && other.ok()) << "long names must not share one temporary name";
  }
  EXPECT_THAT(write_file(folder_ / std::string(300, 'a'), "x").error().message, HasSubstr("cannot be written"));
  EXPECT_THAT(entries(), ElementsAre(std::string(250, 'a')));
}

TEST_F(FilesTest, WhatCannotBeWrittenLeavesNothingBehind) {
  fs::create_directories(folder_ / "taken/full");
  write(folder_ / "file", "");
  EXPECT_THAT(write_file(folder_ / "taken", "x").error().message, HasSubstr("taken: cannot be written"));
  EXPECT_THAT(write_file(folder_ / "file/below", "x").error().message, HasSubstr("file/below: cannot be written"));
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

TEST_F(FilesTest, TwoDotsBehindALinkLeadWhereTheFileSystemSays) {
  fs::create_directories(folder_ / "real/inner");
  fs::create_directory_symlink(folder_ / "real/inner", folder_ / "link");
  write(folder_ / "mine", "mine");
  EXPECT_TRUE(write_file(folder_ / "link/../mine", "new").ok());
  EXPECT_EQ(read(folder_ / "real/mine"), "new");
  EXPECT_EQ(read(folder_ / "mine"), "mine");
  auto pending = PendingDirectory::create(folder_ / "link/../out");
  ASSERT_TRUE(pending.ok());
  ASSERT_TRUE(pending->commit().ok());
  EXPECT_TRUE(fs::is_directory(folder_ / "real/out"));
  for (const fs::path& out : {folder_ / "missing/../mine", folder_ / "missing/.."}) {
    EXPECT_THAT(check_writable(out).error().message, HasSubstr("a folder that does not exist"));
    EXPECT_THAT(write_file(out, "new").error().message, HasSubstr("a folder that does not exist"));
    EXPECT_FALSE(PendingDirectory::create(out).ok());
  }
  EXPECT_EQ(read(folder_ / "mine"), "mine");
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
  EXPECT_THAT(PendingDirectory::create(folder_ / "file/out").error().message, HasSubstr("file is not a folder"));
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

/// Nothing is tidied up.
void be_killed() { ::kill(::getpid(), SIGKILL); }

/// Runs `work` in a process of its own, which ends by be_killed().
void run_in_a_process(const std::function<void()>& work) {
  const pid_t child = ::fork();
  if (child == 0) {
    work();
    ::_exit(1);
  }
  ASSERT_GT(child, 0);
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFSIGNALED(status)) << "the work failed";
}

TEST_F(FilesTest, WhatAKilledProcessHasLeftIsRemovedByTheNext) {
  fs::create_directories(folder_ / "empty");
  for (const char* name : {"new", "empty"}) {
    run_in_a_process([&] {
      const auto pending = PendingDirectory::create(folder_ / name);
      if (!write_file(pending->path() / "deep/a.txt", "old").ok()) return;
      be_killed();
    });
    EXPECT_THAT(entries(), Contains(HasSubstr("resight-partial/deep/a.txt"))) << "nothing was left behind";
    EXPECT_TRUE(check_writable_folder(folder_ / name, ExistingFolder::kRefuse).ok());
    auto again = PendingDirectory::create(folder_ / name);
    ASSERT_TRUE(again.ok()) << again.error().message;
    write(again->path() / "b.txt", "new");
    ASSERT_TRUE(again->commit().ok());
    EXPECT_EQ(read(folder_ / name / "b.txt"), "new");
    fs::remove(folder_ / name / "b.txt");
  }
  write(folder_ / ".file.resight-partial", "cut o");
  ASSERT_TRUE(write_file(folder_ / "file", "whole").ok());
  fs::create_directories(folder_ / ".other.resight-partial/full");
  ASSERT_TRUE(write_file(folder_ / "other", "whole").ok());
  EXPECT_THAT(entries(), ElementsAre("empty", "file", "new", "other"));
}

TEST_F(FilesTest, WhatWasBegunBesideIsRemovedAlsoWhenTheFolderExistsMeanwhile) {
  run_in_a_process([&] {
    const auto pending = PendingDirectory::create(folder_ / "out");
    be_killed();
  });
  EXPECT_THAT(entries(), ElementsAre(".out.resight-partial"));
  fs::create_directories(folder_ / "out");
  ASSERT_TRUE(PendingDirectory::create(folder_ / "out").ok());
  EXPECT_THAT(entries(), ElementsAre("out"));
}

// Nothing can be made in /proc, and nobody is writing there.
TEST_F(FilesTest, APlaceThatTakesNoFilesSaysSo) {
  for (const std::string& message :
       {write_file("/proc/resight_test", "x").error().message, check_writable("/proc/resight_test").error().message,
        PendingDirectory::create("/proc/resight_test").error().message}) {
    EXPECT_THAT(message, HasSubstr("/proc/resight_test"));
    EXPECT_THAT(message, Not(HasSubstr("another command")));
  }
}

TEST_F(FilesTest, TwoCannotFillOneFolderAtOnce) {
  auto first = PendingDirectory::create(folder_ / "out", ExistingFolder::kFill);
  ASSERT_TRUE(first.ok());
  for (const bool exists : {false, true}) {
    if (exists) fs::create_directories(folder_ / "out");
    for (const auto existing : {ExistingFolder::kFill, ExistingFolder::kRefuse})
      EXPECT_THAT(PendingDirectory::create(folder_ / "out", existing).error().message,
                  HasSubstr("another command is writing it"));
  }
  EXPECT_TRUE(fs::exists(first->path())) << "what is in use was removed";
  ASSERT_TRUE(first->commit().ok());
  EXPECT_TRUE(PendingDirectory::create(folder_ / "out").ok());
}

TEST_F(FilesTest, AFolderThatOthersHaveFilledMeanwhileIsNotMixed) {
  for (const bool exists : {false, true}) {
    const fs::path out = folder_ / (exists ? "there" : "out");
    if (exists) fs::create_directories(out);
    {
      auto pending = PendingDirectory::create(out);
      ASSERT_TRUE(pending.ok());
      write(pending->path() / "a.txt", "ours");
      fs::create_directories(out);
      write(out / "b.txt", "theirs");
      EXPECT_THAT(pending->commit().error().message, HasSubstr("was filled by another program"));
    }
    EXPECT_FALSE(fs::exists(out / "a.txt"));
  }
  EXPECT_THAT(entries(), ElementsAre("out", "out/b.txt", "there", "there/b.txt"));
}

TEST_F(FilesTest, FilesAreReplacedAllOrNone) {
  fs::create_directories(folder_ / "out/b/full");
  write(folder_ / "out/a", "old");
  {
    auto pending = PendingDirectory::create(folder_ / "out", ExistingFolder::kFill);
    ASSERT_TRUE(pending.ok());
    for (const char* name : {"a", "b", "c"}) write(pending->path() / name, "new");
    EXPECT_THAT(pending->commit().error().message, HasSubstr("b: is a folder where a file is to be written"));
  }
  EXPECT_EQ(read(folder_ / "out/a"), "old");
  EXPECT_THAT(entries(), ElementsAre("out", "out/a", "out/b", "out/b/full"));
  auto pending = PendingDirectory::create(folder_ / "out", ExistingFolder::kFill);
  fs::create_directories(pending->path() / "b/full");
  write(pending->path() / "b/full/d", "new");
  ASSERT_TRUE(pending->commit().ok()) << "folders are joined";
  EXPECT_THAT(entries(), ElementsAre("out", "out/a", "out/b", "out/b/full", "out/b/full/d"));
}

TEST_F(FilesTest, AnInterruptionRemovesEverythingThatIsUnfinished) {
  run_in_a_process([&] {
    const auto outer = PendingDirectory::create(folder_ / "new/er/out");
    const auto inner = PendingDirectory::create(outer->path() / "inner");
    if (!write_file(inner->path() / "a.txt", "a").ok() || !write_file(folder_ / "done.txt", "done").ok()) return;
    remove_pending_files();
    be_killed();
  });
  EXPECT_THAT(entries(), ElementsAre("done.txt"));
}

TEST_F(FilesTest, FoldersThatCannotBeWrittenAreKnownBeforehand) {
  write(folder_ / "file", "");
  fs::create_symlink("nowhere", folder_ / "dangling");
  fs::create_directories(folder_ / "full/of");
  const auto why = [&](const fs::path& path) {
    return check_writable_folder(path, ExistingFolder::kRefuse).error().message;
  };
  EXPECT_THAT(why(""), HasSubstr("is empty"));
  EXPECT_THAT(why(folder_ / "file"), HasSubstr("is not a folder"));
  EXPECT_THAT(why(folder_ / "dangling"), HasSubstr("dangling is a link that leads nowhere"));
  EXPECT_THAT(why(folder_ / "dangling/out"), HasSubstr("dangling is a link that leads nowhere"));
  EXPECT_THAT(why(folder_ / std::string(300, 'a') / "out"), HasSubstr("name is too long"));
  EXPECT_THAT(why(folder_ / "full"), HasSubstr("exists already"));
  EXPECT_TRUE(check_writable_folder(folder_ / "full", ExistingFolder::kFill).ok());
}

}  // namespace
}  // namespace resight
