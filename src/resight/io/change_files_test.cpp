// SPDX-License-Identifier: Apache-2.0
#include "resight/io/change_files.hpp"

#include <gmock/gmock.h>

#include "resight/io/convert.hpp"
#include "resight/io/internal/test_data.hpp"
#include "resight/io/tuw_changes.hpp"

namespace resight {
namespace {

using testing::HasSubstr;

const std::vector<std::string> kCloudViews = {"cloud_00", "cloud_01", "cloud_07"};

Result<std::vector<ObjectPlacement>> resolve(const std::string& text, const std::vector<std::string>& views) {
  const auto chains = parse_changes(text, "s.changes");
  if (!chains) return chains.error();
  return resolve_changes(*chains, views, "s.changes");
}

TEST(ResolveChanges, FindsViewsByNameThenByNumber) {
  const std::vector<ObjectPlacement> expected = {{"mug", {{0, 0}, {2, 1}}}, {"red_box", {{1, 0}}}};
  const auto same = resolve("cloud_0_mug_0.txt cloud_007_mug_1.txt\ncloud_01_red_box_0.txt\n", kCloudViews);
  ASSERT_TRUE(same.ok()) << same.error().message;
  EXPECT_EQ(*same, expected);
  const auto by_number = resolve("00000_mug_0.txt 00007_mug_1.txt\n00001_red_box_0.txt\n", kCloudViews);
  ASSERT_TRUE(by_number.ok()) << by_number.error().message;
  EXPECT_EQ(*by_number, expected);
  const std::vector<std::string> renamed = {"000000", "000001", "000002"};
  const std::string text = format_changes(name_placements(expected, renamed));
  EXPECT_EQ(text, "000000_mug_0.txt 000002_mug_1.txt\n000001_red_box_0.txt\n");
  EXPECT_EQ(*resolve(text, renamed), expected);
}

TEST(ResolveChanges, NamesTheAnnotationThatDoesNotFit) {
  EXPECT_EQ(resolve("cloud_00_mug_0.txt cloud_02_mug_0.txt", kCloudViews).error().message,
            "s.changes: cloud_02_mug_0.txt: the sequence has no such view");
  EXPECT_EQ(resolve("view_3_mug_0.txt", {"a_3", "b_3"}).error().message,
            "s.changes: view_3_mug_0.txt: several views of the sequence have this number");
  EXPECT_THAT(resolve("cloud_00_mug_0.txt cloud_01_mug_0.txt", {"cloud_01", "cloud_00"}).error().message,
              HasSubstr("cloud_01_mug_0.txt: its view does not come after"));
}

// A file that is cut anywhere is read as far as it goes, or refused in one line.
TEST(ResolveChanges, CutAnywhere) {
  const std::string text = "cloud_00_mug_0.txt cloud_01_mug_0.txt\ncloud_00_red_box_0.txt cloud_07_red_box_1.txt\n";
  int num_refused = 0;
  for (std::size_t size = 0; size <= text.size(); ++size) {
    const auto placements = resolve(text.substr(0, size), kCloudViews);
    if (placements.ok()) continue;
    ++num_refused;
    EXPECT_TRUE(placements.error().message.starts_with("s.changes: ")) << placements.error().message;
    EXPECT_EQ(placements.error().message.find('\n'), std::string::npos);
  }
  EXPECT_GT(num_refused, 20);
  EXPECT_FALSE(resolve("cloud_99999999999999999999_mug_0.txt", kCloudViews).ok());
  EXPECT_FALSE(resolve("cloud_00_mug_99999999999999999999.txt", kCloudViews).ok());
  EXPECT_FALSE(resolve("cloud_00_mug_nan.txt", kCloudViews).ok());
}

class FindChangeFiles : public testing::TestWithParam<const char*> {};

TEST_P(FindChangeFiles, InEachPlace) {
  io::TestDirectory directory;
  const std::filesystem::path sequence = directory / "set/test/kitchen";
  io::write_text(directory / "set/annotations/kitchen/cloud_00_mug_0.txt", "");
  std::filesystem::create_directories(sequence);
  EXPECT_TRUE(find_change_files(sequence, kCloudViews).empty());
  io::write_text(directory / GetParam(), "");
  const ChangeFiles found = find_change_files(sequence / "", kCloudViews);
  const bool is_events = std::string(GetParam()).ends_with("json");
  EXPECT_EQ(is_events ? found.events : found.changes, directory / GetParam());
  EXPECT_TRUE((is_events ? found.changes : found.events).empty());
}

INSTANTIATE_TEST_SUITE_P(Places, FindChangeFiles,
                         testing::Values("set/test/kitchen/kitchen.changes", "set/test/kitchen/any.changes",
                                         "set/test/kitchen.changes", "set/kitchen.changes",
                                         "set/annotations/kitchen.changes", "set/annotations/kitchen/kitchen.changes",
                                         "set/annotations/kitchen/any.changes", "set/TUW_changes/kitchen.changes",
                                         "set/test/kitchen/events.json", "set/test/kitchen.events.json",
                                         "set/events.json"));

TEST(FindChangeFiles, TheEventsOfASetAreThoseOfItsOnlySequence) {
  io::TestDirectory directory;
  for (const char* name : {"set/events.json", "set/test/a/x", "set/test/b/x"}) io::write_text(directory / name, "");
  EXPECT_TRUE(find_change_files(directory / "set/test/a", {}).empty());
}

TEST(FindChangeFiles, OfSeveralFilesTheOneWithTheName) {
  io::TestDirectory directory;
  for (const char* name : {"s/a.changes", "s/b.changes", "other.changes"}) io::write_text(directory / name, "");
  EXPECT_TRUE(find_change_files(directory / "s", {}).empty());
  io::write_text(directory / "s.changes", "");
  EXPECT_EQ(find_change_files(directory / "s", {}).changes, directory / "s.changes");
}

TEST(FindChangeFiles, ALinkBelongsToTheSetThatHoldsIt) {
  io::TestDirectory directory;
  for (const char* name : {"old/test/a/view.txt", "old/test/a.events.json", "old/test/a.changes", "new/test/x"})
    io::write_text(directory / name, "");
  std::filesystem::create_directory_symlink(directory / "old/test/a", directory / "new/test/a");
  EXPECT_TRUE(find_change_files(directory / "new/test/a", {}).empty());
  EXPECT_FALSE(find_change_files(directory / "new/test/../../old/test/a/.", {}).events.empty());
}

class ConvertChanges : public testing::TestWithParam<DatasetFormat> {
 protected:
  // Views 0, 3 and 6 with a mug that moves after the first one.
  void write_input(DatasetFormat format) {
    const auto writer = create_sequence(directory_ / "in", format);
    ASSERT_TRUE(writer.ok());
    Rng rng(5);
    for (int i = 0; i < 3; ++i)
      ASSERT_TRUE((*writer)
                      ->write_view(io::random_frame("cloud_" + std::to_string(3 * i), i),
                                   {{"mug", 0, i % 2, io::random_pose(rng), 0.5}})
                      .ok());
    ASSERT_TRUE((*writer)->finish().ok());
    io::write_text(directory_ / "in.events.json", "any text");
    io::write_text(directory_ / "in.changes", "cloud_0_mug_0.txt\ncloud_3_mug_1.txt cloud_6_mug_0.txt\n");
    files_ = {directory_ / "in.events.json", directory_ / "in.changes"};
  }
  io::TestDirectory directory_;
  ChangeFiles files_;
};

TEST_P(ConvertChanges, AreKeptWithTheNewNamesOfTheViews) {
  for (const DatasetFormat own : {DatasetFormat::kTuw, DatasetFormat::kBop}) {
    std::filesystem::remove_all(directory_ / "in");
    std::filesystem::remove_all(directory_ / "out");
    write_input(own);
    const auto sequence = open_sequence(directory_ / "in");
    ASSERT_TRUE(sequence.ok()) << sequence.error().message;
    const auto done = convert_sequence(**sequence, directory_ / "out", GetParam(), files_);
    ASSERT_TRUE(done.ok()) << done.error().message;
    const ChangeFiles kept = find_change_files(directory_ / "out", {});
    EXPECT_EQ(io::read_text(kept.events), "any text");
    const std::string text = io::read_text(kept.changes);
    const bool keeps_names = own == GetParam() && own == DatasetFormat::kTuw;
    if (keeps_names) {
      EXPECT_EQ(text, io::read_text(files_.changes));
    } else {
      EXPECT_EQ(text, "000000_mug_0.txt\n000003_mug_1.txt 000006_mug_0.txt\n");
    }
  }
}

TEST_P(ConvertChanges, LeaveNothingIfTheyDoNotFit) {
  write_input(DatasetFormat::kTuw);
  const auto sequence = open_sequence(directory_ / "in");
  ASSERT_TRUE(sequence.ok());
  for (const char* text : {"cloud_1_mug_0.txt\n", "nonsense\n", "cloud_3_mug_0.txt\n"}) {
    io::write_text(files_.changes, text);
    const auto done = convert_sequence(**sequence, directory_ / "out", GetParam(), files_);
    ASSERT_FALSE(done.ok());
    EXPECT_THAT(done.error().message, HasSubstr(files_.changes.string() + ": "));
    EXPECT_FALSE(std::filesystem::exists(directory_ / "out"));
  }
}

INSTANTIATE_TEST_SUITE_P(Formats, ConvertChanges, testing::Values(DatasetFormat::kTuw, DatasetFormat::kBop));

}  // namespace
}  // namespace resight
