// SPDX-License-Identifier: Apache-2.0
// Each version of the benchmark stays what it was: results of a version compare only if its bytes do.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "resight/core/hash.hpp"
#include "resight/simulation/dynamic_tabletop.hpp"
#include "resight/simulation/simulation.hpp"

namespace resight {
namespace {

constexpr int kBlock_px = 80;
constexpr double kTolerance = 0.5;            // A few pixels per block.
constexpr double kRoughnessTolerance = 0.01;  // Relative: far less than a change of the noise.

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
  for (int v0 = 0; v0 < frame.color.height(); v0 += kBlock_px)
    for (int u0 = 0; u0 < frame.color.width(); u0 += kBlock_px) {
      double grey = 0, depth_m = 0, count = 0;
      for (int v = v0; v < v0 + kBlock_px; ++v)
        for (int u = u0; u < u0 + kBlock_px; ++u) {
          const Rgb8 c = frame.color(u, v);
          grey += (c.r + c.g + c.b) / 3.0;
          const float z = frame.depth_m(u, v);
          if (std::isnan(z)) continue;
          depth_m += z;
          ++count;
        }
      means.push_back(grey / (kBlock_px * kBlock_px));
      means.push_back(1000 * depth_m / std::max(1.0, count));
      means.push_back(100 * count / (kBlock_px * kBlock_px));
    }
  return means;
}

// Mean difference of neighbours in a row, in grey levels and mm, which the noise of the sensor raises.
std::vector<double> roughness(const RgbdFrame& frame) {
  double grey = 0, depth_mm = 0, num_depths = 0;
  for (int v = 0; v < frame.color.height(); ++v)
    for (int u = 1; u < frame.color.width(); ++u) {
      grey += std::abs(frame.color(u, v).g - frame.color(u - 1, v).g);
      const double step_mm = 1000 * std::abs(frame.depth_m(u, v) - frame.depth_m(u - 1, v));
      if (std::isnan(step_mm) || step_mm > 20) continue;
      depth_mm += step_mm;
      ++num_depths;
    }
  return {grey / static_cast<double>(frame.color.size()), depth_mm / std::max(1.0, num_depths)};
}

struct FrozenView {
  std::vector<std::uint64_t> checksums;  // On the processors seen so far.
  // Compared where the last digits of another processor change the checksum.
  std::vector<double> roughness;
  std::vector<double> block_means;
};

std::string list(const std::vector<double>& values) {
  std::string row;
  for (const double value : values) row += std::to_string(value) + ", ";
  return row;
}

// Returns whether the bytes are the same.
bool expect_frozen(const SceneScript& script, const FrozenView& expected) {
  auto simulation = Simulation::create(script, 1);
  if (!simulation.ok()) throw std::runtime_error(simulation.error().message);
  const RgbdFrame frame = simulation->render_view(0).frame;
  const std::vector<double> means = block_means(frame), rough = roughness(frame);
  SCOPED_TRACE(testing::Message() << "checksum 0x" << std::hex << view_checksum(frame) << "ULL, roughness {"
                                  << list(rough) << "}, means {" << list(means) << "}");
  EXPECT_EQ(means.size(), expected.block_means.size());
  for (std::size_t i = 0; i < std::min(means.size(), expected.block_means.size()); ++i)
    EXPECT_NEAR(means[i], expected.block_means[i], kTolerance) << "block value " << i;
  for (std::size_t i = 0; i < rough.size(); ++i)
    EXPECT_NEAR(rough[i] / expected.roughness[i], 1, kRoughnessTolerance) << "roughness " << i;
  return std::ranges::find(expected.checksums, view_checksum(frame)) != expected.checksums.end();
}

TEST(FrozenBenchmark, Version2KeepsItsScripts) {
  EXPECT_EQ(script_checksum(make_dynamic_tabletop(1, DynamicTabletopOptions::of_version(2))), 16301896283613035425ULL);
  EXPECT_EQ(script_checksum(make_dynamic_tabletop(2, DynamicTabletopOptions::of_version(2))), 13241485200973923422ULL);
}

TEST(FrozenBenchmark, Version3KeepsItsScripts) {
  EXPECT_EQ(script_checksum(make_dynamic_tabletop(1)), 13699625859473742019ULL);
  EXPECT_EQ(script_checksum(make_dynamic_tabletop(2)), 7130631730552055317ULL);
}

// On another processor the last digits may differ, and with them both checksums.
TEST(FrozenBenchmark, FirstViewsKeepTheirBytes) {
  const FrozenView version_2{
      {0x369D1BE66A339009ULL, 0x4E6D91BA1B597628ULL},
      {8.5204, 3.1925},
      {210.2, 2734.9, 92.7,  177.9, 2547.3, 92.4,  211.0, 3474.6, 100.0, 185.7, 3676.1, 87.7,  164.6, 3507.6, 99.5,
       173.7, 3111.1, 100.0, 181.4, 2774.1, 100.0, 187.1, 2503.3, 100.0, 158.3, 890.2,  95.7,  197.8, 1020.2, 99.9,
       165.0, 3378.4, 99.0,  126.4, 2276.5, 75.2,  138.0, 2176.4, 93.7,  167.3, 3075.2, 98.8,  176.1, 2949.9, 99.5,
       179.8, 2562.3, 94.7,  170.5, 932.1,  99.6,  156.9, 1146.8, 91.2,  143.0, 1668.5, 91.0,  142.1, 1287.3, 91.9,
       137.7, 1216.1, 89.3,  150.7, 1413.8, 93.1,  162.6, 1930.2, 80.2,  156.2, 2116.8, 94.0,  92.5,  1005.5, 95.6,
       70.9,  979.9,  82.2,  111.0, 929.5,  79.5,  161.3, 1028.1, 92.4,  139.5, 1033.3, 97.2,  175.1, 1055.8, 97.5,
       180.1, 1083.8, 97.2,  156.7, 1837.4, 91.6,  141.1, 874.3,  97.0,  114.0, 804.0,  84.9,  117.2, 829.9,  93.1,
       159.0, 893.7,  99.7,  151.0, 881.4,  99.2,  152.9, 902.1,  99.0,  146.5, 1395.2, 84.2,  175.4, 1879.7, 97.7,
       131.8, 683.4,  89.2,  165.8, 678.5,  98.3,  159.7, 757.4,  99.4,  167.3, 768.0,  100.0, 161.6, 775.9,  99.3,
       173.0, 1304.0, 95.7,  167.9, 1607.6, 96.7,  189.0, 1629.0, 100.0}};
  const FrozenView version_3{
      {0x512601F99770B94AULL},
      {3.7390, 1.1410},
      {113.1, 2516.2, 62.5,  175.3, 2788.2, 88.6, 188.5, 2971.4, 92.0, 207.8, 3525.2, 99.0, 203.3, 3821.8, 92.4,
       215.6, 3475.4, 98.4,  221.4, 3003.8, 98.4, 224.3, 2645.7, 98.7, 112.1, 968.6,  96.6, 126.8, 1076.4, 99.5,
       148.7, 1747.3, 93.2,  201.3, 3738.3, 97.2, 165.7, 2118.0, 64.4, 211.4, 3610.7, 98.4, 216.8, 3115.0, 100.0,
       220.2, 2727.4, 99.9,  106.9, 1108.5, 82.2, 90.6,  1233.5, 73.6, 129.4, 1904.3, 78.0, 138.2, 2170.7, 79.7,
       100.3, 1223.2, 66.5,  124.0, 1495.9, 69.7, 179.5, 2720.0, 85.9, 213.1, 2808.3, 98.9, 130.8, 1019.1, 82.3,
       99.1,  940.7,  84.3,  134.6, 1029.6, 90.5, 140.5, 1044.6, 90.9, 133.4, 1024.0, 82.6, 161.8, 1080.7, 92.8,
       143.6, 1088.1, 84.7,  144.1, 1355.2, 87.3, 104.9, 714.3,  85.1, 84.7,  733.2,  92.2, 156.1, 835.2,  100.0,
       164.6, 842.9,  100.0, 141.6, 841.7,  97.3, 115.6, 966.9,  92.1, 118.2, 1551.5, 93.3, 103.6, 1695.3, 73.1,
       129.3, 674.8,  98.3,  148.3, 679.4,  99.9, 164.6, 686.7,  99.8, 138.5, 771.3,  97.1, 93.0,  1227.5, 93.6,
       74.1,  1647.8, 97.0,  95.1,  1678.1, 96.0, 106.4, 1579.4, 86.8}};
  const bool same_2 = expect_frozen(make_dynamic_tabletop(1, DynamicTabletopOptions::of_version(2))[0], version_2);
  const bool same_3 = expect_frozen(make_dynamic_tabletop(1)[0], version_3);
  EXPECT_EQ(same_2, same_3) << "the bytes of one version have changed";
}

}  // namespace
}  // namespace resight
