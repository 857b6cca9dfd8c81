// SPDX-License-Identifier: Apache-2.0
#include "resight/simulation/simulation.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <numbers>
#include <set>

#include "resight/io/ply.hpp"
#include "resight/simulation/presets.hpp"

namespace resight {
namespace {

namespace fs = std::filesystem;

constexpr Camera kSmall{160, 120, 131.25, 131.25, 79.5, 59.5};

Placement at(const Eigen::Vector3d& position) {
  Placement p;
  p.world_from_object = Rigid3::from_translation(position);
  return p;
}

Simulation create(SceneScript script, std::uint64_t seed = 1, int num_threads = 1) {
  SimulationOptions options;
  options.num_threads = num_threads;
  auto simulation = Simulation::create(std::move(script), seed, options);
  if (!simulation) throw std::runtime_error(simulation.error().message);
  return std::move(*simulation);
}

// Two equal boxes, one behind the other, seen from the front almost without perspective.
SceneScript half_hidden() {
  SceneScript script;
  script.room_size_m.reset();
  script.camera = {400, 400, 8000, 8000, 199.5, 199.5};
  script.sensor.noise_free = true;
  script.objects = {{"back", "plain_box", {}, true, at({0, 0, 0})},
                    {"front", "plain_box", {}, true, at({0.075, -0.2, 0})}};
  script.world_from_camera = {look_at({0, -10, 0.095}, {0, 0, 0.095})};
  return script;
}

TEST(Simulation, HalfHiddenBoxIsHalfVisible) {
  Simulation simulation = create(half_hidden());
  const SimulatedView view = simulation.render_view(0);
  ASSERT_EQ(view.ground_truth.size(), 2U);
  // The front box covers x from 0 to 0.15 (at a distance smaller by 0.2 m) of -0.075..0.075 of the back box.
  EXPECT_NEAR(view.ground_truth[0].visible_share, 0.5, 0.02);
  EXPECT_DOUBLE_EQ(view.ground_truth[1].visible_share, 1.0);
  EXPECT_EQ(view.ground_truth[0].instance, 0);
  EXPECT_EQ(view.ground_truth[1].instance, 1);  // two objects of one model
  const Rigid3 expected =
      simulation.script().world_from_camera[0].inverse() * Rigid3::from_translation({0.075, -0.2, 0});
  EXPECT_LT((view.ground_truth[1].camera_from_object.translation - expected.translation).norm(), 1e-12);
}

TEST(Simulation, ObjectCutByTheBorderIsPartlyVisibleAndOneOutsideIsAbsent) {
  SceneScript script = half_hidden();
  script.objects = {{"cut", "plain_box", {}, true, at({0.25, 0, 0})}, {"gone", "plain_box", {}, true, at({0.8, 0, 0})}};
  Simulation simulation = create(script);
  const SimulatedView view = simulation.render_view(0);
  ASSERT_EQ(view.ground_truth.size(), 1U);
  // At 9.945 m, the image border (200 px right of the centre) is at x = 0.2486 m. The front of the box extends over
  // 0.175..0.325.
  EXPECT_NEAR(view.ground_truth[0].visible_share, (0.2486 - 0.175) / 0.15, 0.02);
}

// The written pose is the tracker's; the truth is that of the camera.
TEST(Simulation, ReportsThePosesOfTheTracker) {
  SceneScript script = half_hidden();
  const Rigid3 error = Rigid3::from_translation({0.01, 0, 0.02});
  script.reported_world_from_camera = {error * script.world_from_camera[0]};
  const SimulatedView exact = create(half_hidden()).render_view(0);
  const SimulatedView drifted = create(script).render_view(0);
  EXPECT_EQ(drifted.frame.color, exact.frame.color);
  EXPECT_EQ(drifted.frame.world_from_camera.translation, script.reported_world_from_camera[0].translation);
  ASSERT_EQ(drifted.ground_truth.size(), exact.ground_truth.size());
  EXPECT_EQ(drifted.ground_truth[0].camera_from_object.translation,
            exact.ground_truth[0].camera_from_object.translation);
  script.reported_world_from_camera.push_back(Rigid3::identity());
  EXPECT_FALSE(Simulation::create(script, 1).ok());
}

TEST(Simulation, NoiseFreeColoursHaveNoDistortion) {
  SceneScript script = half_hidden();
  script.camera = {400, 400, 500, 500, 199.5, 199.5};
  script.world_from_camera = {look_at({0, -0.5, 0.095}, {0, 0, 0.095})};
  const SimulatedView ideal = create(script).render_view(0);
  script.color_lens.k1 = 0.1;
  EXPECT_EQ(create(script).render_view(0).frame.color, ideal.frame.color);
  script.sensor.noise_free = false;
  script.sensor.color_noise = script.sensor.gain_sigma = script.sensor.white_balance_sigma = 0;
  EXPECT_NE(create(script).render_view(0).frame.color, ideal.frame.color);
}

TEST(Simulation, LabelsAndDepthAgreeWithThePoses) {
  SceneScript script = make_demo_scene(2);
  script.camera = kSmall;
  script.sensor.noise_free = true;
  Simulation simulation = create(script);
  const SimulatedView view = simulation.render_view(4);
  ASSERT_TRUE(check_frame(view.frame).ok());
  std::set<int> seen;
  std::size_t checked = 0;
  for (int v = 0; v < kSmall.height; ++v)
    for (int u = 0; u < kSmall.width; ++u) {
      const int label = view.labels(u, v);
      if (label < 0) continue;
      seen.insert(label);
      const SimulatedInstance& instance = simulation.instances()[label];
      if (instance.role != SimulatedInstance::Role::kKnown) continue;
      const auto& mesh = simulation.library()[instance.object].mesh;
      const Eigen::Vector3d p_in_world =
          view.frame.world_from_camera * kSmall.unproject(u, v, view.frame.depth_m(u, v));
      const Eigen::Vector3f p = (simulation.world_from_instance(label, 4)->inverse() * p_in_world).cast<float>();
      Eigen::Vector3f low = mesh.vertices[0], high = low;
      for (const auto& x : mesh.vertices) {
        low = low.cwiseMin(x);
        high = high.cwiseMax(x);
      }
      EXPECT_TRUE((p.array() >= low.array() - 1e-4F).all() && (p.array() <= high.array() + 1e-4F).all())
          << instance.key;
      ++checked;
    }
  EXPECT_GT(checked, 1000U);
  EXPECT_GE(seen.size(), 12U);
}

TEST(Simulation, ThingsTouchTheirSupport) {
  for (std::uint64_t seed = 1; seed <= 2; ++seed) {
    const Simulation simulation = create(make_demo_scene(seed));
    int standing = 0;
    for (int view = 0; view < simulation.num_views(); view += 11)
      for (std::size_t i = 0; i < simulation.instances().size(); ++i) {
        const SimulatedInstance& instance = simulation.instances()[i];
        const auto& pose = simulation.world_from_instance(static_cast<int>(i), view);
        if (instance.object < 0 || !pose) continue;
        double low = 10;
        for (const auto& v : simulation.library()[instance.object].mesh.vertices)
          low = std::min(low, (*pose * v.cast<double>().eval()).z());
        EXPECT_NEAR(low, 0.74, 1e-6) << instance.key;
        ++standing;
      }
    EXPECT_GE(standing, 18);
  }
}

// A file may hold vertices that no face uses.
TEST(Simulation, UnusedVerticesDoNotLiftAnObject) {
  const fs::path file = fs::temp_directory_path() / ("resight_unused_" + std::to_string(::getpid()) + ".ply");
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {0.1F, 0, 0}, {0, 0.1F, 0.1F}, {0, 0, -0.5F}, {0, 0, 2}};
  mesh.faces = {{0, 1, 2}};
  ASSERT_TRUE(write_ply(file, mesh).ok());
  SceneScript script = half_hidden();
  script.objects = {{"lower", "thing", file, true, Placement{}}, {"upper", "mug", {}, true, Placement{}}};
  script.objects[1].start->support = "lower";
  const Simulation simulation = create(script);
  fs::remove(file);
  EXPECT_NEAR(simulation.world_from_instance(0, 0)->translation.z(), 0, 1e-6);
  EXPECT_NEAR(simulation.world_from_instance(1, 0)->translation.z(), 0.1, 1e-6);
}

// Overlapping footprints (convex hulls of the vertices seen from above) have no separating line along any of 90
// directions.
bool footprints_overlap(const TriangleMesh& a, const Rigid3& pose_a, const TriangleMesh& b, const Rigid3& pose_b) {
  const auto range = [](const TriangleMesh& mesh, const Rigid3& pose, const Eigen::Vector2d& axis) {
    std::pair<double, double> r{1e9, -1e9};
    for (const auto& v : mesh.vertices) {
      const double x = (pose * v.cast<double>().eval()).head<2>().dot(axis);
      r = {std::min(r.first, x), std::max(r.second, x)};
    }
    return r;
  };
  for (int i = 0; i < 90; ++i) {
    const Eigen::Vector2d axis(std::cos(i * M_PI / 90), std::sin(i * M_PI / 90));
    const auto ra = range(a, pose_a, axis);
    const auto rb = range(b, pose_b, axis);
    if (ra.second < rb.first || rb.second < ra.first) return false;
  }
  return true;
}

void expect_no_overlaps(const Simulation& simulation) {
  int pairs = 0;
  for (int view = 0; view < simulation.num_views(); ++view) {
    if (view > 0 && std::ranges::none_of(simulation.events(), [&](const auto& e) { return e.view == view; })) continue;
    std::vector<int> there;
    for (std::size_t i = 0; i < simulation.instances().size(); ++i)
      if (simulation.instances()[i].object >= 0 && simulation.world_from_instance(static_cast<int>(i), view))
        there.push_back(static_cast<int>(i));
    for (std::size_t a = 0; a < there.size(); ++a)
      for (std::size_t b = a + 1; b < there.size(); ++b) {
        const auto mesh = [&](int i) -> const TriangleMesh& {
          return simulation.library()[simulation.instances()[i].object].mesh;
        };
        EXPECT_FALSE(footprints_overlap(mesh(there[a]), *simulation.world_from_instance(there[a], view), mesh(there[b]),
                                        *simulation.world_from_instance(there[b], view)))
            << simulation.instances()[there[a]].key << " and " << simulation.instances()[there[b]].key << " in view "
            << view;
        ++pairs;
      }
  }
  EXPECT_GT(pairs, 10);
}

TEST(Presets, KnownObjectsDoNotOverlap) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    SCOPED_TRACE(seed);
    expect_no_overlaps(create(make_demo_scene(seed)));
  }
  RandomTabletopOptions options;
  options.lay_down = true;
  expect_no_overlaps(create(make_random_tabletop(5, options)));
}

