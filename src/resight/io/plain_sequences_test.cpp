// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include "resight/io/images.hpp"
#include "resight/io/internal/test_data.hpp"

namespace resight {
namespace {

using testing::HasSubstr;

constexpr const char* kIdentity = "[[1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]]";

void write_one_view(const std::filesystem::path& color, const std::filesystem::path& depth) {
  ASSERT_TRUE(write_color(color, Image<Rgb8>(4, 3)).ok());
  ASSERT_TRUE(write_depth(depth, Image<float>(4, 3, 1.0F), 0.001).ok());
}

void write_fixed_camera_view(const io::TestDirectory& directory, const std::string& object) {
  write_one_view(directory / "0-color.png", directory / "0-depth.png");
  io::write_text(directory / "meta.yml", "INTRINSICS: [50, 0, 1.5, 0, 50, 1, 0, 0, 1]\n");
  std::string truth = R"({"frames": {"0": [{"object": ")";
  truth += object;
  truth += R"(", "camera_from_object": )";
  truth += kIdentity;
  io::write_text(directory / "derived/pseudo_gt.json", truth + "}]}}");
}

void write_camera_info_view(const io::TestDirectory& directory, const std::string& object) {
  write_one_view(directory / "0.color.png", directory / "0.depth.png");
  io::write_text(directory / "cam.info.txt",
                 "# Color camera intrinsic matrix\n50 0 1.5\n0 50 1\n0 0 1\n"
                 "# Camera-to-world extrinsics\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n");
  std::string truth = R"({")";
  truth += object;
  truth += R"(": {"T_world_model": )";
  truth += kIdentity;
  io::write_text(directory / "derived/pseudo_gt.json", truth + "}}");
}

TEST(PlainSequences, NamesThatCannotBeThoseOfObjectsAreRefused) {
  for (const auto write_view : {&write_fixed_camera_view, &write_camera_info_view}) {
    io::TestDirectory directory;
    write_view(directory, "red mug");
    const auto sequence = open_sequence(directory.path());
    ASSERT_TRUE(sequence.ok()) << sequence.error().message;
    const auto truth = (*sequence)->read_ground_truth(0);
    ASSERT_EQ(truth->size(), 1U) << (*sequence)->format();
    EXPECT_EQ(truth->front().object, "red mug");
    for (const char* name : {"", "../../x", "a\\nb"}) {
      write_view(directory, name);
      const auto refused = open_sequence(directory.path());
      ASSERT_FALSE(refused.ok()) << name;
      EXPECT_THAT(refused.error().message, HasSubstr("pseudo_gt.json: "));
      EXPECT_THAT(refused.error().message, HasSubstr("the name of an object"));
    }
  }
}

}  // namespace
}  // namespace resight
