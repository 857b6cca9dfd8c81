// SPDX-License-Identifier: Apache-2.0
#include <array>

#include "reader.hpp"
#include "resight/io/images.hpp"
#include "resight/io/internal/sequences.hpp"
#include "resight/io/sequence.hpp"

/// Folders of one view. Its images are valid; the files about it are the input.
namespace resight::fuzz {
namespace {

namespace fs = std::filesystem;
using Seeds = std::vector<std::string>;

constexpr int kWidth = 16;
constexpr int kHeight = 12;

void write_images(const char* color, const char* depth) {
  Image<float> depth_m(kWidth, kHeight, 1.25F);
  (void)write_color(scratch_folder() / color, Image<Rgb8>(kWidth, kHeight, Rgb8{90, 80, 70}));
  (void)write_depth(scratch_folder() / depth, depth_m, 1e-4);
}

/// The poses, the ground truth, and the view with its lens.
void read_all(const io::SequenceResult& opened) {
  if (!opened) return;
  const Sequence& sequence = **opened;
  for (int view = 0; view < std::min(sequence.num_views(), 3); ++view) (void)sequence.read_pose(view);
  if (sequence.has_ground_truth()) (void)sequence.read_ground_truth(0);
  if (sequence.num_views() > 0) (void)sequence.read_view(0);
}

constexpr std::array kBopFiles = {"scene_camera.json", "scene_gt.json", "scene_gt_info.json"};
Seeds make_bop_seeds() {
  const std::array<std::string, 3> scene = {
      R"({"0":{"cam_K":[20,0,8,0,20,6,0,0,1],"depth_scale":0.1,"cam_R_w2c":[1,0,0,0,1,0,0,0,1],"cam_t_w2c":[1,2,3.5]}})",
      R"({"0":[{"cam_R_m2c":[1,0,0,0,1,0,0,0,1],"cam_t_m2c":[0,0,900],"obj_id":5,"instance":1,"name":"cup"}]})",
      R"({"0":[{"visib_fract":0.75}]})"};
  return {join_files(scene), scene[0]};
}
void read_bop(std::string_view bytes) {
  static const bool has_images = (write_images("rgb/000000.png", "depth/000000.png"), true);
  (void)has_images;
  read_all(io::open_bop_scene(write_bundle(bytes, kBopFiles)));
}

constexpr std::array kTumFiles = {"rgb.txt", "depth.txt", "groundtruth.txt", "camera.txt", "associations.txt"};
Seeds make_tum_seeds() {
  const std::string camera = "fx: 20\nfy: 20\ncx: 8\ncy: 6\nk1: 0.1\nk2: -0.05\np1: 0.001\np2: 0\nk3: 0\n";
  const std::string poses = "1.00 0 0 0 0 0 0 1\n1.05 0.1 0 0 0 0 0 1\n";
  const std::array<std::string, 4> lists = {"# t file\n1.01 rgb/0.png\n", "1.02 depth/0.png\n", poses, camera};
  const std::array<std::string, 5> pairs = {"", "", poses, "20 20 8 6 0.1 0 0 0", "1.02 depth/0.png 1.01 rgb/0.png\n"};
  return {join_files(lists), join_files(pairs)};
}
void read_tum(std::string_view bytes) {
  static const bool has_images = (write_images("rgb/0.png", "depth/0.png"), true);
  (void)has_images;
  read_all(io::open_tum_sequence(write_bundle(bytes, kTumFiles), {}));
}

constexpr std::array kFolderFiles = {"intrinsics.json", "given_poses.txt"};
Seeds make_folder_seeds() {
  const std::array<std::string, 2> files = {
      R"({"width":16,"height":12,"fx":20,"fy":20,"cx":8,"cy":6,"distortion_model":"plumb_bob","distortion_coefficients":[0.1,0,0,0,0]})",
      "color_0 0 0 0 0 0 0 1\ncolor_1 0 0.1 0 0 0 0 1\n"};
  return {join_files(files), files[0] + "\n@@@@\n1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 0 0 1 0 0 0 0 1 1\n"};
}
void read_folder(std::string_view bytes) {
  static const bool has_images =
      (write_images("color_0.png", "depth_0.png"), write_images("color_1.png", "depth_1.png"), true);
  (void)has_images;
  const fs::path& folder = write_bundle(bytes, kFolderFiles);
  OpenSequenceOptions options;
  if (fs::exists(folder / kFolderFiles[1])) options.poses = folder / kFolderFiles[1];
  read_all(io::open_image_folder(folder, options));
}

constexpr const char* kTruthPerView =
    R"({"frames":{"0":[{"object":"cup","camera_from_object":[[1,0,0,0],[0,1,0,0],[0,0,1,1],[0,0,0,1]]}]}})";
constexpr const char* kTruthInWorld = R"({"cup":{"T_world_model":[[1,0,0,0],[0,1,0,0],[0,0,1,1],[0,0,0,1]]}})";

constexpr std::array kCameraInfoFiles = {"cam.info.txt", "derived/pseudo_gt.json"};
Seeds make_camera_info_seeds() {
  const std::array<std::string, 2> files = {
      "# Color camera intrinsic matrix\n20 0 8\n0 20 6\n0 0 1\n"
      "# Camera-to-world extrinsic 0\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n",
      kTruthInWorld};
  return {join_files(files), files[0]};
}
void read_camera_info_folder(std::string_view bytes) {
  static const bool has_images = (write_images("0.color.png", "0.depth.png"), true);
  (void)has_images;
  fs::create_directory(scratch_folder() / "derived");
  read_all(io::open_camera_info_sequence(write_bundle(bytes, kCameraInfoFiles)));
}

constexpr std::array kFixedCameraFiles = {"meta.yml", "derived/pseudo_gt.json"};
Seeds make_fixed_camera_seeds() {
  const std::array<std::string, 2> files = {"INTRINSICS: [20.0, 0.0, 8.0,\n 0, 20, 6, 0, 0, 1]\n", kTruthPerView};
  return {join_files(files), files[0]};
}
void read_fixed_camera_folder(std::string_view bytes) {
  static const bool has_images = (write_images("0-color.png", "0-depth.png"), true);
  (void)has_images;
  fs::create_directory(scratch_folder() / "derived");
  read_all(io::open_fixed_camera_sequence(write_bundle(bytes, kFixedCameraFiles), {}));
}

}  // namespace

std::vector<FuzzReader> sequence_readers() {
  return {
      {"bop_scene", make_bop_seeds, read_bop, 500},
      {"tum_folder", make_tum_seeds, read_tum, 500},
      {"image_folder", make_folder_seeds, read_folder, 300},
      {"camera_info_folder", make_camera_info_seeds, read_camera_info_folder, 500},
      {"fixed_camera_folder", make_fixed_camera_seeds, read_fixed_camera_folder, 500},
  };
}

}  // namespace resight::fuzz
