// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "resight/core/random.hpp"
#include "resight/core/timing.hpp"
#include "resight/io/sequence.hpp"
#include "resight/sensor/training_view.hpp"

/// Small data for the tests of this module.
namespace resight::io {

/// A directory for the running test. It is empty at the start and removed at the end.
class TestDirectory {
 public:
  TestDirectory() {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    std::string name = std::string(test->test_suite_name()) + "_" + test->name();
    std::ranges::replace(name, '/', '_');  // of a parametrised test
    path_ = std::filesystem::temp_directory_path() / ("resight_io_" + std::to_string(::getpid()) + "_" + name);
    std::filesystem::remove_all(path_);
    std::filesystem::create_directories(path_);
  }
  ~TestDirectory() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TestDirectory(const TestDirectory&) = delete;
  TestDirectory& operator=(const TestDirectory&) = delete;
  [[nodiscard]] std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// By how much the peak of the memory has grown since this was made.
class MemoryGrowth {
 public:
  [[nodiscard]] std::size_t bytes() const { return peak_memory_bytes() - before_; }

 private:
  std::size_t before_ = peak_memory_bytes();
};

inline void write_text(const std::filesystem::path& file, const std::string& text) {
  std::filesystem::create_directories(file.parent_path());
  std::ofstream(file, std::ios::binary) << text;
}

inline std::string read_text(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

inline Rigid3 random_pose(Rng& rng) {
  const double angle_rad = rng.uniform(0, 3);
  Rigid3 pose = Rigid3::from_axis_angle({rng.normal(), rng.normal(), rng.normal()}, angle_rad);
  pose.translation = {rng.normal(), rng.normal(), rng.normal()};
  return pose;
}

/// Random colours, a slanted depth in multiples of 0.1 mm with holes, an asymmetric camera, a random pose.
inline RgbdFrame random_frame(const std::string& name, std::uint64_t seed, int width = 48, int height = 36) {
  Rng rng(seed);
  RgbdFrame frame;
  frame.name = name;
  frame.camera = {width,
                  height,
                  51.25 + rng.uniform(),
                  52.5 + rng.uniform(),
                  width / 2.0 - 1 + rng.uniform(),
                  height / 2.0 + rng.uniform()};
  frame.color = Image<Rgb8>(width, height);
  frame.depth_m = Image<float>(width, height);
  for (std::size_t i = 0; i < frame.color.size(); ++i) {
    frame.color[i] = {static_cast<std::uint8_t>(rng.below(256)), static_cast<std::uint8_t>(rng.below(256)),
                      static_cast<std::uint8_t>(rng.below(256))};
    const bool hole = rng.uniform() < 0.2;
    const double tenth_mm = 5000 + static_cast<double>(i) + rng.below(200);
    frame.depth_m[i] = hole ? std::numeric_limits<float>::quiet_NaN() : static_cast<float>(tenth_mm * 1e-4);
  }
  frame.world_from_camera = random_pose(rng);
  return frame;
}

inline TrainingView random_training_view(const std::string& name, std::uint64_t seed) {
  TrainingView view{random_frame(name, seed), {}};
  view.mask = Image<std::uint8_t>(view.frame.camera.width, view.frame.camera.height, 0);
  for (int v = 10; v < 25; ++v)
    for (int u = 12; u < 30; ++u) view.mask(u, v) = 255;
  return view;
}

/// Largest deviation of two poses over all matrix elements (metres for the translation).
inline double pose_difference(const Rigid3& a, const Rigid3& b) {
  return (a.matrix() - b.matrix()).cwiseAbs().maxCoeff();
}

/// Largest deviation of depth; infinite if holes or sizes differ.
inline double depth_difference_m(const Image<float>& a, const Image<float>& b) {
  if (a.width() != b.width() || a.height() != b.height()) return std::numeric_limits<double>::infinity();
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (std::isnan(a[i]) != std::isnan(b[i])) return std::numeric_limits<double>::infinity();
    if (!std::isnan(a[i])) largest = std::max(largest, std::abs(static_cast<double>(a[i]) - b[i]));
  }
  return largest;
}

inline std::filesystem::path shared_data(const std::string& name) {
  return std::filesystem::path(RESIGHT_SHARED_DATA_DIR) / name;
}

/// Skips the running test if the data set is not available.
#define RESIGHT_NEEDS_DATA(name) \
  if (!std::filesystem::exists(resight::io::shared_data(name))) GTEST_SKIP() << "no data set " << (name)

}  // namespace resight::io
