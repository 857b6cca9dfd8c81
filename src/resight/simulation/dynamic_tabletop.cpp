// SPDX-License-Identifier: Apache-2.0
#include "resight/simulation/dynamic_tabletop.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <map>
#include <numbers>
#include <optional>
#include <set>

#include "resight/core/check.hpp"
#include "resight/core/random.hpp"
#include "resight/geometry/angle.hpp"
#include "resight/rendering/view_renderer.hpp"
#include "resight/simulation/internal/footprint.hpp"
#include "resight/simulation/internal/tabletop_stage.hpp"
#include "resight/simulation/procedural_objects.hpp"
#include "resight/simulation/realistic_recording.hpp"
#include "resight/simulation/room.hpp"
#include "resight/simulation/seeded_objects.hpp"

namespace resight {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr int kAttempts = 400;
constexpr double kLeastMove_m = 0.10;
constexpr double kNearMove_m = 0.30;
constexpr std::uint64_t kRealismStream = 1000;  // of what version 3 adds to the layout
// Unknown objects that resemble known ones.
constexpr std::array kLookAlikes{"cereal_blue", "plain_mug", "puzzle_box"};

struct SequencePlan {
  TabletopTheme theme;
  int num_views;
};
constexpr std::array<SequencePlan, 9> kPlan{{{TabletopTheme::kDesk, 23},
                                             {TabletopTheme::kMeeting, 22},
                                             {TabletopTheme::kCorner, 23},
                                             {TabletopTheme::kDesk, 22},
                                             {TabletopTheme::kShelf, 23},
                                             {TabletopTheme::kMeeting, 23},
                                             {TabletopTheme::kCorner, 22},
                                             {TabletopTheme::kDesk, 23},
                                             {TabletopTheme::kMeeting, 22}}};

// The models of a seed and their footprints, upright and laid down. Computed once, because drawing a model is slow.
class Catalogue {
 public:
  Catalogue(std::uint64_t seed, int version) : known_(dynamic_tabletop_library(seed, version)) {
    if (version == 2) {
      unknown_ = distractor_names();
      unknown_.insert(unknown_.end(), kLookAlikes.begin(), kLookAlikes.end());
    } else {
      object_seed_ = seed;
      unknown_ = seeded_object_names(seed).unknown;
    }
    for (const auto* names : {&known_, &unknown_})
      for (const std::string& name : *names) add(*make_script_object(object_seed_, name));
  }
  [[nodiscard]] const Footprint& footprint(const std::string& model, bool lying) const {
    return footprints_.at(model)[lying ? 1 : 0];
  }
  [[nodiscard]] const std::vector<std::string>& known() const { return known_; }
  [[nodiscard]] const std::vector<std::string>& unknown() const { return unknown_; }
  [[nodiscard]] const std::optional<std::uint64_t>& object_seed() const { return object_seed_; }
  /// Whether the model belongs to the pair of twins that stands side by side in every other scene.
  [[nodiscard]] bool is_twin(const std::string& model) const {
    return object_seed_ ? twins_.contains(model) : model.starts_with("soup");
  }

 private:
  void add(const ProceduralObject& object) {
    footprints_[object.name] = {footprint_of(object.mesh, 0), footprint_of(object.mesh, std::numbers::pi / 2)};
    // The twin follows the object that it resembles.
    if (object.kind == "twin") twins_ = {object.name, *std::prev(std::ranges::find(known_, object.name))};
  }
  std::vector<std::string> known_, unknown_;
  std::optional<std::uint64_t> object_seed_;
  std::map<std::string, std::array<Footprint, 2>> footprints_;
  std::set<std::string> twins_;
};

// Position of an object in the frame of the surface.
struct Spot {
  int surface = 0;
  Footprint covered;
};

struct Thing {
  std::string key;
  std::string model;
  bool known = true;
  bool lying = false;
  std::optional<Spot> spot;       // Absent if the object is not in the scene.
  std::optional<Spot> last_spot;  // The spot before the removal.
};

class SequenceBuilder {
 public:
  SequenceBuilder(const Catalogue& catalogue, std::uint64_t seed, int index, const DynamicTabletopOptions& options)
      : catalogue_(catalogue),
        rng_(Rng::stream(seed, static_cast<std::uint64_t>(index))),
        realism_rng_(Rng::stream(seed, kRealismStream + static_cast<std::uint64_t>(index))),
        index_(index),
        options_(options) {}

