// SPDX-License-Identifier: Apache-2.0
#include "resight/simulation/dynamic_tabletop.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <stdexcept>

#include "resight/simulation/internal/footprint.hpp"
#include "resight/simulation/internal/scene_state.hpp"
#include "resight/simulation/seeded_objects.hpp"

namespace resight {
namespace {

TEST(DynamicTabletop, HasTheSizeOfThePapersDataSet) {
  const std::vector<SceneScript> scripts = make_dynamic_tabletop(1);
  ASSERT_EQ(scripts.size(), 9U);
  std::size_t num_views = 0;
  std::set<std::string> names;
  for (const SceneScript& script : scripts) {
    num_views += script.world_from_camera.size();
    names.insert(script.name);
    const auto checked = check_script(script);
    EXPECT_TRUE(checked.ok()) << script.name << ": " << checked.error().message;
  }
  EXPECT_EQ(num_views, 203U);
  EXPECT_EQ(names.size(), 9U);
  EXPECT_GE(dynamic_tabletop_library(1).size(), 16U);
}

// For each seed, scenes contain several kinds twice, twins, unknown objects, and every kind of change.
TEST(DynamicTabletop, HoldsWhatMakesItHard) {
  for (const std::uint64_t seed : {kDynamicTabletopValidationSeed, kDynamicTabletopTestSeed, std::uint64_t{77}}) {
    const SeededObjectNames seeded = seeded_object_names(seed);
    int doubles = 0, twins = 0, look_alikes = 0;
    std::map<ChangeKind, int> changes;
    for (const SceneScript& script : make_dynamic_tabletop(seed)) {
      std::map<std::string, int> known;
      int unknown = 0;
      for (const ObjectScript& object : script.objects) {
        if (!object.start) continue;
        if (object.known) ++known[object.model];
        if (!object.known) ++unknown;
        const auto& shaped_alike = seeded.unknown;
        if (std::find(shaped_alike.begin(), shaped_alike.begin() + 3, object.model) != shaped_alike.begin() + 3)
          ++look_alikes;
      }
      EXPECT_GE(known.size(), 5U) << script.name;
      EXPECT_GE(unknown, 1) << script.name;
      for (const auto& [model, count] : known) doubles += count == 2 ? 1 : 0;
      twins += known.contains(seeded.known[11]) && known.contains(seeded.known[12]) ? 1 : 0;
      for (const ChangeScript& change : script.changes) ++changes[change.kind];
    }
    EXPECT_GE(doubles, 9);
    EXPECT_GE(twins, 4);
    EXPECT_GE(look_alikes, 3);
    EXPECT_GE(changes[ChangeKind::kMoved], 15);
    EXPECT_GE(changes[ChangeKind::kRemoved], 8);
    EXPECT_GE(changes[ChangeKind::kAdded], 8);
  }
}

TEST(DynamicTabletop, SameSeedSameScenesOtherSeedOthers) {
  const std::vector<SceneScript> a = make_dynamic_tabletop(5);
  const std::vector<SceneScript> b = make_dynamic_tabletop(5);
  const std::vector<SceneScript> c = make_dynamic_tabletop(6);
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].world_from_camera[3].matrix(), b[i].world_from_camera[3].matrix());
    EXPECT_EQ(a[i].changes.size(), b[i].changes.size());
    EXPECT_NE(a[i].world_from_camera[3].matrix(), c[i].world_from_camera[3].matrix());
  }
}

TEST(DynamicTabletop, SeedsShareNoObject) {
  const std::vector<std::string> validation = dynamic_tabletop_library(kDynamicTabletopValidationSeed);
  const std::vector<std::string> test = dynamic_tabletop_library(kDynamicTabletopTestSeed);
  EXPECT_TRUE(std::ranges::none_of(
      validation, [&](const std::string& name) { return std::ranges::find(test, name) != test.end(); }));
  EXPECT_EQ(dynamic_tabletop_library(1, 2), dynamic_tabletop_library(2, 2)) << "version 2 has one library";
}