TEST(Presets, DemoIsWhatItPromises) {
  SceneScript script = make_demo_scene(1);
  script.camera = kSmall;
  Simulation simulation = create(script, 1, 2);
  EXPECT_EQ(simulation.num_views(), 12);
  EXPECT_GE(simulation.library().size(), 8U);
  const auto role_count = [&](SimulatedInstance::Role role) {
    return std::ranges::count_if(simulation.instances(), [role](const auto& i) { return i.role == role; });
  };
  EXPECT_GE(role_count(SimulatedInstance::Role::kDistractor), 2);
  std::set<ChangeKind> kinds;
  for (const ScriptedEvent& e : simulation.events()) kinds.insert(e.kind);
  EXPECT_EQ(kinds.size(), 3U);
  EXPECT_GE(simulation.events().size(), 4U);
  for (const Rigid3& pose : script.world_from_camera) {
    const double distance = (pose.translation - Eigen::Vector3d(0, 0, 0.8)).norm();
    EXPECT_GT(distance, 0.9);
    EXPECT_LT(distance, 1.3);
  }
  int occluded = 0;
  std::vector<SimulatedView> views;
  for (int i = 0; i < 12; ++i) {
    views.push_back(simulation.render_view(i));
    EXPECT_GE(views.back().ground_truth.size(), 9U);
    for (const auto& g : views.back().ground_truth) occluded += g.visible_share < 0.9;
  }
  EXPECT_GT(occluded, 5);
  // The former place of an object becomes visible: rays through its old centre reach the background, and nearer things
  // do not cover most of its old silhouette.
  for (const ScriptedEvent& e : simulation.events()) {
    if (!e.world_from_object_before) continue;
    int seen_through = 0;
    for (int i = e.view; i < 12; ++i) {
      const Eigen::Vector3d p =
          views[i].frame.world_from_camera.inverse() * (*e.world_from_object_before * Eigen::Vector3d(0, 0, 0.03));
      const Eigen::Vector2d pixel = kSmall.project(p);
      if (!kSmall.contains(pixel)) continue;
      const float z =
          views[i].frame.depth_m(static_cast<int>(std::lround(pixel.x())), static_cast<int>(std::lround(pixel.y())));
      seen_through += z > p.z() + 0.01;
    }
    EXPECT_GE(seen_through, 1) << e.instance;
  }
}