  SceneScript build() {
    script_.name = "dynamic_" + std::to_string(index_ + 1);
    script_.sensor.lateral_noise = options_.depth_noise;
    script_.sensor.axial_noise = options_.depth_noise;
    script_.sensor.color_noise = options_.color_noise;
    stage_ = furnish_tabletop(kPlan[static_cast<std::size_t>(index_)].theme, rng_, script_);
    choose_things();
    for (Thing& thing : things_)
      if (&thing - things_.data() < num_starting_) thing.spot = find_spot(thing, {});
    list_objects();
    add_changes();
    move_camera();
    script_.object_seed = catalogue_.object_seed();
    if (options_.version >= 3) add_realism();
    return std::move(script_);
  }

 private:
  void add_realism() {
    script_.sensor = draw_sensor(realism_rng_);
    script_.color_lens = draw_lens(realism_rng_);
    script_.lighting = draw_lighting(realism_rng_);
    script_.reported_world_from_camera = drift_poses(script_.world_from_camera, draw_drift(realism_rng_));
    for (FurnitureScript& f : script_.furniture) {
      const double specular = realism_rng_.uniform(0.02, 0.25);  // varnish and plastic
      f.material = {.specular = specular, .shininess = realism_rng_.uniform(10, 60)};
    }
  }

  // ---- things ----

  void choose_things() {
    std::vector<std::string> known = catalogue_.known();
    rng_.shuffle(known);
    if (index_ % 2 == 0)  // twins side by side
      std::stable_partition(known.begin(), known.end(),
                            [&](const std::string& name) { return catalogue_.is_twin(name); });
    std::vector<std::string> unknown = catalogue_.unknown();
    rng_.shuffle(unknown);
    known.insert(known.begin(), {known[0], known[2]});  // two objects of each of these kinds
    for (int i = 0; i < options_.num_known; ++i) add_thing(known, i, true);
    for (int i = 0; i < options_.num_unknown; ++i) add_thing(unknown, i, false);
    num_starting_ = options_.num_known + options_.num_unknown;
    for (int i = 0; i < options_.num_waiting; ++i) add_thing(known, options_.num_known + i, true);
  }

  void add_thing(const std::vector<std::string>& models, int i, bool known) {
    const std::string& model = models[static_cast<std::size_t>(i) % models.size()];
    const auto copies = std::ranges::count(things_, model, &Thing::model);
    things_.push_back({copies == 0 ? model : model + "_" + std::to_string(copies + 1), model, known,
                       rng_.uniform() < options_.lying_share, std::nullopt, std::nullopt});
  }

  [[nodiscard]] bool is_free(const Thing& thing, const Spot& spot) const {
    const TabletopSurface& surface = stage_.surfaces[static_cast<std::size_t>(spot.surface)];
    const auto collides = [&](const Footprint& other) { return overlaps(spot.covered, other, options_.gap_m); };
    return lies_within(spot.covered, surface.half_area) && std::ranges::none_of(surface.obstacles, collides) &&
           std::ranges::none_of(things_, [&](const Thing& other) {
             return &other != &thing && other.spot && other.spot->surface == spot.surface &&
                    collides(other.spot->covered);
           });
  }

