// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>

#include "cli.hpp"
#include "resight/core/random.hpp"
#include "resight/io/images.hpp"
#include "resight/io/ply.hpp"
#include "resight/io/sequence.hpp"
#include "resight/models/library_file.hpp"
#include "resight/training/training.hpp"

namespace resight::cli_test {
namespace {

// A slanted wall in random colours.
RgbdFrame make_frame(int index) {
  Rng rng(static_cast<std::uint64_t>(index));
  RgbdFrame frame{.name = "cloud_0" + std::to_string(index),
                  .camera = {kWidth, kHeight, 60, 60, 31.5, 23.5},
                  .color = Image<Rgb8>(kWidth, kHeight),
                  .depth_m = Image<float>(kWidth, kHeight),
                  .world_from_camera = {}};
  for (std::size_t i = 0; i < frame.color.size(); ++i) {
    frame.color[i] = {static_cast<std::uint8_t>(rng.below(256)), static_cast<std::uint8_t>(rng.below(256)), 90};
    frame.depth_m[i] = 1.0F + 0.0001F * static_cast<float>(i % 1000);
  }
  return frame;
}

void write_sequence(const fs::path& folder, DatasetFormat format) {
  const auto writer = create_sequence(folder, format);
  ASSERT_TRUE(writer.ok()) << writer.error().message;
  for (int i = 0; i < kViews; ++i) ASSERT_TRUE((*writer)->write_view(make_frame(i), {{"cube", 1, 0, {}, 0.5}}).ok());
  ASSERT_TRUE((*writer)->finish().ok());
}

void write_tum(const fs::path& folder) {
  std::string list;
  std::string poses;
  for (int i = 0; i < kViews; ++i) {
    const std::string stamp = std::to_string(i + 1) + ".0";
    const RgbdFrame frame = make_frame(i);
    ASSERT_TRUE(write_color(folder / "rgb" / (stamp + ".png"), frame.color).ok());
    ASSERT_TRUE(write_depth(folder / "depth" / (stamp + ".png"), frame.depth_m, 1.0 / 5000).ok());
    list += stamp + " rgb/" + stamp + ".png " + stamp + " depth/" + stamp + ".png\n";
    poses += stamp + " 0 0 0 0 0 0 1\n";
  }
  write_text(folder / "associations.txt", list);
  write_text(folder / "groundtruth.txt", poses);
  write_text(folder / "camera.txt", "60 60 31.5 23.5\n");
}

CodedFeatures make_features(FeatureType type, int dimension, int count) {
  Rng rng(3);
  FeatureSet set{.type = type, .dimension = dimension, .points = {}, .normals = {}, .descriptors = {}};
  for (int i = 0; i < count; ++i) {
    set.points.push_back(
        {static_cast<float>(rng.uniform(-0.04, 0.04)), static_cast<float>(rng.uniform(-0.04, 0.04)), -0.04F});
    set.normals.push_back(-Eigen::Vector3f::UnitZ());
    Eigen::VectorXf descriptor(dimension);
    for (float& value : descriptor) value = static_cast<float>(rng.uniform());
    descriptor.normalize();
    set.descriptors.insert(set.descriptors.end(), descriptor.begin(), descriptor.end());
  }
  return encode(set);
}

}  // namespace

void write_text(const fs::path& file, const std::string& text) {
  fs::create_directories(file.parent_path());
  std::ofstream(file, std::ios::binary) << text;
}

std::string read_text(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

TriangleMesh make_cube(float metre) {
  TriangleMesh mesh;
  for (int axis = 0; axis < 3; ++axis)
    for (const float side : {-0.04F, 0.04F}) {
      const int first = static_cast<int>(mesh.vertices.size());
      for (const auto& [u, v] : {std::pair(-1, -1), {1, -1}, {1, 1}, {-1, 1}}) {
        Eigen::Vector3f p;
        p[axis] = side;
        p[(axis + 1) % 3] = 0.04F * static_cast<float>(side > 0 ? u : v);
        p[(axis + 2) % 3] = 0.04F * static_cast<float>(side > 0 ? v : u);
        mesh.vertices.push_back(metre * p);
        mesh.colors.push_back({static_cast<std::uint8_t>(80 * axis + 60), 120, 70});
      }
      mesh.faces.push_back({first, first + 1, first + 2});
      mesh.faces.push_back({first, first + 2, first + 3});
    }
  return mesh;
}

ModelLibrary make_library(int num_features) {
  ObjectModel cube{.name = "cube",
                   .bop_id = 1,
                   .surface = {},
                   .sift = make_features(FeatureType::kSift, 128, num_features),
                   .shot = make_features(FeatureType::kShot, 352, num_features),
                   .symmetries = {},
                   .center = Eigen::Vector3f::Zero(),
                   .diameter_m = 0.14F};
  for (int i = 0; i < 20; ++i)
    for (int j = 0; j < 20; ++j) {
      cube.surface.points.push_back({0.004F * static_cast<float>(i - 10), 0.004F * static_cast<float>(j - 10), -0.04F});
      cube.surface.normals.push_back(-Eigen::Vector3f::UnitZ());
      cube.surface.colors.push_back({120, 120, 120});
    }
  ModelLibrary library;
  library.objects.push_back(std::move(cube));
  library.options_hash = TrainOptions{}.hash();
  return library;
}

void write_good_data(const fs::path& folder) {
  write_sequence(folder / "views", DatasetFormat::kBop);
  write_sequence(folder / "tuw", DatasetFormat::kTuw);
  write_tum(folder / "tum");
  ASSERT_TRUE(write_ply(folder / "meshes/cube.ply", make_cube(1)).ok());
  ASSERT_TRUE(save_library(make_library(40), folder / "models.resight").ok());
  fs::create_directories(folder / "empty");
  write_text(folder / "full/mine.txt", "mine");
  write_text(folder / "file", "a file\n");
}

}  // namespace resight::cli_test
