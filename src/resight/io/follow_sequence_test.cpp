// SPDX-License-Identifier: Apache-2.0
#include "resight/io/follow_sequence.hpp"

#include <gmock/gmock.h>

#include "resight/io/images.hpp"
#include "resight/io/internal/test_data.hpp"

namespace resight {
namespace {

using io::TestDirectory;
using testing::HasSubstr;
using testing::IsEmpty;

OpenSequenceOptions fixed_camera() {
  OpenSequenceOptions options;
  options.intrinsics = "50,50,23.5,17.5";
  options.poses = "fixed";
  return options;
}

FollowSequenceOptions in_order(int max_tries = 20) { return {.skips_late = false, .max_tries = max_tries}; }

std::string image_name(const std::string& kind, int number) { return kind + "_" + std::to_string(number) + ".png"; }

/// The folder into which a camera writes numbered colour and depth images.
class WrittenFolder {
 public:
  [[nodiscard]] const std::filesystem::path& path() const { return folder_.path(); }
  void write_color_of(int number) const {
    ASSERT_TRUE(write_color(folder_ / image_name("color", number), frame(number).color).ok());
  }
  void write_depth_of(int number) const {
    ASSERT_TRUE(write_depth(folder_ / image_name("depth", number), frame(number).depth_m, 0.001).ok());
  }
  void write(int number) const {
    write_color_of(number);
    write_depth_of(number);
  }
  /// As much of the depth image as a writer has put there when it is asked too early.
  void write_start_of_depth(int number) const {
    write_depth_of(number);
    const std::string bytes = io::read_text(folder_ / image_name("depth", number));
    io::write_text(folder_ / image_name("depth", number), bytes.substr(0, bytes.size() / 2));
  }

 private:
  static RgbdFrame frame(int number) { return io::random_frame("view", static_cast<std::uint64_t>(number + 1)); }
  TestDirectory folder_;
};

std::string name_of(const std::optional<FollowedView>& view) { return view ? view->frame.name : "none"; }

TEST(FollowSequence, WaitsForAFolderThatIsNotThere) {
  const TestDirectory parent;
  SequenceFollower follower(parent / "later", fixed_camera());
  EXPECT_FALSE(follower.poll());
  EXPECT_THAT(follower.why_none(), HasSubstr("no such directory"));
  std::filesystem::create_directories(parent / "later");
  EXPECT_FALSE(follower.poll());
  EXPECT_THAT(follower.why_none(), HasSubstr("no sequence found"));
}

TEST(FollowSequence, TakesEachViewOnceItIsComplete) {
  const WrittenFolder folder;
  SequenceFollower follower(folder.path(), fixed_camera(), in_order());
  folder.write(1);
  EXPECT_EQ(name_of(follower.poll()), "color_1");
  EXPECT_FALSE(follower.poll());
  EXPECT_THAT(follower.why_none(), HasSubstr("no new view"));
  folder.write_color_of(2);
  EXPECT_FALSE(follower.poll()) << "its depth is not there";
  folder.write_start_of_depth(2);
  EXPECT_FALSE(follower.poll()) << "half of its depth is there";
  EXPECT_THAT(follower.why_none(), HasSubstr("cut off"));
  folder.write_depth_of(2);
  const auto view = follower.poll();
  ASSERT_TRUE(view);
  EXPECT_EQ(view->frame.name, "color_2");
  EXPECT_EQ(view->number, 1);
  EXPECT_EQ(view->image_id, 1);
  EXPECT_EQ(follower.num_skipped(), 0);
  EXPECT_THAT(follower.take_left_out(), IsEmpty());
}

TEST(FollowSequence, TheNewestViewOvertakesOthers) {
  const WrittenFolder folder;
  SequenceFollower follower(folder.path(), fixed_camera());
  for (int number = 1; number <= 12; ++number) folder.write(number);
  folder.write_color_of(13);
  folder.write_start_of_depth(13);
  EXPECT_EQ(name_of(follower.poll()), "color_12") << "13 is not complete";
  EXPECT_EQ(follower.num_skipped(), 11);
  EXPECT_FALSE(follower.poll());
  folder.write_depth_of(13);
  EXPECT_EQ(name_of(follower.poll()), "color_13");
  EXPECT_EQ(follower.num_skipped(), 11);
}

TEST(FollowSequence, AllAreTakenInOrderWhereNoneMayBeSkipped) {
  const WrittenFolder folder;
  SequenceFollower follower(folder.path(), fixed_camera(), in_order());
  for (int number = 8; number <= 11; ++number) folder.write(number);
  for (const char* name : {"color_8", "color_9", "color_10", "color_11"}) EXPECT_EQ(name_of(follower.poll()), name);
  EXPECT_FALSE(follower.poll());
  EXPECT_EQ(follower.num_skipped(), 0);
}

TEST(FollowSequence, AViewThatStaysDamagedIsLeftOut) {
  const WrittenFolder folder;
  SequenceFollower follower(folder.path(), fixed_camera(), in_order(3));
  folder.write(1);
  folder.write(3);
  folder.write_color_of(2);
  folder.write_start_of_depth(2);
  EXPECT_EQ(name_of(follower.poll()), "color_1");
  EXPECT_FALSE(follower.poll());
  EXPECT_FALSE(follower.poll());
  EXPECT_EQ(name_of(follower.poll()), "color_3");
  const std::vector<std::string> left_out = follower.take_left_out();
  ASSERT_EQ(left_out.size(), 1U);
  EXPECT_THAT(left_out[0], HasSubstr("depth_2.png"));
  EXPECT_THAT(follower.take_left_out(), IsEmpty());
}

TEST(FollowSequence, TheFirstViewWaitsForItsPose) {
  const WrittenFolder folder;
  OpenSequenceOptions options = fixed_camera();
  options.poses.clear();
  SequenceFollower follower(folder.path(), options, in_order());
  folder.write(1);
  EXPECT_FALSE(follower.poll());
  EXPECT_THAT(follower.why_none(), HasSubstr("no camera pose (give --poses fixed"));
  io::write_text(folder.path() / "pose_1.txt", "1 0 0 0\n0 1 0 0\n0 0 1 0.5\n0 0 0 1\n");
  const auto view = follower.poll();
  ASSERT_TRUE(view);
  EXPECT_EQ(view->frame.world_from_camera.translation.z(), 0.5);
}

TEST(FollowSequence, AViewWithoutItsPoseIsNotComplete) {
  const WrittenFolder folder;
  OpenSequenceOptions options = fixed_camera();
  options.poses.clear();
  SequenceFollower follower(folder.path(), options, in_order());
  const std::string pose = "1 0 0 0\n0 1 0 0\n0 0 1 0.5\n0 0 0 1\n";
  io::write_text(folder.path() / "pose_1.txt", pose);
  folder.write(1);
  EXPECT_EQ(name_of(follower.poll()), "color_1");
  folder.write(2);
  EXPECT_FALSE(follower.poll());
  io::write_text(folder.path() / "pose_2.txt", pose);
  const auto view = follower.poll();
  ASSERT_TRUE(view);
  EXPECT_EQ(view->frame.world_from_camera.translation.z(), 0.5);
}

}  // namespace
}  // namespace resight
