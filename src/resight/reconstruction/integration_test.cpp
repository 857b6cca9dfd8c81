// SPDX-License-Identifier: Apache-2.0
#include "resight/reconstruction/integration.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <map>
#include <stdexcept>
#include <tuple>

#include "resight/changes/analytic_scene_test_util.hpp"
#include "resight/core/random.hpp"
#include "resight/geometry/voxel_key.hpp"

namespace resight {
namespace {

using namespace testing_scene;
using Cell = std::tuple<int, int, int>;

const Box kTableBox{{0, 0, 0.1}, {0.12, 0.05, 0.1}, 0.4};

Scene table_with_box() {
  Scene scene = table();
  scene.boxes = {kTableBox};
  scene.spheres = {{{-0.25, 0.1, 0.06}, 0.06}};
  return scene;
}

std::vector<PreparedView> three_views() {
  std::vector<PreparedView> views{see(table_with_box()), see(table_with_box(), look_at({0.8, -0.5, 0.7}, {0, 0, 0})),
                                  see(table_with_box(), look_at({-0.4, -0.7, 0.5}, {0, 0, 0}))};
  for (std::size_t v = 0; v < views.size(); ++v)  // Encodes the origin of a point.
    for (std::size_t i = 0; i < views[v].frame.color.size(); ++i)
      views[v].frame.color[i] = {static_cast<std::uint8_t>(v), static_cast<std::uint8_t>(i % 251),
                                 static_cast<std::uint8_t>(i / 251 % 251)};
  return views;
}

std::vector<const PreparedView*> pointers(const std::vector<PreparedView>& views) {
  std::vector<const PreparedView*> result;
  for (const PreparedView& view : views) result.push_back(&view);
  return result;
}

struct Best {
  float noise;
  int view;
  Eigen::Vector3f point;
  Eigen::Vector3f normal;
  Rgb8 color;
  int num_points;
};

/// Reference implementation: all points of all views in a sorted map of voxels.
std::map<Cell, Best> integrate_slowly(const std::vector<PreparedView>& views, const IntegrateOptions& options) {
  std::map<Cell, Best> voxels;
  for (std::size_t v = 0; v < views.size(); ++v) {
    const PreparedView& view = views[v];
    const Rigid3f world_from_camera(view.frame.world_from_camera);
    for (std::size_t i = 0; i < view.cloud.z.size(); ++i) {
      if (!view.cloud.has_normal(i) || view.edge_distance_px[i] < options.min_edge_distance_px) continue;
      const Eigen::Vector3f p = world_from_camera * view.cloud.point(i);
      const Eigen::Vector3i index = voxel_index(p, static_cast<float>(1 / options.voxel_m));
      const float noise = view.noise.lateral_m[i] * view.noise.lateral_m[i] * view.noise.axial_m[i];
      const Best candidate{
          noise, static_cast<int>(v), p, world_from_camera.rotation * view.cloud.normal(i), view.frame.color[i], 1};
      const auto [entry, is_first] = voxels.try_emplace({index.x(), index.y(), index.z()}, candidate);
      if (is_first) continue;
      Best& best = entry->second;
      const int num_points = best.num_points + 1;
      if (noise < best.noise || (noise == best.noise && static_cast<int>(v) > best.view)) best = candidate;
      best.num_points = num_points;
    }
  }
  std::erase_if(voxels, [&](const auto& v) { return v.second.num_points < options.min_points_per_voxel; });
  return voxels;
}

void expect_equal(const Reconstruction& result, const std::map<Cell, Best>& expected, double voxel_m) {
  ASSERT_EQ(result.cloud_in_world.size(), expected.size());
  ASSERT_TRUE(result.cloud_in_world.has_normals() && result.cloud_in_world.has_colors());
  ASSERT_EQ(result.noise.size(), expected.size());
  ASSERT_EQ(result.view.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const Eigen::Vector3f& p = result.cloud_in_world.points[i];
    const Eigen::Vector3i index = voxel_index(p, static_cast<float>(1 / voxel_m));
    const auto found = expected.find({index.x(), index.y(), index.z()});
    ASSERT_NE(found, expected.end());
    EXPECT_LT((p - found->second.point).norm(), 1e-6F);  // The compiler decides the order of rounding.
    EXPECT_LT((result.cloud_in_world.normals[i] - found->second.normal).norm(), 1e-6F);
    EXPECT_EQ(result.cloud_in_world.colors[i], found->second.color);
    EXPECT_EQ(result.noise[i], found->second.noise);
    EXPECT_EQ(result.view[i], found->second.view);
  }
}

TEST(IntegrateViews, AgreesWithASortedMap) {
  const std::vector<PreparedView> views = three_views();
  for (const IntegrateOptions& options :
       {IntegrateOptions{}, IntegrateOptions{.voxel_m = 0.02, .min_edge_distance_px = 0, .min_points_per_voxel = 4}}) {
    const auto expected = integrate_slowly(views, options);
    ASSERT_GT(expected.size(), 2000U);
    expect_equal(integrate_views(pointers(views), options), expected, options.voxel_m);
  }
}

TEST(IntegrateViews, OneViewIsEnough) {
  const std::vector<PreparedView> views{three_views().front()};
  expect_equal(integrate_views(pointers(views)), integrate_slowly(views, {}), IntegrateOptions{}.voxel_m);
}

TEST(IntegrateViews, TheBetterViewWins) {
  // A near, frontal view against a distant, grazing one of the same table.
  std::vector<PreparedView> views{see(table(), look_at({0, -0.1, 0.7}, {0, 0, 0})),
                                  see(table(), look_at({0, -1.8, 0.6}, {0, 0, 0}))};
  for (int order = 0; order < 2; ++order) {
    const Reconstruction result = integrate_views(pointers(views));
    const int near = order == 0 ? 0 : 1;
    int num_middle = 0;
    for (std::size_t i = 0; i < result.view.size(); ++i) {
      const Eigen::Vector3f& p = result.cloud_in_world.points[i];
      if (p.head<2>().norm() > 0.2F) continue;
      EXPECT_EQ(result.view[i], near);
      ++num_middle;
    }
    EXPECT_GT(num_middle, 1000);
    std::swap(views[0], views[1]);
  }
}

TEST(IntegrateViews, TiesGoToTheLaterView) {
  const std::vector<PreparedView> views{see(table()), see(table())};
  const Reconstruction result = integrate_views(pointers(views));
  ASSERT_GT(result.view.size(), 1000U);
  EXPECT_TRUE(std::ranges::all_of(result.view, [](int v) { return v == 1; }));
}

TEST(IntegrateViews, EdgesAndPointsWithoutNormalsTakeNoPart) {
  std::vector<PreparedView> views{see(table_with_box())};
  const std::size_t all = integrate_views(pointers(views), {.min_edge_distance_px = 0}).view.size();
  const std::size_t inner = integrate_views(pointers(views), {.min_edge_distance_px = 3}).view.size();
  EXPECT_LT(inner + 100, all);
  for (float& nx : views[0].cloud.nx.data()) nx = std::numeric_limits<float>::quiet_NaN();
  EXPECT_TRUE(integrate_views(pointers(views)).cloud_in_world.empty());
}

/// The voxels ordered by their first pixels, independent of their slots, as the merge uses them.
struct InOrder {
  std::vector<std::uint64_t> keys;
  std::vector<int> numbers;
  std::vector<Eigen::Vector3f> points;
  std::vector<Eigen::Vector3f> normals;
  std::vector<float> noise;
  std::vector<int> num_points;
  std::vector<std::uint64_t> key_of_pixel;
  friend bool operator==(const InOrder&, const InOrder&) = default;
};

InOrder in_order(const ViewVoxels& voxels) {
  InOrder result;
  for (const int slot : voxels.order) {
    result.keys.push_back(voxels.keys[slot]);
    result.numbers.push_back(voxels.numbers[slot]);
    result.points.push_back(voxels.cloud_in_world.points[slot]);
    result.normals.push_back(voxels.cloud_in_world.normals[slot]);
    result.noise.push_back(voxels.noise[slot]);
    result.num_points.push_back(voxels.num_points[slot]);
  }
  for (const int slot : voxels.slot_of_pixel) result.key_of_pixel.push_back(slot < 0 ? 0 : voxels.keys[slot]);
  return result;
}

TEST(UpdateVoxels, IsWhatReducingGives) {
  const PreparedView view = three_views()[0];
  VoxelNumbers numbers;
  const ViewVoxels before = reduce_to_voxels(view, numbers);
  PointCloud removed;
  for (std::size_t i = 0; i < before.cloud_in_world.size(); i += 50)
    removed.points.push_back(before.cloud_in_world.points[i]);
  const PreparedView cleared = clear_removed_points(view, removed, 0.01);
  const ViewVoxels expected = reduce_to_voxels(cleared, numbers);
  ViewVoxels voxels = before;
  update_voxels(cleared, voxels);
  ASSERT_LT(voxels.order.size(), before.order.size());
  EXPECT_TRUE(in_order(voxels) == in_order(expected));
  update_voxels(view, voxels);  // With points that it did not have before.
  EXPECT_TRUE(in_order(voxels) == in_order(before));
  ViewVoxels none;
  EXPECT_THROW(update_voxels(view, none), std::invalid_argument);
}

TEST(UpdateVoxels, VoxelsThatComeAreNew) {
  const PreparedView view = three_views()[0];
  PointCloud removed;
  removed.points = {{0, -0.05F, 0.1F}};
  const PreparedView cleared = clear_removed_points(view, removed, 0.1);
  VoxelNumbers numbers;
  ViewVoxels voxels = reduce_to_voxels(cleared, numbers);
  update_voxels(view, voxels);
  ASSERT_LT(voxels.numbers.size(), voxels.keys.size());
  numbers.assign_to(voxels);
  EXPECT_TRUE(in_order(voxels) == in_order(reduce_to_voxels(view, numbers)));
}

TEST(VoxelNumbers, AreThoseOfAMap) {
  VoxelNumbers numbers;
  std::map<std::uint64_t, int> twin;
  Rng rng(1);
  for (int i = 0; i < 20000; ++i) {
    const auto next = [&] { return static_cast<int>(rng.below(40)) - 20; };
    const std::uint64_t key = voxel_key(next(), next(), next());
    const int expected = twin.try_emplace(key, static_cast<int>(twin.size())).first->second;
    ASSERT_EQ(numbers.number_of(key), expected);
  }
  EXPECT_EQ(numbers.size(), twin.size());
}

TEST(VoxelMerger, WantsNumbers) {
  VoxelNumbers numbers;
  ViewVoxels voxels = reduce_to_voxels(three_views()[0], numbers);
  voxels.numbers.pop_back();
  Reconstruction result;
  for (const ViewVoxels* view : {static_cast<const ViewVoxels*>(&voxels), static_cast<const ViewVoxels*>(nullptr)}) {
    const std::vector<const ViewVoxels*> views{view};
    EXPECT_THROW(VoxelMerger().merge(views, {}, result), std::invalid_argument);
  }
}

TEST(VoxelMerger, RemembersNothing) {
  const std::vector<PreparedView> views = three_views();
  VoxelNumbers numbers;
  std::vector<ViewVoxels> voxels;
  for (const PreparedView& view : views) voxels.push_back(reduce_to_voxels(view, numbers));
  VoxelMerger merger;
  Reconstruction result;
  for (const std::vector<std::size_t>& chosen :
       std::vector<std::vector<std::size_t>>{{0, 1, 2}, {1}, {2, 0}, {}, {0, 1}}) {
    std::vector<const ViewVoxels*> some;
    std::vector<const PreparedView*> same;
    for (const std::size_t v : chosen) {
      some.push_back(&voxels[v]);
      same.push_back(&views[v]);
    }
    merger.merge(some, {}, result);
    const Reconstruction expected = integrate_views(same);
    EXPECT_EQ(result.cloud_in_world.points, expected.cloud_in_world.points);
    EXPECT_EQ(result.view, expected.view);
  }
}

TEST(IntegrateViews, NothingFromNothing) {
  EXPECT_TRUE(integrate_views({}).cloud_in_world.empty());
  RgbdFrame blind = render(table(), small_camera(), usual_pose());
  std::ranges::fill(blind.depth_m.data(), std::numeric_limits<float>::quiet_NaN());
  const std::vector<PreparedView> views{prepare_view(blind)};
  EXPECT_TRUE(integrate_views(pointers(views)).cloud_in_world.empty());
}

TEST(IntegrateViews, SerialIsParallel) {
  const std::vector<PreparedView> views = three_views();
  const Reconstruction serial = integrate_views(pointers(views));
  const Reconstruction parallel = integrate_views(pointers(views), {.num_threads = 3});
  ASSERT_GT(serial.view.size(), 2000U);
  EXPECT_EQ(parallel.cloud_in_world.points, serial.cloud_in_world.points);
  EXPECT_EQ(parallel.cloud_in_world.normals, serial.cloud_in_world.normals);
  EXPECT_EQ(parallel.cloud_in_world.colors, serial.cloud_in_world.colors);
  EXPECT_EQ(parallel.noise, serial.noise);
  EXPECT_EQ(parallel.view, serial.view);
}

TEST(IntegrateViews, RefusesNonsense) {
  const std::vector<PreparedView> views{see(table())};
  EXPECT_THROW((void)integrate_views(pointers(views), {.voxel_m = 0}), std::invalid_argument);
  EXPECT_THROW((void)integrate_views(pointers(views), {.min_edge_distance_px = -1}), std::invalid_argument);
  EXPECT_THROW((void)integrate_views(pointers(views), {.min_points_per_voxel = 0}), std::invalid_argument);
  EXPECT_THROW((void)integrate_views(pointers(views), {.num_threads = 0}), std::invalid_argument);
  const PreparedView* null[] = {nullptr};
  EXPECT_THROW((void)integrate_views(null), std::invalid_argument);
  PreparedView bare;
  bare.cloud.z = Image<float>(4, 4);
  const PreparedView* unprepared[] = {&bare};
  EXPECT_THROW((void)integrate_views(unprepared), std::invalid_argument);
}

}  // namespace
}  // namespace resight
