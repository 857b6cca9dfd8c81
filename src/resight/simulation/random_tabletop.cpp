// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numbers>

#include "resight/core/check.hpp"
#include "resight/core/random.hpp"
#include "resight/simulation/internal/footprint.hpp"
#include "resight/simulation/presets.hpp"
#include "resight/simulation/procedural_objects.hpp"
#include "resight/simulation/room.hpp"

namespace resight {
namespace {

constexpr int kPlaceAttempts = 300;
constexpr double kMinMove_m = 0.12;
const Eigen::Vector2d kHalfArea(0.56, 0.33);  // Part of the table top that the cameras observe.

// The circle around the centre of the bounding box of an object seen from above, laid down or upright.
struct Disc {
  Eigen::Vector2d center = Eigen::Vector2d::Zero();  // From the origin of the object, before its yaw.
  double radius_m = 0;
};

Disc disc_of(const TriangleMesh& mesh, double roll_rad) {
  const Eigen::Matrix3f r = Rigid3::from_axis_angle(Eigen::Vector3d::UnitX(), roll_rad).rotation.cast<float>();
  const Eigen::Vector2d center = footprint_of(mesh, roll_rad).center;
  float radius_sq = 0;
  for (const auto& v : mesh.vertices)
    radius_sq = std::max(radius_sq, ((r * v).head<2>() - center.cast<float>()).squaredNorm());
  return {center, std::sqrt(static_cast<double>(radius_sq))};
}

struct TabletopObject {
  std::string key;
  std::string model;
  bool known = true;
  double roll_rad = 0;
  Disc disc;
  bool present = false;
  Eigen::Vector2d position = Eigen::Vector2d::Zero();  // Centre of the disc, table frame.
};

class TabletopBuilder {
 public:
  TabletopBuilder(std::uint64_t seed, const RandomTabletopOptions& options) : rng_(seed), options_(options) {}

  SceneScript build() {
    build_room();
    const int num_added = count_additions();
    choose_things(options_.models.empty() ? procedural_object_names() : options_.models, options_.num_known + num_added,
                  true);
    choose_things(distractor_names(), options_.num_distractors, false);
    place_at_start(num_added);
    for (int i = 0; i < options_.num_changes; ++i) {
      const int view = std::clamp((i + 1) * options_.num_views / (options_.num_changes + 1), 1, options_.num_views - 1);
      add_change(view, i % 3);
    }
    build_camera();
    return std::move(script_);
  }

 private:
  void build_room() {
    script_.name = "tabletop";
    const double width = rng_.uniform(4.4, 5.2);
    const double depth = rng_.uniform(4.4, 5.2);
    script_.room_size_m = Eigen::Vector3d(width, depth, 2.6);
    script_.furniture.push_back({"table", "table", {1.4, 0.9, 0.74}, {}});
    Placement shelf;
    shelf.x_m = rng_.uniform(-1.0, 1.0);
    shelf.y_m = 0.5 * depth - 0.2;
    script_.furniture.push_back({"shelf", "shelf", {1.1, 0.3, 1.7}, shelf});
    script_.lighting.lamp_in_world_m.x() = rng_.uniform(-1.5, 1.5);
    script_.lighting.lamp_in_world_m.y() = rng_.uniform(-1.5, 1.5);
  }

  // Every third change is an addition: index 2, 5, ...
  [[nodiscard]] int count_additions() const { return options_.num_changes / 3; }

  void choose_things(std::vector<std::string> names, int count, bool known) {
    rng_.shuffle(names);
    for (int i = 0; i < count; ++i) {
      const std::string& model = names[i % names.size()];
      const int copy = i / static_cast<int>(names.size());
      auto object = known ? make_procedural_object(model) : make_distractor(model);
      require(object.ok(), "RandomTabletopOptions.models: " + (object.ok() ? "" : object.error().message));
      TabletopObject thing{copy == 0 ? model : model + "_" + std::to_string(copy + 1), model, known, 0, {}, false, {}};
      if (options_.lay_down && known && rng_.uniform() < 1.0 / 3) thing.roll_rad = std::numbers::pi / 2;
      thing.disc = disc_of(object->mesh, thing.roll_rad);
      things_.push_back(std::move(thing));
    }
  }

  // The last `num_added` known objects are added later.
  void place_at_start(int num_added) {
    std::vector<TabletopObject> kept;
    int index = 0;
    for (TabletopObject& thing : things_) {
      const bool waits = thing.known && index >= options_.num_known && index < options_.num_known + num_added;
      ++index;
      ObjectScript object{thing.key, thing.model, {}, thing.known, std::nullopt};
      if (!waits) {
        object.start = find_place(thing, false);
        if (!object.start) continue;  // the table is full
        thing.present = true;
      }
      script_.objects.push_back(std::move(object));
      kept.push_back(thing);
    }
    things_ = std::move(kept);
  }

