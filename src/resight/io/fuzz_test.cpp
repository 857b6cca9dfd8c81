// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "resight/io/images.hpp"
#include "resight/io/internal/test_data.hpp"
#include "resight/io/model_source.hpp"
#include "resight/io/organized_pcd.hpp"
#include "resight/io/ply.hpp"
#include "resight/io/pose_text.hpp"
#include "resight/io/tuw_changes.hpp"
#include "resight/io/tuw_ground_truth.hpp"

/// Damaged files must give a value or an error, but never a crash (most effective with sanitizers). Seeds are fixed.
namespace resight {
namespace {

constexpr int kMutations = 400;
constexpr int kFileMutations = 80;  ///< For formats that must be written to disk.

/// Makes one to eight changes: replaces a byte, cuts or doubles a run, inserts an extreme number, or truncates.
std::string mutate(std::string bytes, Rng& rng) {
  constexpr std::string_view kWild[] = {
      "-1", "0", "99999999999999999999", "2147483647", "4294967295", "nan", "inf", "1e308", "{", "\"", "\n", " "};
  const int num_changes = 1 + static_cast<int>(rng.below(8));
  for (int i = 0; i < num_changes && !bytes.empty(); ++i) {
    // Half of the changes affect the header, which is short and most important.
    const auto range =
        static_cast<std::uint32_t>(rng.below(2) == 0 ? std::min<std::size_t>(bytes.size(), 300) : bytes.size());
    const std::size_t at = rng.below(range);
    switch (rng.below(6)) {
      case 0:
        bytes[at] = static_cast<char>(rng.below(256));
        break;
      case 1:
        bytes[at] = static_cast<char>(bytes[at] ^ (1 << rng.below(8)));
        break;
      case 2:
        bytes.erase(at, 1 + rng.below(12));
        break;
      case 3:
        bytes.insert(at, bytes.substr(at, 1 + rng.below(12)));
        break;
      case 4:
        bytes.insert(at, kWild[rng.below(std::size(kWild))]);
        break;
      default:
        if (rng.below(4) == 0) bytes.resize(at);
        break;
    }
  }
  return bytes;
}

struct Outcome {
  int num_read = 0;
  int num_refused = 0;
};

/// Feeds mutations of `seed_file` to `read`, which returns a Result.
template <typename Read>
Outcome fuzz(const std::string& seed_file, std::uint64_t seed, const Read& read, int num_mutations = kMutations) {
  EXPECT_TRUE(read(seed_file).ok()) << "the undamaged file must be readable";
  Outcome outcome;
  for (int i = 0; i < num_mutations; ++i) {
    Rng rng = Rng::stream(seed, static_cast<std::uint64_t>(i));
    const auto result = read(mutate(seed_file, rng));
    ++(result.ok() ? outcome.num_read : outcome.num_refused);
    EXPECT_TRUE(result.ok() || !result.error().message.empty());
  }
  return outcome;
}

void expect_both(const Outcome& outcome) {
  EXPECT_GE(outcome.num_read + outcome.num_refused, kFileMutations);
  EXPECT_GT(outcome.num_refused, (outcome.num_read + outcome.num_refused) / 10);
}

class FuzzPcd : public testing::TestWithParam<PcdEncoding> {};

TEST_P(FuzzPcd, NeverCrashes) {
  io::TestDirectory directory;
  PcdCloud cloud = to_pcd_cloud(io::random_frame("a", 1, 24, 18));
  ASSERT_TRUE(write_pcd(directory / "a.pcd", cloud, GetParam()).ok());
  expect_both(fuzz(io::read_text(directory / "a.pcd"), 1, [](const std::string& bytes) -> Result<RgbdFrame> {
    const auto read = parse_pcd(bytes, "a.pcd");
    if (!read) return read.error();
    EXPECT_EQ(read->points.size(), static_cast<std::size_t>(read->width) * static_cast<std::size_t>(read->height));
    auto frame = to_frame(*read, "a.pcd");
    if (!frame) return frame;
    const auto checked = check_frame(*frame);
    return checked ? std::move(frame) : Result<RgbdFrame>(checked.error());
  }));
}
INSTANTIATE_TEST_SUITE_P(Encodings, FuzzPcd,
                         testing::Values(PcdEncoding::kAscii, PcdEncoding::kBinary, PcdEncoding::kBinaryCompressed));

TEST(Fuzz, PlyAsciiAndBinary) {
  io::TestDirectory directory;
  TriangleMesh mesh;
  for (int i = 0; i < 40; ++i) mesh.vertices.push_back({static_cast<float>(i), static_cast<float>(i * i), 1});
  for (int i = 0; i + 2 < 40; ++i) mesh.faces.push_back({i, i + 1, i + 2});
  mesh.colors.resize(40);
  ASSERT_TRUE(write_ply(directory / "m.ply", mesh).ok());
  const auto read = [](const std::string& bytes) {
    auto content = parse_ply(bytes, "m.ply");
    if (content.ok()) {
      for (const auto& face : content->mesh.faces)
        for (const int v : face) EXPECT_LT(static_cast<std::size_t>(v), content->mesh.vertices.size());
    }
    return content;
  };
  expect_both(fuzz(io::read_text(directory / "m.ply"), 2, read));
  std::string ascii =
      "ply\nformat ascii 1.0\ncomment TextureFile t.png\nelement vertex 12\nproperty float x\nproperty float "
      "y\nproperty float z\n"
      "element face 4\nproperty list uchar int vertex_indices\nproperty list uchar float texcoord\nend_header\n";
  for (int i = 0; i < 12; ++i) ascii += std::to_string(i) + " " + std::to_string(0.5 * i) + " 1\n";
  for (int i = 0; i < 4; ++i) ascii += "3 0 " + std::to_string(i + 1) + " 5 6 0 0 0.5 0 1 1\n";
  expect_both(fuzz(ascii, 3, read));
}

TEST(Fuzz, BopJson) {
  io::TestDirectory directory;
  const auto writer = create_sequence(directory / "scene", DatasetFormat::kBop);
  Rng rng(9);
  for (int i = 0; i < 3; ++i)
    ASSERT_TRUE(
        (*writer)
            ->write_view(io::random_frame(std::to_string(i), i, 8, 6), {{"mug", 0, 0, io::random_pose(rng), 0.5}})
            .ok());
  ASSERT_TRUE((*writer)->finish().ok());
  for (const char* file : {"scene_camera.json", "scene_gt.json", "scene_gt_info.json"}) {
    const std::string original = io::read_text(directory / "scene" / file);
    expect_both(fuzz(
        original, 4,
        [&](const std::string& bytes) -> Result<std::vector<GroundTruthObject>> {
          io::write_text(directory / "scene" / file, bytes);
          const auto sequence = open_sequence(directory / "scene");
          if (!sequence) return sequence.error();
          return (*sequence)->read_ground_truth(0);
        },
        kFileMutations));
    io::write_text(directory / "scene" / file, original);
  }
}

TEST(Fuzz, ModelsInfo) {
  io::TestDirectory directory;
  io::write_text(directory / "models/obj_000001.ply", "");
  expect_both(
      fuzz(R"({"1": {"name": "mug", "diameter": 10.5, "symmetries_discrete": [[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1]],
                      "symmetries_continuous": [{"axis": [0,0,1], "offset": [0,0,0]}]}, "2": {"diameter": 1}})",
           5,
           [&](const std::string& bytes) {
             io::write_text(directory / "models/models_info.json", bytes);
             return find_models({directory / "models"});
           },
           kFileMutations));
}