TEST(Simulation, EventsAndPlacementsFollowTheScript) {
  const Simulation simulation = create(make_demo_scene(1));
  ASSERT_EQ(simulation.events().size(), 5U);
  for (const ScriptedEvent& e : simulation.events()) {
    const auto i =
        std::ranges::find(simulation.instances(), e.instance, &SimulatedInstance::key) - simulation.instances().begin();
    const int instance = static_cast<int>(i);
    const auto& before = simulation.world_from_instance(instance, e.view - 1);
    const auto& after = simulation.world_from_instance(instance, e.view);
    EXPECT_EQ(before.has_value(), e.kind != ChangeKind::kAdded);
    EXPECT_EQ(after.has_value(), e.kind != ChangeKind::kRemoved);
    EXPECT_EQ(e.world_from_object_before.has_value(), before.has_value());
    if (before && after) {
      EXPECT_GT((before->translation - after->translation).norm(), 0.05);
      EXPECT_EQ(simulation.placement_number(instance, e.view), simulation.placement_number(instance, e.view - 1) + 1);
      EXPECT_EQ(after->translation, e.world_from_object_after->translation);
    }
  }
}

bool same_bytes(const SimulatedView& a, const SimulatedView& b) {
  return a.frame.color == b.frame.color && a.labels == b.labels && a.frame.depth_m.size() == b.frame.depth_m.size() &&
         std::memcmp(a.frame.depth_m.data().data(), b.frame.depth_m.data().data(),
                     a.frame.depth_m.size() * sizeof(float)) == 0;
}