  void add_change(int view, int kind) {
    std::vector<TabletopObject*> candidates;
    for (TabletopObject& thing : things_)
      if (thing.known && thing.present == (kind != 2)) candidates.push_back(&thing);
    if (candidates.empty()) return;
    TabletopObject& thing = *candidates[rng_.below(static_cast<std::uint32_t>(candidates.size()))];
    if (kind == 1) {
      thing.present = false;
      script_.changes.push_back({view, ChangeKind::kRemoved, thing.key, {}});
      return;
    }
    const auto place = find_place(thing, kind == 0);
    if (!place) return;
    thing.present = true;
    script_.changes.push_back({view, kind == 0 ? ChangeKind::kMoved : ChangeKind::kAdded, thing.key, *place});
  }

  // Finds a free place and updates the object; nullopt if there is none.
  std::optional<Placement> find_place(TabletopObject& thing, bool away_from_old) {
    for (int attempt = 0; attempt < kPlaceAttempts; ++attempt) {
      const double r = thing.disc.radius_m;
      const double x = rng_.uniform(-1, 1) * std::max(0.0, kHalfArea.x() - 0.5 * r);
      const double y = rng_.uniform(-1, 1) * std::max(0.0, kHalfArea.y() - 0.5 * r);
      const Eigen::Vector2d position(x, y);
      const bool free = std::ranges::all_of(things_, [&](const TabletopObject& other) {
        const double reach = r + other.disc.radius_m + options_.gap_m;
        return &other == &thing || !other.present || (other.position - position).norm() >= reach;
      });
      if (!free || (away_from_old && (thing.position - position).norm() < kMinMove_m)) continue;
      thing.position = position;
      Placement p;
      p.support = "table";
      p.yaw_rad = rng_.uniform(-std::numbers::pi, std::numbers::pi);
      p.roll_rad = thing.roll_rad;
      const Eigen::Vector2d origin = position - Eigen::Rotation2Dd(p.yaw_rad) * thing.disc.center;
      p.x_m = origin.x();
      p.y_m = origin.y();
      return p;
    }
    return std::nullopt;
  }

  void build_camera() {
    OrbitScript orbit;
    orbit.num_views = options_.num_views;
    orbit.center_m = {0, 0, 0.80};
    const double middle_rad = -std::numbers::pi / 2 + rng_.uniform(-0.3, 0.3);
    const double half_arc_rad = 0.5 * options_.arc_deg * std::numbers::pi / 180;
    orbit.start_rad = middle_rad - half_arc_rad;
    orbit.end_rad = middle_rad + half_arc_rad;
    const auto set = [&](double& radius, double& height) {
      const double distance = rng_.uniform(options_.min_distance_m, options_.max_distance_m);
      const double elevation = rng_.uniform(25, 40) * std::numbers::pi / 180;
      radius = distance * std::cos(elevation);
      height = distance * std::sin(elevation);
    };
    double end_radius = 0;
    double end_height = 0;
    set(orbit.radius_m, orbit.height_m);
    set(end_radius, end_height);
    orbit.end_radius_m = end_radius;
    orbit.end_height_m = end_height;
    script_.world_from_camera = make_orbit(orbit);
  }

  Rng rng_;
  const RandomTabletopOptions& options_;
  SceneScript script_;
  std::vector<TabletopObject> things_;
};

}  // namespace

void RandomTabletopOptions::check() const {
  check_in_range("RandomTabletopOptions.num_known", num_known, 1, 100);
  check_in_range("RandomTabletopOptions.num_distractors", num_distractors, 0, 100);
  check_in_range("RandomTabletopOptions.num_views", num_views, 2, 100000);
  check_in_range("RandomTabletopOptions.num_changes", num_changes, 0, 1000);
  check_positive("RandomTabletopOptions.min_distance_m", min_distance_m);
  require(max_distance_m >= min_distance_m,
          "RandomTabletopOptions.max_distance_m must not be less than min_distance_m");
  check_in_range("RandomTabletopOptions.arc_deg", arc_deg, 0, 360);
  check_not_negative("RandomTabletopOptions.gap_m", gap_m);
}

SceneScript make_random_tabletop(std::uint64_t seed, const RandomTabletopOptions& options) {
  options.check();
  return TabletopBuilder(seed, options).build();
}

}  // namespace resight