  // Draws a spot on a surface, close to `wanted` if that is given.
  Spot draw_spot(const Thing& thing, const std::optional<Spot>& wanted, double max_offset_m) {
    Spot spot;
    spot.covered = catalogue_.footprint(thing.model, thing.lying);
    spot.covered.yaw_rad = rng_.uniform(-std::numbers::pi, std::numbers::pi);
    if (wanted) {
      const double angle = rng_.uniform(-std::numbers::pi, std::numbers::pi);
      spot.surface = wanted->surface;
      spot.covered.center = wanted->covered.center +
                            max_offset_m * std::sqrt(rng_.uniform()) * Vector2d(std::cos(angle), std::sin(angle));
      return spot;
    }
    spot.surface = draw_surface();
    const TabletopSurface& surface = stage_.surfaces[static_cast<std::size_t>(spot.surface)];
    spot.covered.center = {rng_.uniform(-1, 1) * surface.half_area.x(), rng_.uniform(-1, 1) * surface.half_area.y()};
    return spot;
  }

  int draw_surface() {
    double total = 0;
    for (const TabletopSurface& s : stage_.surfaces) total += s.half_area.prod();
    double left = rng_.uniform() * total;
    for (std::size_t i = 0; i + 1 < stage_.surfaces.size(); ++i) {
      left -= stage_.surfaces[i].half_area.prod();
      if (left < 0) return static_cast<int>(i);
    }
    return static_cast<int>(stage_.surfaces.size()) - 1;
  }

  // Draws an object in the scene to put another one beside.
  std::optional<Spot> draw_neighbor(const Thing& thing, double& max_offset_m) {
    std::vector<const Thing*> present;
    for (const Thing& other : things_)
      if (&other != &thing && other.spot) present.push_back(&other);
    if (present.empty()) return std::nullopt;
    const Spot& spot = *present[rng_.below(static_cast<std::uint32_t>(present.size()))]->spot;
    max_offset_m = spot.covered.radius_m() + catalogue_.footprint(thing.model, thing.lying).radius_m() + 0.02;
    return spot;
  }

  struct SpotWish {
    std::optional<Spot> near;  ///< Within max_offset_m of this spot.
    double max_offset_m = 0;
    std::optional<Spot> away_from;  ///< At least kLeastMove_m from this spot.
  };

  std::optional<Spot> find_spot(const Thing& thing, const SpotWish& wish) {
    for (int attempt = 0; attempt < kAttempts; ++attempt) {
      std::optional<Spot> near = wish.near;
      double max_offset_m = wish.max_offset_m;
      if (!near && rng_.uniform() < options_.crowding) near = draw_neighbor(thing, max_offset_m);
      const Spot spot = draw_spot(thing, near, max_offset_m);
      if (wish.away_from && wish.away_from->surface == spot.surface &&
          (wish.away_from->covered.center - spot.covered.center).norm() < kLeastMove_m)
        continue;
      if (is_free(thing, spot)) return spot;
    }
    return std::nullopt;
  }

  [[nodiscard]] Placement placement_of(const Thing& thing, const Spot& spot) const {
    const TabletopSurface& surface = stage_.surfaces[static_cast<std::size_t>(spot.surface)];
    Placement p;
    p.support = surface.support;
    p.level = surface.level;
    p.yaw_rad = spot.covered.yaw_rad;
    p.roll_rad = thing.lying ? std::numbers::pi / 2 : 0;
    // The centre of the footprint is not the origin of the object.
    const Vector2d own_center = catalogue_.footprint(thing.model, thing.lying).center;
    const Vector2d origin = spot.covered.center - Eigen::Rotation2Dd(p.yaw_rad) * own_center;
    p.x_m = origin.x();
    p.y_m = origin.y();
    return p;
  }

  // Lists all known objects, so that every sequence has the same library.
  void list_objects() {
    for (const Thing& thing : things_)
      script_.objects.push_back({thing.key,
                                 thing.model,
                                 {},
                                 thing.known,
                                 thing.spot ? std::optional(placement_of(thing, *thing.spot)) : std::nullopt});
    for (const std::string& model : catalogue_.known())
      if (std::ranges::none_of(things_, [&](const Thing& thing) { return thing.key == model; }))
        script_.objects.push_back({model, model, {}, true, std::nullopt});
  }

  // ---- changes ----

