// SPDX-License-Identifier: Apache-2.0
#include "reader.hpp"
#include "resight/core/names.hpp"
#include "resight/core/printable.hpp"
#include "resight/io/internal/bop_dataset.hpp"
#include "resight/io/internal/calibration.hpp"
#include "resight/io/internal/json_poses.hpp"
#include "resight/io/internal/model_files.hpp"
#include "resight/io/internal/text.hpp"
#include "resight/io/internal/trajectory_file.hpp"
#include "resight/io/internal/tuw_names.hpp"
#include "resight/io/pose_text.hpp"
#include "resight/io/tuw_changes.hpp"
#include "resight/io/tuw_ground_truth.hpp"

namespace resight::fuzz {
namespace {

using Seeds = std::vector<std::string>;

constexpr const char* kPose = "1 0 0 0.5 0 1 0 -0.25 0 0 1 1.5 0 0 0 1";

Seeds make_symmetry_seeds() {
  return {
      R"({"1":{"name":"cup","diameter":90.5,"min_x":-45,"symmetries_continuous":[{"axis":[0,0,1],"offset":[0,0,0]}]},)"
      R"("12":{"symmetries_discrete":[[-1,0,0,0,0,-1,0,0,0,0,1,0,0,0,0,1]]}})"};
}
Seeds make_extras_seeds() {
  return {R"({"obj_id":7,"symmetries_continuous":[{"axis":[0,0,1],"offset":[0,0,2]}]})",
          R"({"symmetries_discrete":[[-1,0,0,0,0,-1,0,0,0,0,1,0,0,0,0,1]]})"};
}

Seeds make_trajectory_seeds() {
  return {"# stamp tx ty tz qx qy qz qw\n1.5 0 0 0 0 0 0 1\n1.6,1,2,3,0,0,0.7071068,0.7071068\nview_3 0 0 0 0 0 0 1\n",
          "1 0 0 0 0 1 0 0 0 0 1 0\n", std::string(kPose) + "\n" + kPose + "\n",
          "0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n", "1.5 nan nan nan nan nan nan nan\n"};
}
void read_trajectory(std::string_view bytes) {
  const auto file = write_scratch("poses.txt", bytes);
  (void)io::read_pose_list(file, true);
  const auto poses = io::read_pose_list(file, false);
  if (poses) (void)io::interpolate_pose(*poses, 1.55);
}

Seeds make_json_pose_seeds() {
  const std::string matrix = "[[1,0,0,1],[0,1,0,2],[0,0,1,3],[0,0,0,1]]";
  return {R"({"fl_x":60,"fl_y":60,"cx":4,"cy":3,"frames":[{"file_path":"rgb/0.jpg","transform_matrix":)" + matrix +
              R"(,"fl_x":60,"fl_y":61,"cx":4,"cy":3}]})",
          R"({"K":[60,0,0,0,60,0,4,3,1],"poses":[[0,0,0,1,1,2,3],[0,0,0,1,1,2,4]]})",
          R"({"fx":60,"fy":60,"cx":4,"cy":3,"t_00":1,"t_01":0,"t_02":0,"t_03":1,"t_10":0,"t_11":1,"t_12":0,"t_13":2,)"
          R"("t_20":0,"t_21":0,"t_22":1,"t_23":3})",
          R"({"intrinsics":[60,0,4,0,60,3,0,0,1],"cameraPoseARFrame":[1,0,0,1,0,1,0,2,0,0,1,3,0,0,0,1]})"};
}
void read_json_poses(std::string_view bytes) {
  const auto file = write_scratch("poses.json", bytes);
  (void)io::holds_json_poses(file);
  (void)io::read_json_poses(file);
  (void)io::read_frame_calibrations(file);
  (void)io::read_view_camera(file);
}

Seeds make_calibration_seeds() {
  return {
      "525 525 319.5 239.5\n",
      "525 0 319.5\n0 525 239.5\n0 0 1\n",
      "%YAML:1.0\nimage_width: 640\ncamera_matrix: !!opencv-matrix\n  rows: 3\n  cols: 3\n  data: [525, 0, 319.5, 0, "
      "525, 239.5, 0, 0, 1]\ndistortion_model: plumb_bob\ndistortion_coefficients:\n  data: [0.1, -0.2, 0, 0, 0]\n",
      "[camera]\nfx = 525.0\nfy = 525\ncx=319.5\ncy = 239.5\ndepth_scale = 1000\n",
      R"({"width":640,"height":480,"intrinsic_matrix":[525,0,0,0,525,0,319.5,239.5,1],"depth_scale":0.001})",
      R"({"color":{"fx":525,"fy":525,"cx":319.5,"cy":239.5,"k1":0.1},"depth":{"fx":500,"fy":500,"ppx":1,"ppy":2}})"};
}
void read_calibration_file(std::string_view bytes) {
  for (const char* name : {"camera.txt", "camera.json"}) {
    const auto calibration = io::read_calibration(write_scratch(name, bytes));
    if (calibration) (void)io::check_calibration(*calibration, 640, 480, "fuzz");
  }
}

void read_names(std::string_view bytes) {
  (void)io::split_annotation_name(bytes);
  (void)io::split_object_instance(bytes);
  (void)io::normalized_view(bytes);
  (void)io::trailing_number(bytes);
  (void)io::parse_bop_object_name(bytes);
  (void)io::is_safe_name(bytes);
  (void)io::natural_less(bytes.substr(0, bytes.size() / 2), bytes.substr(bytes.size() / 2));
  (void)check_object_name(std::string(bytes));
  (void)printable(bytes);
}

}  // namespace

std::vector<FuzzReader> dataset_readers() {
  return {
      {"bop_models_info", make_symmetry_seeds,
       [](std::string_view bytes) { (void)io::read_models_info(write_scratch("models_info.json", bytes)); }},
      {"model_info", make_extras_seeds,
       [](std::string_view bytes) { (void)io::read_model_extras(write_scratch("model_info.json", bytes)); }},
      {"tuw_pose",
       [] {
         return Seeds{kPose, std::string("label ") + kPose, "1 0 0 0 0 1 0 0 0 0 1 0"};
       },
       [](std::string_view bytes) { (void)parse_pose(bytes, "fuzz"); }},
      {"tuw_anno", [] { return Seeds{std::string("cup_0 (0.75): ") + kPose + "\nbox_1 (1): " + kPose + "\n"}; },
       [](std::string_view bytes) { (void)parse_tuw_anno(bytes, "fuzz"); }},
      {"tuw_changes",
       [] { return Seeds{"cloud_01_cup_0.txt cloud_02_cup_0.txt\n\ncloud_2_a_b_1  cloud_003_a_b_0.txt\n"}; },
       [](std::string_view bytes) {
         const auto chains = parse_changes(bytes, "fuzz");
         if (chains) (void)resolve_changes(*chains, {"cloud_01", "cloud_02", "cloud_003"}, "fuzz");
       }},
      {"trajectory", make_trajectory_seeds, read_trajectory},
      {"json_poses", make_json_pose_seeds, read_json_poses},
      {"calibration", make_calibration_seeds, read_calibration_file},
      {"names",
       [] {
         return Seeds{"cloud_0012_red_cup_3", "obj_000005.ply", "cup_0", "a\x1b[31m\xc3\xa4"};
       },
       read_names},
  };
}

}  // namespace resight::fuzz
