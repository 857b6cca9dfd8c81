// SPDX-License-Identifier: Apache-2.0
#include "resight/simulation/presets.hpp"

#include <array>
#include <cmath>
#include <numbers>

#include "resight/core/random.hpp"
#include "resight/geometry/angle.hpp"
#include "resight/simulation/realistic_recording.hpp"

namespace resight {
namespace {

struct DemoPlace {
  const char* model;
  double x_m, y_m, yaw_deg;
};

// The desk from left to right. The gaps leave room for the shifts by the seed.
constexpr std::array<DemoPlace, 10> kDemoKnown{{{"cereal_red", -0.42, 0.16, 25},
                                                {"novel", -0.45, -0.16, 35},
                                                {"soup_tomato", -0.22, 0.06, 10},
                                                {"mug", -0.07, -0.13, 200},
                                                {"soup_pea", 0.06, 0.05, -20},
                                                {"milk_carton", 0.23, 0.20, -15},
                                                {"toy_car", 0.25, -0.18, 165},
                                                {"coffee_tin", 0.45, 0.02, 15},
                                                {"plain_can", 0.43, -0.18, 0},
                                                {"brick", -0.22, -0.31, 5}}};
constexpr std::array<DemoPlace, 3> kDemoUnknown{
    {{"plant", -0.60, -0.02, 0}, {"speaker", 0.46, 0.24, -20}, {"thermos", -0.08, 0.17, 40}}};
constexpr double kShift_m = 0.012;
constexpr double kTurn_deg = 8;

Placement on_desk(double x_m, double y_m, double yaw_deg) {
  Placement p;
  p.support = "desk";
  p.x_m = x_m;
  p.y_m = y_m;
  p.yaw_rad = radians(yaw_deg);
  return p;
}

void add_furniture(SceneScript& script, const std::string& key, const std::string& kind, const Eigen::Vector3d& size_m,
                   const Placement& placement) {
  script.furniture.push_back({key, kind, size_m, placement});
}

Placement on_floor(double x_m, double y_m, double yaw_deg) {
  Placement p = on_desk(x_m, y_m, yaw_deg);
  p.support.clear();
  return p;
}

SceneScript make_office() {
  SceneScript script;
  script.room_size_m = Eigen::Vector3d(4.6, 4.6, 2.6);
  add_furniture(script, "desk", "table", {1.5, 0.85, 0.74}, on_floor(0, 0, 0));
  add_furniture(script, "shelf", "shelf", {1.0, 0.3, 1.7}, on_floor(-0.6, 2.1, 0));
  add_furniture(script, "cabinet", "cabinet", {0.6, 0.45, 0.9}, on_floor(1.0, 2.0, 0));
  return script;
}

const std::vector<std::string>& plain_models() {
  static const std::vector<std::string> models{"plain_mug", "bowl", "plain_can", "paper_roll", "brick", "plain_box"};
  return models;
}

}  // namespace

SceneScript make_sparse_views(std::uint64_t seed) {
  constexpr double kStep_m = 0.3;
  constexpr double kStep_deg = 15;
  RandomTabletopOptions options;
  options.num_distractors = 0;
  options.num_changes = 0;
  if (seed % 2 == 1) {
    options.models = plain_models();
    options.num_known = 3;
  }
  SceneScript script = make_random_tabletop(seed, options);
  script.name = "sparse-views";
  Rng rng(seed);
  script.sensor = draw_sensor(rng);
  script.color_lens = draw_lens(rng);
  script.lighting = draw_lighting(rng);
  OrbitScript orbit;
  orbit.radius_m = 0.5 * kStep_m / std::sin(radians(0.5 * kStep_deg));
  orbit.height_m = rng.uniform(0.5, 0.7);
  orbit.num_views = static_cast<int>(360 / kStep_deg);
  orbit.start_rad = rng.uniform(0, 2 * std::numbers::pi);
  orbit.end_rad = orbit.start_rad + radians(360 - kStep_deg);
  script.world_from_camera = make_orbit(orbit);
  return script;
}

SceneScript make_demo_scene(std::uint64_t seed) {
  Rng rng(seed);
  const auto shifted = [&rng](const DemoPlace& spot) {
    const double x = spot.x_m + rng.uniform(-kShift_m, kShift_m);
    const double y = spot.y_m + rng.uniform(-kShift_m, kShift_m);
    return on_desk(x, y, spot.yaw_deg + rng.uniform(-kTurn_deg, kTurn_deg));
  };
  SceneScript script = make_office();
  script.name = "demo";
  add_furniture(script, "monitor", "monitor", {0.46, 0.18, 0.36}, on_desk(0.02, 0.32, 0));
  add_furniture(script, "keyboard", "keyboard", {0.34, 0.12, 0.02}, on_desk(0.06, -0.33, 0));
  for (const DemoPlace& spot : kDemoKnown) script.objects.push_back({spot.model, spot.model, {}, true, shifted(spot)});
  for (const DemoPlace& spot : kDemoUnknown)
    script.objects.push_back({spot.model, spot.model, {}, false, shifted(spot)});
  script.objects.push_back({"tea_box", "tea_box", {}, true, std::nullopt});
  script.changes = {{3, ChangeKind::kMoved, "toy_car", shifted({"", 0.24, 0.03, 100})},
                    {5, ChangeKind::kAdded, "tea_box", shifted({"", 0.08, -0.15, 15})},
                    {6, ChangeKind::kRemoved, "soup_tomato", {}},
                    {8, ChangeKind::kMoved, "mug", shifted({"", -0.25, -0.12, 190})},
                    {10, ChangeKind::kRemoved, "tea_box", {}}};
  OrbitScript orbit;
  orbit.center_m = {0, 0, 0.80};
  orbit.radius_m = 1.08;
  orbit.height_m = 0.52;
  orbit.end_radius_m = 0.93;
  orbit.end_height_m = 0.42;
  script.world_from_camera = make_orbit(orbit);
  return script;
}

const std::vector<std::string>& preset_scene_names() {
  static const std::vector<std::string> names{"demo", "tabletop", "crowded", "twins", "plain", "sparse-views"};
  return names;
}

Result<SceneScript> make_preset_scene(std::string_view name, std::uint64_t seed) {
  RandomTabletopOptions options;
  if (name == "demo") return make_demo_scene(seed);
  if (name == "sparse-views") return make_sparse_views(seed);
  if (name == "crowded") {
    options.num_known = 14;
    options.gap_m = 0.002;
  } else if (name == "twins") {
    options.models = {"cereal_red", "cereal_blue", "soup_tomato", "soup_pea"};
  } else if (name == "plain") {
    options.models = plain_models();
    options.num_known = 6;
  } else if (name != "tabletop") {
    std::string known;
    for (const std::string& n : preset_scene_names()) known += (known.empty() ? "" : ", ") + n;
    return Error{"no preset scene '" + std::string(name) + "' (known: " + known + ")"};
  }
  SceneScript script = make_random_tabletop(seed, options);
  script.name = name;
  return script;
}

}  // namespace resight