TEST(Fuzz, Texts) {
  Rng rng(6);
  const std::string pose = format_pose(io::random_pose(rng));
  expect_both(fuzz(pose, 6, [](const std::string& text) { return parse_pose(text, "p.txt"); }));
  expect_both(fuzz("mug (0.5): " + pose + "\nbox (1): " + pose + "\n", 7,
                   [](const std::string& text) { return parse_tuw_anno(text, "a.anno"); }));
  expect_both(fuzz("cloud_00_mug_0.txt cloud_01_mug_0.txt\ncloud_00_red_box_0.txt cloud_02_red_box_1.txt\n", 8,
                   [](const std::string& text) -> Result<std::vector<ObjectPlacement>> {
                     const auto chains = parse_changes(text, "s.changes");
                     if (!chains) return chains.error();
                     return resolve_changes(*chains, {"cloud_00", "cloud_01", "cloud_02"}, "s.changes");
                   }));
}

TEST(Fuzz, TumLists) {
  io::TestDirectory directory;
  std::string list;
  std::string poses;
  for (int i = 0; i < 5; ++i) {
    const std::string n = std::to_string(i);
    list += n + ".5 rgb/" + n + ".png " + n + ".51 depth/" + n + ".png\n";
    poses += n + ".5 0.1 0.2 0.3 0 0 0 1\n" + n + ".52 0.1 0.2 0.3 0 0 0 1\n";
  }
  std::filesystem::create_directories(directory / "rgb");
  std::filesystem::create_directories(directory / "depth");
  io::write_text(directory / "camera.txt", "525 525 2 1\n");
  io::write_text(directory / "groundtruth.txt", poses);
  expect_both(fuzz(
      list, 10,
      [&](const std::string& text) {
        io::write_text(directory / "associations.txt", text);
        return open_sequence(directory.path());
      },
      kFileMutations));
  io::write_text(directory / "associations.txt", list);
  expect_both(fuzz(
      poses, 11,
      [&](const std::string& text) {
        io::write_text(directory / "groundtruth.txt", text);
        return open_sequence(directory.path());
      },
      kFileMutations));
}

TEST(Fuzz, Images) {
  io::TestDirectory directory;
  for (const char* file : {"c.png", "c.jpg"}) {
    ASSERT_TRUE(write_color(directory / file, io::random_frame("a", 1, 8, 6).color).ok());
    expect_both(fuzz(io::read_text(directory / file), 12,
                     [](const std::string& bytes) { return decode_color(bytes, "fuzz", 1 << 18); }));
  }
}

}  // namespace
}  // namespace resight