  void add_changes() {
    const int num_views = kPlan[static_cast<std::size_t>(index_)].num_views;
    std::vector<int> views;
    for (int i = 0; i < options_.num_changes; ++i)
      views.push_back(2 + static_cast<int>(rng_.below(static_cast<std::uint32_t>(num_views - 3))));
    std::ranges::sort(views);
    for (const int view : views) {
      const double kind = rng_.uniform();
      if (kind < 0.5) {
        move_thing(view);
      } else if (kind < 0.78) {
        remove_thing(view);
      } else {
        add_some_thing(view);
      }
    }
  }

  // Draws an object that is present (or absent) and was last changed before `view`.
  Thing* draw_thing(int view, bool present) {
    const bool known = rng_.uniform() >= options_.unknown_share;
    std::vector<Thing*> candidates;
    for (Thing& thing : things_) {
      const bool changed_now = std::ranges::any_of(
          script_.changes, [&](const ChangeScript& c) { return c.view == view && c.object == thing.key; });
      if (thing.spot.has_value() == present && (thing.known == known || !present) && !changed_now)
        candidates.push_back(&thing);
    }
    if (candidates.empty()) return nullptr;
    return candidates[rng_.below(static_cast<std::uint32_t>(candidates.size()))];
  }

  void put(int view, ChangeKind kind, Thing& thing, const Spot& spot) {
    thing.spot = spot;
    script_.changes.push_back({view, kind, thing.key, placement_of(thing, spot)});
  }

  void move_thing(int view) {
    Thing* thing = draw_thing(view, true);
    if (thing == nullptr) return;
    const Spot old = *thing->spot;
    const bool nearby = rng_.uniform() < 0.5;
    const auto spot = find_spot(*thing, {nearby ? std::optional(old) : std::nullopt, kNearMove_m, old});
    if (!spot) return;
    put(view, ChangeKind::kMoved, *thing, *spot);
    maybe_replace(view, old);
  }

  void remove_thing(int view) {
    Thing* thing = draw_thing(view, true);
    if (thing == nullptr) return;
    const Spot old = *thing->spot;
    thing->last_spot = old;
    thing->spot.reset();
    script_.changes.push_back({view, ChangeKind::kRemoved, thing->key, {}});
    maybe_replace(view, old);
  }

  // Sometimes puts another object at the spot that one has just left.
  void maybe_replace(int view, const Spot& old) {
    if (rng_.uniform() >= 0.25) return;
    Thing* other = draw_thing(view, false);
    if (other == nullptr) return;
    if (const auto spot = find_spot(*other, {old, 0.04, {}})) put(view, ChangeKind::kAdded, *other, *spot);
  }

  void add_some_thing(int view) {
    Thing* thing = draw_thing(view, false);
    if (thing == nullptr) return;
    const bool puts_back = rng_.uniform() < 0.4 && thing->last_spot && is_free(*thing, *thing->last_spot);
    const auto spot = puts_back ? thing->last_spot : find_spot(*thing, {});
    if (spot) put(view, ChangeKind::kAdded, *thing, *spot);
  }

  // ---- camera ----

