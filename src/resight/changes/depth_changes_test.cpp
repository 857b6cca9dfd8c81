// SPDX-License-Identifier: Apache-2.0
#include "resight/changes/depth_changes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "resight/changes/analytic_scene_test_util.hpp"
#include "resight/changes/change_detector.hpp"
#include "resight/core/random.hpp"

namespace resight {
namespace {

using namespace testing_scene;
const Box kCarton{{0, 0, 0.1}, {0.12, 0.05, 0.1}, 0.4};
const Rigid3 kBeside = look_at({0.2, -0.9, 0.75}, {0.05, 0, 0});

Scene scene_with(const std::vector<Box>& boxes) {
  Scene scene = table();
  scene.boxes = boxes;
  return scene;
}

/// Frame with the noise that the sensor model claims, along the rays.
PreparedView see_with_noise(const Scene& scene, const Rigid3& world_from_camera, std::uint64_t seed) {
  const PreparedView exact = see(scene, world_from_camera);
  RgbdFrame frame = exact.frame;
  Rng rng(seed);
  for (std::size_t i = 0; i < frame.depth_m.size(); ++i)
    if (exact.cloud.has_normal(i)) frame.depth_m[i] += static_cast<float>(rng.normal()) * exact.noise.axial_m[i];
  return prepare_view(std::move(frame), {.normals = {.window_radius_px = 4}});
}

int count(const Image<std::uint8_t>& mask) {
  return static_cast<int>(std::ranges::count_if(mask.data(), [](auto m) { return m != 0; }));
}

ChangeResult detect(const PreparedView& before, const PreparedView& after, int num_threads = 1) {
  const PreparedView* earlier[] = {&before};
  return detect_changes(world_cloud(before), after, {.test = DepthTestOptions{}, .num_threads = num_threads}, earlier);
}

TEST(DepthChanges, AnUnchangedSceneHasNone) {
  for (const Rigid3& pose : {usual_pose(), kBeside, look_at({0, -0.9, 0.12}, {0, 0, 0})}) {
    const ChangeResult changes = detect(see(scene_with({kCarton})), see(scene_with({kCarton}), pose));
    EXPECT_EQ(count(changes.novel_mask), 0);
    EXPECT_EQ(count(changes.removed_mask), 0);
    EXPECT_TRUE(changes.removed_in_world.empty());
    EXPECT_GT(changes.evidence_count[static_cast<std::size_t>(Evidence::kPresent)], 10000);
  }
}

// A step of the table by so many standard deviations of the difference, in a square.
ChangeResult detect_step(float num_sigmas, int side_px, bool has_print = false) {
  PreparedView before = see(scene_with({}));
  if (has_print)
    for (std::size_t i = 0; i < before.frame.color.size(); ++i)
      before.frame.color[i] = {static_cast<std::uint8_t>(i % 320 / 32 * 25), 90, 120};
  RgbdFrame frame = before.frame;
  for (int v = 100; v < 100 + side_px; ++v)
    for (int u = 100; u < 100 + side_px; ++u) {
      const std::size_t i = frame.depth_m.index(u, v);
      const float normal_per_depth = std::abs(before.cloud.normal(i).dot(before.cloud.point(i))) / frame.depth_m[i];
      frame.depth_m[i] -= num_sigmas * std::sqrt(2.0F) * before.noise.normal_m[i] / normal_per_depth;
    }
  return detect(before, prepare_view(std::move(frame), {.normals = {.window_radius_px = 4}}));
}

// Neighbouring errors are alike: a small region must differ by much, a large one by little more than the threshold.
TEST(DepthChanges, ASmallRegionMustDifferByMore) {
  constexpr float kMarginal = 2.1F;  // 3 sigmas: without noise, its scale is 0.7.
  EXPECT_EQ(count(detect_step(kMarginal, 7).novel_mask), 0);
  EXPECT_GT(count(detect_step(kMarginal, 20).novel_mask), 20 * 20 / 2);
  EXPECT_GT(count(detect_step(20, 7).novel_mask), 7 * 7 / 2);
}

// A thing that came would have to look like the print that it hides.
TEST(DepthChanges, WhereColoursAreAsBeforeARegionMustBeLarger) {
  constexpr float kMarginal = 2.1F;
  EXPECT_GT(count(detect_step(kMarginal, 20).novel_mask), 20 * 20 / 2);
  EXPECT_EQ(count(detect_step(kMarginal, 20, true).novel_mask), 0);
  EXPECT_GT(count(detect_step(20, 40, true).novel_mask), 40 * 40 / 2);
}

/// A table, with or without a white plate of 50 x 50 pixels that is 1.3 standard deviations of a difference high.
PreparedView see_plate(bool is_there, std::uint64_t seed) {
  const PreparedView view = see_with_noise(table(), usual_pose(), seed);
  RgbdFrame frame = view.frame;
  for (int v = 0; v < frame.color.height(); ++v)
    for (int u = 0; u < frame.color.width(); ++u) {
      const bool is_plate = is_there && u >= 140 && u < 190 && v >= 110 && v < 160;
      frame.color(u, v) = is_plate ? Rgb8{230, 230, 225} : Rgb8{180, 130, 90};
      if (is_plate) frame.depth_m(u, v) -= 1.3F * std::sqrt(2.0F) * view.noise.axial_m(u, v);
    }
  return prepare_view(std::move(frame), {.normals = {.window_radius_px = 4}});
}

TEST(DepthChanges, AFlatThingComesAndGoesWithItsInside) {
  const PreparedView empty = see_plate(false, 1), full = see_plate(true, 2);
  const auto inside = [](const Image<std::uint8_t>& mask) {
    int num = 0;
    for (int v = 125; v < 145; ++v)
      for (int u = 155; u < 175; ++u) num += mask(u, v) != 0 ? 1 : 0;
    return num;
  };
  const ChangeResult came = detect(empty, full), left = detect(full, empty);
  EXPECT_GT(inside(came.novel_mask), 350);
  EXPECT_GT(inside(left.removed_mask), 350);
  EXPECT_LT(count(came.novel_mask), 2600);
  EXPECT_LT(count(left.removed_mask), 2600);
}

// The carton leaves, and comes back at its old place. One view without it may err, two do not.
TEST(DepthChanges, WhatComesWhereSomethingElseWasIsNovel) {
  const PreparedView with = see(scene_with({kCarton})), without = see(scene_with({}), kBeside);
  const auto num_novel = [&](const std::vector<const PreparedView*>& earlier) {
    return count(find_depth_changes(with, earlier, {}, 1).novel);
  };
  EXPECT_EQ(num_novel({&with, &without}), 0);
  EXPECT_EQ(num_novel({&without, &with, &without}), 0);
  EXPECT_GT(num_novel({&with, &without, &without}), 1500);
  EXPECT_GT(num_novel({&with, &with, &without, &without}), 1500);
}

TEST(DepthChanges, NoiseIsNoChange) {
  const PreparedView before = see_with_noise(scene_with({kCarton}), usual_pose(), 1);
  for (const Rigid3& pose : {usual_pose(), kBeside}) {
    const ChangeResult changes = detect(before, see_with_noise(scene_with({kCarton}), pose, 2));
    EXPECT_LT(count(changes.novel_mask), 320 * 240 / 500);
    EXPECT_LT(count(changes.removed_mask), 320 * 240 / 500);
  }
}

TEST(DepthChanges, ARemovedBoxIsSeenThrough) {
  for (const Rigid3& pose : {usual_pose(), kBeside}) {
    const PreparedView before = see(scene_with({kCarton}));
    const ChangeResult changes = detect(before, see(table(), pose));
    EXPECT_EQ(count(changes.novel_mask), 0) << "the table below is newly seen, not new";
    const int found = count_at(kCarton, changes.removed_in_world, 0.003);
    EXPECT_EQ(found, static_cast<int>(changes.removed_in_world.size()));
    const PointCloud box = voxel_downsample(world_cloud(before), 0.005);
    int expected = 0;
    for (const Eigen::Vector3f& p : box.points) expected += is_at(kCarton, p) && p.z() > 0.02F ? 1 : 0;
    ASSERT_GT(expected, 1000);
    EXPECT_GT(found, expected * 9 / 10);
    EXPECT_GT(count(changes.removed_mask), 1500);
  }
}

/// The view without depth where `lacks_depth` says so.
template <typename LacksDepth>
PreparedView without_depth(const PreparedView& view, const LacksDepth& lacks_depth) {
  RgbdFrame frame = view.frame;
  for (std::size_t i = 0; i < frame.depth_m.size(); ++i)
    if (lacks_depth(i)) frame.depth_m[i] = std::nanf("");
  return prepare_view(std::move(frame), {.normals = {.window_radius_px = 4}});
}

int count_novel(const std::vector<PreparedView>& earlier, const PreparedView& view) {
  std::vector<const PreparedView*> views;
  for (const PreparedView& e : earlier) views.push_back(&e);
  return count(find_depth_changes(view, views, {}, 1).novel);
}

// Depth comes and goes on shiny surfaces. The carton was reported when it came, and its hole was not free space.
TEST(DepthChanges, AHoleThatFillsIsNotNovel) {
  const PreparedView carton = see(scene_with({kCarton}));
  const PreparedView before = see(table());
  const auto is_spot = [&](std::size_t i) {
    const std::size_t u = i % 320;
    const std::size_t v = i / 320;
    return u >= 145 && u < 165 && v >= 95 && v < 110;
  };
  const PreparedView holed = without_depth(carton, is_spot);
  EXPECT_GT(count_novel({before}, holed), 1500);
  EXPECT_GT(count_novel({before}, carton), count_novel({before}, holed) + 200) << "the spot is on the carton";
  EXPECT_EQ(count_novel({before, holed}, carton), 0);
}

// A thing without depth is not there to be continued.
TEST(DepthChanges, AThingWhoseDepthComesLaterIsNovel) {
  const PreparedView before = see(table());
  for (const double half_height_m : {0.1, 0.02, 0.01}) {
    const PreparedView after = see(scene_with({{{0, 0, half_height_m}, {0.08, 0.05, half_height_m}, 0.4}}));
    const PreparedView unseen = without_depth(
        after, [&](std::size_t i) { return std::abs(after.frame.depth_m[i] - before.frame.depth_m[i]) > 0.002F; });
    EXPECT_EQ(count_novel({before}, unseen), 0);
    EXPECT_EQ(count_novel({before, unseen}, after), count_novel({before}, after)) << half_height_m;
    EXPECT_GT(count_novel({before}, after), 500);
  }
}

TEST(DepthChanges, TheRemovedMaskHasNoGaps) {
  // A nearer camera has more pixels of the box than the one that saw it, and noise scatters these.
  const Rigid3 nearer = look_at({0, -0.6, 0.55}, {0, 0, 0.1});
  const Scene with_box = scene_with({kCarton});
  const Image<std::uint8_t> mask =
      detect(see_with_noise(with_box, usual_pose(), 1), see_with_noise(table(), nearer, 2)).removed_mask;
  const PreparedView box_view = see(with_box, nearer);
  const PreparedView table_view = see(table(), nearer);
  const auto is_box = [&](int u, int v) { return box_view.cloud.z(u, v) < table_view.cloud.z(u, v) - 0.02F; };
  constexpr int kBorder_px = 5;
  int num_inside = 0;
  int num_gaps = 0;
  int num_outside = 0;
  for (int v = kBorder_px; v < mask.height() - kBorder_px; ++v)
    for (int u = kBorder_px; u < mask.width() - kBorder_px; ++u) {
      int num_box = 0;
      for (const int dv : {-kBorder_px, 0, kBorder_px})
        for (const int du : {-kBorder_px, 0, kBorder_px}) num_box += is_box(u + du, v + dv) ? 1 : 0;
      num_inside += num_box == 9 ? 1 : 0;
      num_gaps += num_box == 9 && mask(u, v) == 0 ? 1 : 0;
      num_outside += num_box == 0 ? mask(u, v) : 0;
    }
  ASSERT_GT(num_inside, 3000);
  EXPECT_LT(num_gaps, num_inside / 100);
  EXPECT_EQ(num_outside, 0);
}

TEST(DepthChanges, AnAddedBoxIsNovel) {
  for (const Rigid3& pose : {usual_pose(), kBeside}) {
    const ChangeResult changes = detect(see(table()), see(scene_with({kCarton}), pose));
    EXPECT_EQ(count(changes.removed_mask), 0);
    ASSERT_GT(changes.novel_in_world.size(), 1000U);
    EXPECT_EQ(count_at(kCarton, changes.novel_in_world, 0.003), static_cast<int>(changes.novel_in_world.size()));
    EXPECT_EQ(changes.novel_in_world.colors.size(), changes.novel_in_world.size());
  }
}

/// The scene as it looks from the usual pose, with a pose that is 2 cm off along the table.
PreparedView see_from_wrong_pose(const Scene& scene) {
  PreparedView view = see(scene, usual_pose());
  view.frame.world_from_camera.translation.x() += 0.02;
  return view;
}

TEST(DepthChanges, AWrongPoseMakesNoFringes) {
  const Box upright{{-0.1, 0, 0.1}, {0.1, 0.05, 0.1}};
  const Box flat{{0.2, 0, 0.02}, {0.05, 0.08, 0.02}};
  const ChangeResult unchanged = detect(see(scene_with({upright})), see_from_wrong_pose(scene_with({upright})));
  EXPECT_EQ(count(unchanged.novel_mask), 0);
  EXPECT_EQ(count(unchanged.removed_mask), 0);
  const ChangeResult added = detect(see(scene_with({upright})), see_from_wrong_pose(scene_with({upright, flat})));
  EXPECT_GT(count(added.novel_mask), 300);
  const ChangeResult removed = detect(see(scene_with({upright, flat})), see_from_wrong_pose(scene_with({upright})));
  EXPECT_GT(count(removed.removed_mask), 300);
}

TEST(DepthChanges, ThinThingsAreFoundDespiteNoise) {
  const Box thin{{0, 0, 0.0075}, {0.1, 0.04, 0.0075}};  // 15 mm high, 1.2 m away
  const ChangeResult added =
      detect(see_with_noise(table(), usual_pose(), 3), see_with_noise(scene_with({thin}), usual_pose(), 4));
  const ChangeResult removed =
      detect(see_with_noise(scene_with({thin}), usual_pose(), 5), see_with_noise(table(), usual_pose(), 6));
  EXPECT_GT(count_at(thin, added.novel_in_world, 0.01), 100);
  EXPECT_GT(count_at(thin, removed.removed_in_world, 0.01), 100);
}

// Flat on the table: 9 mm high, and as wide as five pixels.
const Box kPen{{0, 0, 0.0045}, {0.08, 0.011, 0.0045}};

/// With noise, and the box in another colour than the table.
PreparedView see_colored(const Scene& scene, const Rigid3& world_from_camera, std::uint64_t seed) {
  PreparedView view = see_with_noise(scene, world_from_camera, seed);
  const Image<float> depth_m = render_depth(scene, view.frame.camera, world_from_camera);
  const Image<float> table_m = render_depth(table(), view.frame.camera, world_from_camera);
  for (std::size_t i = 0; i < depth_m.size(); ++i)
    if (depth_m[i] != table_m[i]) view.frame.color[i] = {30, 30, 120};
  return view;
}

TEST(DepthChanges, ColourTellsThinThingsFromNoise) {
  const auto see_bare = [](std::uint64_t seed) { return see_colored(table(), usual_pose(), seed); };
  const auto see_pen = [](std::uint64_t seed) { return see_colored(scene_with({kPen}), usual_pose(), seed); };
  const ChangeResult added = detect(see_bare(1), see_pen(2));
  EXPECT_GT(count(added.novel_mask), 60);
  EXPECT_GT(count_at(kPen, added.novel_in_world, 0.012), static_cast<int>(added.novel_in_world.size()) * 9 / 10);
  const ChangeResult removed = detect(see_pen(3), see_bare(4));
  EXPECT_GT(count(removed.removed_mask), 60);
  EXPECT_EQ(count(removed.novel_mask), 0);
  const auto see_pale_pen = [](std::uint64_t seed) { return see_with_noise(scene_with({kPen}), usual_pose(), seed); };
  EXPECT_EQ(count(detect(see_bare(1), see_pale_pen(2)).novel_mask), 0);
}

TEST(DepthChanges, ColourAloneIsNoChange) {
  const PreparedView before = see_colored(table(), usual_pose(), 5);
  PreparedView after = see_colored(table(), usual_pose(), 6);
  for (int v = 110; v < 120; ++v)
    for (int u = 100; u < 200; ++u) after.frame.color(u, v) = {30, 30, 120};  // A print, or a hard shadow.
  const ChangeResult changes = detect(before, after);
  EXPECT_EQ(count(changes.novel_mask), 0);
  EXPECT_EQ(count(changes.removed_mask), 0);
}

TEST(DepthChanges, WhatIsHiddenIsKept) {
  const Box front{{0, -0.3, 0.12}, {0.2, 0.02, 0.12}};
  const Rigid3 low = look_at({0, -0.9, 0.3}, {0, 0, 0.05});
  const ChangeResult changes = detect(see(scene_with({kCarton})), see(scene_with({front}), low));
  EXPECT_FALSE(detect(see(scene_with({kCarton})), see(scene_with({}), low)).removed_in_world.points.empty());
  for (const Eigen::Vector3f& p : changes.removed_in_world.points)
    EXPECT_GT(p.z(), 0.1F) << "only the top of the box can be seen past";
}

TEST(DepthChanges, NoReturnIsNoEvidence) {
  const PreparedView before = see(scene_with({kCarton}));
  RgbdFrame frame = render(table(), small_camera(), usual_pose());
  for (std::size_t i = 0; i < frame.depth_m.size(); ++i)
    if (frame.depth_m[i] != before.frame.depth_m[i]) frame.depth_m[i] = kNoDepth;
  const ChangeResult changes = detect(before, prepare_view(std::move(frame)));
  EXPECT_TRUE(changes.removed_in_world.empty());
  EXPECT_TRUE(changes.novel_in_world.empty());
}

TEST(DepthChanges, SmallRegionsAreNoise) {
  const PreparedView before = see(table());
  RgbdFrame frame = before.frame;
  for (int v = 100; v < 104; ++v)
    for (int u = 100; u < 104; ++u) frame.depth_m(u, v) -= 0.3F;
  const PreparedView after = prepare_view(std::move(frame));
  EXPECT_EQ(count(detect(before, after).novel_mask), 0);
  const PreparedView* earlier[] = {&before};
  EXPECT_GT(count(find_depth_changes(after, earlier, {.min_region_px = 4}, 1).novel), 3);
}

// Depth registered to colours of twice as many rows repeats each measurement.
TEST(DepthChanges, NoiseIsNoiseInLargeImages) {
  const auto enlarge = [](const RgbdFrame& frame, int times) {
    RgbdFrame large = frame;
    const Camera& camera = frame.camera;
    large.camera = {camera.width * times, camera.height * times,           camera.fx * times,
                    camera.fy * times,    (camera.cx + 0.5) * times - 0.5, (camera.cy + 0.5) * times - 0.5};
    large.depth_m = Image<float>(large.camera.width, large.camera.height);
    large.color = Image<Rgb8>(large.camera.width, large.camera.height);
    for (int v = 0; v < large.camera.height; ++v)
      for (int u = 0; u < large.camera.width; ++u) {
        large.depth_m(u, v) = frame.depth_m(u / times, v / times);
        large.color(u, v) = frame.color(u / times, v / times);
      }
    return large;
  };
  const RgbdFrame before = see(table()).frame;
  RgbdFrame after = before;
  for (int v = 100; v < 103; ++v)
    for (int u = 100; u < 103; ++u) after.depth_m(u, v) -= 0.3F;
  for (const int times : {2, 4})  // Up to 1280 x 960.
    EXPECT_EQ(count(detect(prepare_view(enlarge(before, times)), prepare_view(enlarge(after, times))).novel_mask), 0)
        << times;
}

// The contours of stereo waver from view to view, also before a still camera.
TEST(DepthChanges, WaveringContoursAreNoChange) {
  const RgbdFrame exact = see(scene_with({kCarton})).frame;
  const auto waver = [&](int phase) {
    RgbdFrame frame = exact;
    for (int v = 0; v < frame.depth_m.height(); ++v) {
      const int shift = static_cast<int>(std::lround(2.0 * std::sin(0.15 * v + 2.1 * phase)));
      for (int u = 0; u < frame.depth_m.width(); ++u)
        frame.depth_m(u, v) = exact.depth_m(std::clamp(u + shift, 0, frame.depth_m.width() - 1), v);
    }
    return prepare_view(std::move(frame));
  };
  const ChangeResult changes = detect(waver(0), waver(1));
  EXPECT_EQ(count(changes.novel_mask), 0);
  EXPECT_EQ(count(changes.removed_mask), 0);
}

TEST(DepthChanges, TheNewestViewDecidesWhatIsThere) {
  // The box left between the first two views, and the second one was not cleared of anything. For the third view
  // nothing is removed any more where the second saw the table.
  const PreparedView first = see(scene_with({kCarton}));
  const PreparedView second = see(table());
  const PreparedView* earlier[] = {&first, &second};
  const DepthChanges changes = find_depth_changes(see(table()), earlier, {}, 1);
  EXPECT_EQ(count(changes.removed), 0);
  EXPECT_TRUE(changes.gone_pixels[0].empty());
  const PreparedView* alone[] = {&first};
  EXPECT_GT(count(find_depth_changes(see(table()), alone, {}, 1).removed), 1500);
}

// The view between shows the table behind the box, and nothing of the box itself.
TEST(DepthChanges, AViewOfWhatIsBehindAThingDecidesNothing) {
  const PreparedView first = see(scene_with({kCarton})), now = see(scene_with({}));
  const PreparedView behind = see(scene_with({kCarton}), look_at({0, 0.35, 0.9}, {0, 0.6, 0}));
  ASSERT_EQ(count_at(kCarton, world_cloud(behind), 0.002), 0);
  const PreparedView* one[] = {&first};
  const PreparedView* two[] = {&first, &behind};
  const int num_removed = count(find_depth_changes(now, one, {}, 1).removed);
  EXPECT_GT(num_removed, 2000);
  EXPECT_GT(count(find_depth_changes(now, two, {}, 1).removed), 0.98 * num_removed);
}

TEST(DepthChanges, AWrongPoseIsSuspect) {
  const PreparedView before = see(scene_with({kCarton}));
  PreparedView after = see(scene_with({kCarton}));
  after.frame.world_from_camera.translation.z() += 0.3;
  const ChangeResult changes = detect(before, after);
  EXPECT_TRUE(changes.pose_suspect);
  EXPECT_TRUE(changes.removed_in_world.empty());
  EXPECT_EQ(count(changes.removed_mask), 0);
}

TEST(DepthChanges, WithoutEarlierViewsThereAreNone) {
  const PreparedView view = see(table());
  const ChangeResult changes = detect_changes(world_cloud(view), view, {.test = DepthTestOptions{}});
  EXPECT_EQ(count(changes.novel_mask), 0);
  EXPECT_EQ(count(changes.removed_mask), 0);
}

TEST(DepthChanges, SerialIsParallel) {
  const PreparedView before = see(scene_with({kCarton}));
  const PreparedView after = see(scene_with({{{0.2, 0.1, 0.06}, {0.05, 0.05, 0.06}}}), kBeside);
  const ChangeResult serial = detect(before, after);
  const ChangeResult parallel = detect(before, after, 3);
  EXPECT_FALSE(serial.removed_in_world.empty());
  EXPECT_FALSE(serial.novel_in_world.empty());
  EXPECT_EQ(parallel.removed_in_world.points, serial.removed_in_world.points);
  EXPECT_EQ(parallel.novel_in_world.points, serial.novel_in_world.points);
  EXPECT_EQ(parallel.novel_mask, serial.novel_mask);
  EXPECT_EQ(parallel.removed_mask, serial.removed_mask);
}

}  // namespace
}  // namespace resight