TEST(Simulation, SameSeedSameBytesForAnyThreadsAndOrder) {
  SceneScript script = make_demo_scene(3);
  script.camera = kSmall;
  Simulation one = create(script, 7, 1);
  Simulation two = create(script, 7, 3);
  Simulation other = create(script, 8, 1);
  const SimulatedView last = two.render_view(11);
  const SimulatedView first = two.render_view(0);
  EXPECT_TRUE(same_bytes(one.render_view(0), first));
  EXPECT_TRUE(same_bytes(one.render_view(11), last));
  EXPECT_FALSE(same_bytes(other.render_view(0), first));
  EXPECT_FALSE(same_bytes(first, last));
}

TEST(RandomTabletop, IsSeededAndFullOfChanges) {
  RandomTabletopOptions options;
  options.num_changes = 6;
  options.num_known = 6;
  const SceneScript a = make_random_tabletop(1, options);
  const SceneScript b = make_random_tabletop(1, options);
  const SceneScript c = make_random_tabletop(2, options);
  ASSERT_EQ(a.objects.size(), b.objects.size());
  for (std::size_t i = 0; i < a.objects.size(); ++i) EXPECT_EQ(a.objects[i].key, b.objects[i].key);
  EXPECT_EQ(a.changes.size(), b.changes.size());
  EXPECT_GE(a.changes.size(), 4U);
  EXPECT_NE(a.objects[0].start->x_m, c.objects[0].start->x_m);
  EXPECT_TRUE(check_script(a).ok());
  options.models = {"mug"};
  options.num_known = 3;
  const SceneScript mugs = make_random_tabletop(1, options);
  EXPECT_EQ(mugs.objects[1].key, "mug_2");
  options.models = {"unicorn"};
  EXPECT_THROW(static_cast<void>(make_random_tabletop(1, options)), std::invalid_argument);
}

