// SPDX-License-Identifier: Apache-2.0
// Each version of the benchmark stays what it was: results of a version compare only if its bytes do.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <span>
#include <string>
#include <vector>

#include "resight/core/hash.hpp"
#include "resight/simulation/dynamic_tabletop.hpp"
#include "resight/simulation/simulation.hpp"

namespace resight {
namespace {

constexpr int kBlockPx = 80;
constexpr double kTolerance = 0.5;  // a few pixels per block

// A text of a script whose numbers are rounded, so that the last digit of a processor's sine does not matter.
class ScriptText {
 public:
  explicit ScriptText(const SceneScript& s) {
    add(s.name);
    if (s.room_size_m) add(*s.room_size_m);
    for (const FurnitureScript& f : s.furniture) {
      add(f.key + f.kind);
      add(f.size_m);
      add(f.placement);
    }
    for (const ObjectScript& o : s.objects) {
      add(o.key + o.model + (o.known ? "+" : "-"));
      if (o.start) add(*o.start);
    }
    for (const ChangeScript& c : s.changes) {
      add(std::to_string(c.view) + std::string(to_string(c.kind)) + c.object);
      add(c.placement);
    }
    for (const Rigid3& pose : s.world_from_camera) add(pose);
    for (const double x :
         {s.sensor.lateral_noise, s.sensor.axial_noise, s.sensor.color_noise, s.lighting.ambient, s.lighting.diffuse})
      add(x);
    add(s.lighting.lamp_in_world_m);
    if (s.object_seed) add_version_3(s);
  }
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  void add_version_3(const SceneScript& s) {
    for (const Rigid3& pose : s.reported_world_from_camera) add(pose);
    for (const Lamp& lamp : s.lighting.lamps) {
      add(lamp.position_in_world_m);
      add(lamp.intensity);
      add(lamp.radius_m);
    }
    for (const FurnitureScript& f : s.furniture) add(f.material.specular);
    DepthErrors depth = s.sensor.depth_errors.value();
    ColorCamera color = s.sensor.color_camera.value();
    for (const Option& option : list_options(depth)) add(option);
    for (const Option& option : list_options(color)) add(option);
    add(s.color_lens.k1);
  }
  void add(const Option& option) {
    if (const auto* const* number = std::get_if<double*>(&option.pointer)) add(**number);
    if (const auto* const* count = std::get_if<int*>(&option.pointer)) add(std::to_string(**count));
  }
  void add(const std::string& text) { text_ += text + '\n'; }
  void add(double x) {
    char number[32];
    std::snprintf(number, sizeof number, "%.8f\n", x);
    text_ += std::string(number) == "-0.00000000\n" ? "0.00000000\n" : number;
  }
  void add(const Eigen::Vector3d& v) {
    for (const double x : v) add(x);
  }
  void add(const Rigid3& pose) {
    for (int c = 0; c < 3; ++c) add(Eigen::Vector3d(pose.rotation.col(c)));
    add(pose.translation);
  }
  void add(const Placement& p) {
    add(p.support + std::to_string(p.level));
    for (const double x : {p.x_m, p.y_m, p.yaw_rad, p.pitch_rad, p.roll_rad}) add(x);
    if (p.world_from_object) add(*p.world_from_object);
  }
  std::string text_;
};

std::uint64_t script_checksum(const std::vector<SceneScript>& scripts) {
  std::uint64_t hash = kHashSeed;
  for (const SceneScript& script : scripts) hash = hash_text(ScriptText(script).text(), hash);
  return hash;
}

std::uint64_t view_checksum(const RgbdFrame& frame) {
  const auto bytes = [](const auto& data) {
    return std::span(reinterpret_cast<const std::uint8_t*>(data.data()), data.size_bytes());
  };
  return hash_bytes(bytes(frame.depth_m.data()), hash_bytes(bytes(frame.color.data())));
}

// Means over blocks of colour (grey levels), depth (mm) and share of pixels with depth (%).
std::vector<double> block_means(const RgbdFrame& frame) {
  std::vector<double> means;
  for (int v0 = 0; v0 < frame.color.height(); v0 += kBlockPx)
    for (int u0 = 0; u0 < frame.color.width(); u0 += kBlockPx) {
      double grey = 0, depth_m = 0, count = 0;
      for (int v = v0; v < v0 + kBlockPx; ++v)
        for (int u = u0; u < u0 + kBlockPx; ++u) {
          const Rgb8 c = frame.color(u, v);
          grey += (c.r + c.g + c.b) / 3.0;
          const float z = frame.depth_m(u, v);
          if (std::isnan(z)) continue;
          depth_m += z;
          ++count;
        }
      means.push_back(grey / (kBlockPx * kBlockPx));
      means.push_back(1000 * depth_m / std::max(1.0, count));
      means.push_back(100 * count / (kBlockPx * kBlockPx));
    }
  return means;
}

struct FrozenView {
  std::uint64_t checksum;
  std::vector<double> block_means;  ///< Compared where the last digits of another processor change the checksum.
};

void expect_frozen(const SceneScript& script, const FrozenView& expected) {
  auto simulation = Simulation::create(script, 1);
  ASSERT_TRUE(simulation.ok()) << simulation.error().message;
  const RgbdFrame frame = simulation->render_view(0).frame;
  if (view_checksum(frame) == expected.checksum) return;
  const std::vector<double> means = block_means(frame);
  std::string row;
  for (const double mean : means) row += std::to_string(mean) + ", ";
  ASSERT_EQ(means.size(), expected.block_means.size());
  for (std::size_t i = 0; i < means.size(); ++i)
    EXPECT_NEAR(means[i], expected.block_means[i], kTolerance)
        << "block value " << i << "; checksum 0x" << std::hex << view_checksum(frame) << "ULL, means {" << row << "}";
}

TEST(FrozenBenchmark, Version2KeepsItsScripts) {
  EXPECT_EQ(script_checksum(make_dynamic_tabletop(1, {.version = 2})), 16301896283613035425ULL);
  EXPECT_EQ(script_checksum(make_dynamic_tabletop(2, {.version = 2})), 13241485200973923422ULL);
}

TEST(FrozenBenchmark, Version2KeepsItsFirstView) {
  expect_frozen(
      make_dynamic_tabletop(1, {.version = 2})[0],
      {0x4E6D91BA1B597628ULL,
       {210.2, 2734.9, 92.7,  177.9, 2547.3, 92.4,  211.0, 3474.6, 100.0, 185.7, 3676.1, 87.7,  164.6, 3507.6, 99.5,
        173.7, 3111.1, 100.0, 181.4, 2774.1, 100.0, 187.1, 2503.3, 100.0, 158.3, 890.2,  95.7,  197.8, 1020.2, 99.9,
        165.0, 3378.4, 99.0,  126.4, 2276.5, 75.2,  138.0, 2176.4, 93.7,  167.3, 3075.2, 98.8,  176.1, 2949.9, 99.5,
        179.8, 2562.3, 94.7,  170.5, 932.1,  99.6,  156.9, 1146.8, 91.2,  143.0, 1668.5, 91.0,  142.1, 1287.3, 91.9,
        137.7, 1216.1, 89.3,  150.7, 1413.8, 93.1,  162.6, 1930.2, 80.2,  156.2, 2116.8, 94.0,  92.5,  1005.5, 95.6,
        70.9,  979.9,  82.2,  111.0, 929.5,  79.5,  161.3, 1028.1, 92.4,  139.5, 1033.3, 97.2,  175.1, 1055.8, 97.5,
        180.1, 1083.8, 97.2,  156.7, 1837.4, 91.6,  141.1, 874.3,  97.0,  114.0, 804.0,  84.9,  117.2, 829.9,  93.1,
        159.0, 893.7,  99.7,  151.0, 881.4,  99.2,  152.9, 902.1,  99.0,  146.5, 1395.2, 84.2,  175.4, 1879.7, 97.7,
        131.8, 683.4,  89.2,  165.8, 678.5,  98.3,  159.7, 757.4,  99.4,  167.3, 768.0,  100.0, 161.6, 775.9,  99.3,
        173.0, 1304.0, 95.7,  167.9, 1607.6, 96.7,  189.0, 1629.0, 100.0}});
}

TEST(FrozenBenchmark, Version3KeepsItsScripts) {
  EXPECT_EQ(script_checksum(make_dynamic_tabletop(1)), 11516790093956767996ULL);
  EXPECT_EQ(script_checksum(make_dynamic_tabletop(2)), 10806112595597085899ULL);
}

TEST(FrozenBenchmark, Version3KeepsItsFirstView) {
  expect_frozen(
      make_dynamic_tabletop(1)[0],
      {0x21DE1E241CE8F0CEULL,
       {209.8, 2953.7, 97.6, 203.7, 3377.7, 97.8,  168.0, 3256.3, 66.8, 193.2, 3482.4, 65.3, 187.1, 2799.7, 82.1,
        214.6, 3303.2, 95.9, 216.8, 3087.0, 98.4,  216.0, 2875.5, 98.7, 203.5, 3085.5, 99.4, 149.4, 2654.1, 57.2,
        116.9, 1157.5, 94.9, 137.5, 2313.7, 70.1,  122.0, 1626.4, 77.5, 128.1, 1826.7, 65.8, 174.5, 2466.5, 84.5,
        193.5, 2872.8, 96.5, 150.6, 2839.3, 94.8,  136.8, 2593.9, 66.0, 77.4,  1212.9, 77.0, 112.0, 1397.6, 87.8,
        129.2, 1359.4, 90.2, 135.7, 1338.6, 88.3,  146.4, 1387.0, 89.7, 148.4, 2615.7, 95.3, 153.0, 2081.8, 83.1,
        132.4, 1229.3, 73.3, 127.2, 1098.3, 80.8,  146.8, 927.2,  85.1, 119.1, 1017.4, 88.9, 157.9, 1128.1, 100.0,
        112.9, 1574.8, 83.9, 147.8, 2197.3, 100.0, 135.0, 1226.9, 72.5, 137.8, 979.0,  96.1, 147.2, 937.4,  85.5,
        83.6,  751.0,  95.6, 129.4, 952.6,  95.3,  148.1, 991.5,  96.3, 94.8,  1810.9, 96.8, 132.5, 1860.4, 99.8,
        162.6, 1619.5, 86.8, 118.6, 1364.6, 70.6,  150.7, 922.4,  84.3, 121.9, 818.6,  99.4, 158.7, 829.9,  99.5,
        112.6, 1197.5, 91.8, 114.2, 1622.4, 99.9,  134.7, 1609.5, 99.9}});
}

}  // namespace
}  // namespace resight