TEST(DynamicTabletop, HasTheErrorsOfRealDevices) {
  double largest_drift_m = 0;
  for (const SceneScript& script : make_dynamic_tabletop(4)) {
    ASSERT_TRUE(script.sensor.depth_errors && script.sensor.color_camera) << script.name;
    const DepthErrors& depth = *script.sensor.depth_errors;
    const double shift_px = std::hypot(depth.shift_u_px, depth.shift_v_px);
    EXPECT_GE(shift_px, 0.45);
    EXPECT_LE(shift_px, 2.05);
    EXPECT_EQ(script.lighting.lamps.size(), 2U);
    EXPECT_TRUE(script.lighting.shadows);
    ASSERT_EQ(script.reported_world_from_camera.size(), script.world_from_camera.size());
    for (std::size_t i = 0; i < script.world_from_camera.size(); ++i) {
      const double drift_m =
          (script.reported_world_from_camera[i].translation - script.world_from_camera[i].translation).norm();
      EXPECT_LT(drift_m, 0.04);
      largest_drift_m = std::max(largest_drift_m, drift_m);
    }
  }
  EXPECT_GT(largest_drift_m, 0.005);
}

// The rectangle that an instance covers in the world. Objects stand upright or lie on a side, so z stays vertical or
// becomes horizontal.
Footprint covered_in_world(const TriangleMesh& mesh, const Rigid3& world_from_mesh) {
  const bool lying = std::abs(world_from_mesh.rotation(2, 2)) < 0.5;
  const double yaw = std::atan2(world_from_mesh.rotation(1, 0), world_from_mesh.rotation(0, 0));
  Footprint f = footprint_of(mesh, lying ? std::numbers::pi / 2 : 0.0);
  f.center = world_from_mesh.translation.head<2>() + Eigen::Rotation2Dd(yaw) * f.center;
  f.yaw_rad = yaw;
  return f;
}

TEST(DynamicTabletop, ThingsDoNotRunIntoEachOther) {
  int num_compared = 0;
  int num_things = 0;
  for (const SceneScript& script : {make_dynamic_tabletop(3)[0], make_dynamic_tabletop(3)[4]}) {
    const auto state = build_scene_state(script, 1);
    ASSERT_TRUE(state.ok()) << state.error().message;
    for (std::size_t view = 0; view < state->poses.size(); view += 7) {
      const auto& poses = state->poses[view];
      for (std::size_t i = 0; i < poses.size(); ++i) {
        if (!poses[i] || state->instances[i].role < SimulatedInstance::Role::kDistractor) continue;
        ++num_things;
        for (std::size_t k = 0; k < i; ++k) {
          if (!poses[k] || state->instances[k].role < SimulatedInstance::Role::kDistractor) continue;
          if (std::abs(poses[i]->translation.z() - poses[k]->translation.z()) > 0.3) continue;  // another board
          ++num_compared;
          EXPECT_FALSE(overlaps(covered_in_world(*state->meshes[i], *poses[i]),
                                covered_in_world(*state->meshes[k], *poses[k]), 0.003))
              << script.name << " view " << view << ": " << state->instances[i].key << ", " << state->instances[k].key;
        }
      }
    }
  }
  EXPECT_GE(num_things, 60);
  EXPECT_GE(num_compared, 200);
}

// An observer learns of changes outside the image with delay. There must be some such changes, but also others.
TEST(DynamicTabletop, SomeChangesHappenOutOfView) {
  int in_view = 0, out_of_view = 0;
  for (const SceneScript& script : make_dynamic_tabletop(kDynamicTabletopValidationSeed)) {
    const auto state = build_scene_state(script, 1);
    ASSERT_TRUE(state.ok());
    for (const ScriptedEvent& event : state->events) {
      const Rigid3& where =
          event.world_from_object_after ? *event.world_from_object_after : *event.world_from_object_before;
      const Eigen::Vector3d p =
          script.world_from_camera[static_cast<std::size_t>(event.view)].inverse() * where.translation;
      (script.camera.contains(script.camera.project(p)) ? in_view : out_of_view) += 1;
    }
  }
  EXPECT_GE(in_view, 30);
  EXPECT_GE(out_of_view, 5);
}

TEST(DynamicTabletop, EachVersionHasItsSettings) {
  EXPECT_EQ(DynamicTabletopOptions::of_version(kDynamicTabletopVersion).num_changes,
            DynamicTabletopOptions{}.num_changes);
  EXPECT_GT(DynamicTabletopOptions::of_version(2).num_changes, DynamicTabletopOptions{}.num_changes);
  EXPECT_THROW(static_cast<void>(DynamicTabletopOptions::of_version(1)), std::invalid_argument);
}

}  // namespace
}  // namespace resight