TEST(Presets, AllAreGoodAndUnknownOnesAreErrors) {
  for (const std::string& name : preset_scene_names()) {
    const auto script = make_preset_scene(name, 3);
    ASSERT_TRUE(script.ok());
    EXPECT_TRUE(check_script(*script).ok()) << name;
    const bool is_sparse = name == "sparse-views";
    EXPECT_GE(script->objects.size(), is_sparse ? 3U : 6U) << name;
    EXPECT_GE(script->changes.size(), is_sparse ? 0U : 3U) << name;
  }
  const auto unknown = make_preset_scene("moon", 1);
  ASSERT_FALSE(unknown.ok());
  EXPECT_NE(unknown.error().message.find("demo"), std::string::npos);
}

TEST(Presets, SparseViewsLieFarApart) {
  for (const std::uint64_t seed : {1, 2}) {
    const SceneScript script = make_sparse_views(seed);
    const std::vector<Rigid3>& poses = script.world_from_camera;
    ASSERT_EQ(poses.size(), 24U);
    for (std::size_t v = 0; v < poses.size(); ++v) {
      const Rigid3 step = poses[v].inverse() * poses[(v + 1) % poses.size()];
      EXPECT_NEAR(step.translation.norm(), 0.3, 1e-6);
      EXPECT_NEAR(rotation_angle_rad(step.rotation, Eigen::Matrix3d::Identity()), radians(15), 0.05);
    }
    EXPECT_EQ(script.objects.size(), seed == 1 ? 3U : 8U);
  }
}

// Levels are heights above the origin of furniture.
TEST(Simulation, OnlyUprightFurnitureCarriesThings) {
  SceneScript script = half_hidden();
  script.furniture.push_back({"table", "table", {1.2, 0.8, 0.74}, {}});
  Placement on_table;
  on_table.support = "table";
  script.objects = {{"mug", "mug", {}, true, on_table}};
  script.furniture[0].placement.yaw_rad = 1;
  EXPECT_TRUE(Simulation::create(script, 1).ok());
  for (const double roll_rad : {0.02, 0.5, std::numbers::pi}) {
    script.furniture[0].placement.roll_rad = roll_rad;
    const auto simulation = Simulation::create(script, 1);
    ASSERT_FALSE(simulation.ok()) << roll_rad;
    EXPECT_NE(simulation.error().message.find("'mug': 'table' is not upright"), std::string::npos)
        << simulation.error().message;
  }
  script.objects.clear();
  EXPECT_TRUE(Simulation::create(script, 1).ok()) << "may lie there alone";
}

TEST(Simulation, WrongScriptsAndIndicesAreRefused) {
  SceneScript script = half_hidden();
  script.objects[0].model = "yeti";
  const auto simulation = Simulation::create(script, 1);
  ASSERT_FALSE(simulation.ok());
  EXPECT_NE(simulation.error().message.find("yeti"), std::string::npos);
  script = half_hidden();
  script.objects[0].mesh = "/nowhere/thing.ply";
  EXPECT_FALSE(Simulation::create(script, 1).ok());
  Simulation good = create(half_hidden());
  EXPECT_THROW(static_cast<void>(good.render_view(1)), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(good.world_from_instance(5, 0)), std::invalid_argument);
}

}  // namespace
}  // namespace resight