  // Moves the camera to and fro around the scene with varying distance, looking left and right of its middle.
  void move_camera() {
    const int num_views = kPlan[static_cast<std::size_t>(index_)].num_views;
    const double middle_rad = -std::numbers::pi / 2 + rng_.uniform(-0.15, 0.15);
    const double phase_distance = rng_.uniform(0, 2 * std::numbers::pi);
    const double phase_height = rng_.uniform(0, 2 * std::numbers::pi);
    const double phase_pan = rng_.uniform(0, 2 * std::numbers::pi);
    const double side = rng_.uniform() < 0.5 ? -1 : 1;
    for (int view = 0; view < num_views; ++view) {
      const double t = static_cast<double>(view) / (num_views - 1);
      const auto wave = [&](double cycles, double phase) {
        return std::sin(2 * std::numbers::pi * cycles * t + phase);
      };
      const double azimuth = middle_rad +
                             side * options_.sweep * stage_.half_arc_rad * std::cos(2 * std::numbers::pi * 0.9 * t) +
                             jitter(0.03);
      const double elevation = radians(32 + 9 * wave(1.3, phase_height)) + jitter(0.02);
      const double middle_m = 0.5 * (options_.min_distance_m + options_.max_distance_m);
      const double swing_m = 0.5 * (options_.max_distance_m - options_.min_distance_m);
      const double distance = middle_m + swing_m * wave(1.1, phase_distance);
      const double pan = options_.sweep * wave(1.7, phase_pan);
      // One draw per statement: compilers differ in the order of arguments. Frozen versions drew the last one first.
      const double target_z_m = jitter(0.02);
      const double target_y_m = pan * stage_.pan_m.y() + jitter(0.02);
      const double target_x_m = pan * stage_.pan_m.x() + jitter(0.02);
      const Vector3d target = stage_.look_at_point_m + Vector3d(target_x_m, target_y_m, target_z_m);
      const Vector3d eye = target + distance * Vector3d(std::cos(elevation) * std::cos(azimuth),
                                                        std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
      script_.world_from_camera.push_back(look_at(eye, target) *
                                          Rigid3::from_axis_angle(Vector3d::UnitZ(), jitter(radians(3))));
    }
  }

  double jitter(double amplitude) { return rng_.uniform(-amplitude, amplitude); }

  const Catalogue& catalogue_;
  Rng rng_;
  Rng realism_rng_;
  int index_;
  const DynamicTabletopOptions& options_;
  SceneScript script_;
  TabletopStage stage_;
  std::vector<Thing> things_;
  int num_starting_ = 0;
};

}  // namespace

DynamicTabletopOptions DynamicTabletopOptions::of_version(int version) {
  DynamicTabletopOptions options;
  options.version = version;
  if (version == 2) {
    options.num_changes = 32;
    options.min_distance_m = 0.9;
    options.max_distance_m = 1.45;
    options.sweep = 1;
  }
  options.check();
  return options;
}

void DynamicTabletopOptions::check() const {
  check_in_range("DynamicTabletopOptions.version", version, 2, kDynamicTabletopVersion);
  check_in_range("DynamicTabletopOptions.num_known", num_known, 1, 100);
  check_in_range("DynamicTabletopOptions.num_waiting", num_waiting, 0, 100);
  check_in_range("DynamicTabletopOptions.num_unknown", num_unknown, 0, 100);
  check_in_range("DynamicTabletopOptions.num_changes", num_changes, 0, 1000);
  check_in_range("DynamicTabletopOptions.unknown_share", unknown_share, 0, 1);
  check_in_range("DynamicTabletopOptions.lying_share", lying_share, 0, 1);
  check_in_range("DynamicTabletopOptions.crowding", crowding, 0, 1);
  check_not_negative("DynamicTabletopOptions.gap_m", gap_m);
  check_positive("DynamicTabletopOptions.min_distance_m", min_distance_m);
  require(max_distance_m >= min_distance_m,
          "DynamicTabletopOptions.max_distance_m must not be less than min_distance_m");
  check_in_range("DynamicTabletopOptions.sweep", sweep, 0, 1);
  check_not_negative("DynamicTabletopOptions.depth_noise", depth_noise);
  check_not_negative("DynamicTabletopOptions.color_noise", color_noise);
}

std::vector<SceneScript> make_dynamic_tabletop(std::uint64_t seed, const DynamicTabletopOptions& options) {
  options.check();
  const Catalogue catalogue(seed, options.version);
  std::vector<SceneScript> scripts;
  for (int i = 0; i < static_cast<int>(kPlan.size()); ++i)
    scripts.push_back(SequenceBuilder(catalogue, seed, i, options).build());
  return scripts;
}

std::vector<std::string> dynamic_tabletop_library(std::uint64_t seed, int version) {
  if (version != 2) return seeded_object_names(seed).known;
  std::vector<std::string> names = procedural_object_names();
  std::erase_if(names,
                [](const std::string& name) { return std::ranges::find(kLookAlikes, name) != kLookAlikes.end(); });
  return names;
}

}  // namespace resight
