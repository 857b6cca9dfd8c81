// SPDX-License-Identifier: Apache-2.0
#include "resight/shape_search/shape_search.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "resight/verification/testing/analytic_scene.hpp"

namespace resight {
namespace {

using namespace analytic;

// Three untextured objects, which give no keypoints by their colours; the third stands on no table.
struct PlainThings {
  Solid box{Shape::kBox, {0.12, 0.07, 0.09}, plain({200, 120, 60}), on_table(-0.12, 0.02, 0.045, 0.5)};
  Solid can{Shape::kCylinder, {0.08, 0.08, 0.1}, plain({60, 110, 190}), on_table(0.12, 0, 0.05)};
  Solid absent{Shape::kSphere, {0.09, 0.09, 0.09}, plain({60, 190, 80}), on_table(0, 0.1, 0.045)};
  ModelLibrary library = make_library();
  PreparedView view = prepare_view(render({.solids = {box, can}}, circle_of_cameras(3)[1]).frame);
  SearchView searched{view, {}, library.largest_diameter_m()};

  ModelLibrary make_library() const {
    ModelLibrary made{.objects = {make_model("box", box), make_model("can", can), make_model("ball", absent)}};
    made.objects[1].symmetries.continuous.push_back({Eigen::Vector3d::UnitZ(), Eigen::Vector3d::Zero()});
    return made;
  }
};

const ShapeCandidate* best_of(const std::vector<ShapeCandidate>& found, int object) {
  for (const ShapeCandidate& c : found)
    if (c.object == object) return &c;
  return nullptr;
}

TEST(ShapeSearch, FindsUntexturedObjectsAndNoOther) {
  const PlainThings c;
  const auto found = ShapeSearch(c.library, {}).search(c.searched);
  int object = 0;
  for (const Solid* solid : {&c.box, &c.can}) {
    const ShapeCandidate* best = best_of(found, object);
    ASSERT_NE(best, nullptr) << object;
    const Rigid3 pose = c.view.frame.world_from_camera * best->camera_from_object;
    EXPECT_LT((pose.translation - solid->world_from_object.translation).norm(), 0.004) << object;
    // The box is symmetric under half a turn, the can under any rotation about its axis; the upright axis must be
    // right.
    EXPECT_GT(std::abs(pose.rotation(2, 2)), 0.998) << object;
    EXPECT_GT(best->quality, 0.6);
    ++object;
  }
  EXPECT_EQ(best_of(found, 2), nullptr);
}

TEST(ShapeSearch, FindsEachOfSixEqualThings) {
  World world;
  for (int i = 0; i < 6; ++i)
    world.solids.push_back({Shape::kBox,
                            {0.12, 0.07, 0.09},
                            plain({200, 120, 60}),
                            on_table(0.2 * (i % 3 - 1), 0.2 * (i / 3) - 0.1, 0.045, 1.1 * i)});
  const ModelLibrary library{.objects = {make_model("box", world.solids[0])}};
  const PreparedView view = prepare_view(render(world, circle_of_cameras(3)[1]).frame);
  const ShapeSearchOptions options;
  const auto found = ShapeSearch(library, options).search(SearchView(view, options, library.largest_diameter_m()));
  EXPECT_LE(static_cast<int>(found.size()), 3 * options.max_hypotheses);
  for (const Solid& solid : world.solids)
    EXPECT_TRUE(std::ranges::any_of(found, [&](const ShapeCandidate& c) {
      const Rigid3 pose = view.frame.world_from_camera * c.camera_from_object;
      return (pose.translation - solid.world_from_object.translation).norm() < 0.006;
    })) << solid.world_from_object.translation.transpose();
}

TEST(ShapeSearch, WhatIsExplainedIsNotSearched) {
  const PlainThings c;
  const Camera& camera = c.view.frame.camera;
  Image<std::uint8_t> explained(camera.width, camera.height, 0);
  const Eigen::Vector2d center =
      camera.project(c.view.frame.world_from_camera.inverse() * c.box.world_from_object.translation);
  for (int v = 0; v < camera.height; ++v)
    for (int u = 0; u < camera.width; ++u)
      if ((Eigen::Vector2d(u, v) - center).norm() < 0.09 * camera.fx / 0.8) explained(u, v) = 255;
  const SearchView but_the_box(c.view, {}, c.library.largest_diameter_m(), explained);
  EXPECT_LT(but_the_box.searched_share, 0.9);
  EXPECT_LT(but_the_box.samples.points.size(), c.searched.samples.points.size());
  const auto found = ShapeSearch(c.library, {}).search(but_the_box);
  EXPECT_EQ(best_of(found, 0), nullptr);
  EXPECT_NE(best_of(found, 1), nullptr);
  const Image<std::uint8_t> all(camera.width, camera.height, 255);
  EXPECT_TRUE(ShapeSearch(c.library, {}).search(SearchView(c.view, {}, 0.2F, all)).empty());
}

// Shape finds the can, and its texture the rotation: a pair of points alone hardly ever gives both.
TEST(ShapeSearch, RotatesATexturedCanToTheBestTexture) {
  const Paint paint = [](const Eigen::Vector3d& p) {
    const double angle = std::atan2(p.y(), p.x());
    return angle < -1.5 ? Rgb8{200, 40, 40} : angle < 0.3 ? Rgb8{230, 220, 200} : Rgb8{50, 80, 180};
  };
  const Solid can{Shape::kCylinder, {0.08, 0.08, 0.12}, paint, on_table(0.05, 0, 0.06, 2.2)};
  ModelLibrary library{.objects = {make_model("can", can)}};
  library.objects[0].shape_symmetries.continuous.push_back({.direction = Eigen::Vector3d::UnitZ()});
  const PreparedView view = prepare_view(render({.solids = {can}}, circle_of_cameras(3)[1]).frame);
  const auto finds = [&](std::optional<double> symmetry_step_rad) {
    ShapeSearchOptions options;
    options.max_seeds = 3;  // With few pairs of points, the rotation is right by chance only.
    options.max_entries = 4;
    const auto found = ShapeSearch(library, options, {.symmetry_step_rad = symmetry_step_rad})
                           .search(SearchView(view, options, library.largest_diameter_m()));
    if (found.empty()) return false;
    const Rigid3 pose = view.frame.world_from_camera * found[0].camera_from_object;
    return (pose.translation - can.world_from_object.translation).norm() < 0.006 &&
           rotation_angle_rad(pose.rotation, can.world_from_object.rotation) < 0.2;
  };
  EXPECT_TRUE(finds(0.1745));
  EXPECT_FALSE(finds(std::nullopt));
}

TEST(ShapeSearch, TheSameOnAnyNumberOfThreads) {
  PlainThings c;
  c.library.objects[0].shape_symmetries.continuous.push_back(
      {.direction = Eigen::Vector3d::UnitZ()});  // So that it is rotated.
  ShapeSearchOptions options;
  const MatchCriteria criteria{.symmetry_step_rad = 0.1745};
  options.max_seeds = 300;
  const auto serial = ShapeSearch(c.library, options, criteria).search(c.searched);
  options.num_threads = 4;
  const auto parallel = ShapeSearch(c.library, options, criteria).search(c.searched);
  ASSERT_FALSE(serial.empty());
  ASSERT_EQ(serial.size(), parallel.size());
  for (std::size_t i = 0; i < serial.size(); ++i) {
    EXPECT_EQ(serial[i].object, parallel[i].object);
    EXPECT_EQ(serial[i].quality, parallel[i].quality);
    EXPECT_EQ(serial[i].camera_from_object.matrix(), parallel[i].camera_from_object.matrix());
  }
}

TEST(ShapeSearch, NothingInAnEmptyViewOrForNoModels) {
  const PlainThings c;
  RgbdFrame frame = c.view.frame;
  for (float& depth : frame.depth_m.data()) depth = std::numeric_limits<float>::quiet_NaN();
  const PreparedView view = prepare_view(frame);
  EXPECT_TRUE(ShapeSearch(c.library, {}).search(SearchView(view, {}, c.library.largest_diameter_m())).empty());
  EXPECT_TRUE(ShapeSearch(ModelLibrary{}, {}).search(c.searched).empty());
  ModelLibrary bare = c.library;
  for (ObjectModel& model : bare.objects) model.surface.normals.clear();
  EXPECT_TRUE(ShapeSearch(bare, {}).search(c.searched).empty());
}

TEST(ShapeSearch, AnAbsurdDiameterCostsNothing) {
  PlainThings c;
  c.library.objects[2].diameter_m = 1e9F;
  const auto found = ShapeSearch(c.library, {}).search(c.searched);
  EXPECT_NE(best_of(found, 0), nullptr);
  EXPECT_EQ(best_of(found, 2), nullptr);
}

TEST(ShapeSearch, AnObjectOfUnknownColoursIsFoundByItsShape) {
  PlainThings c;
  for (ObjectModel& model : c.library.objects) model.surface.colors.clear();
  const auto found = ShapeSearch(c.library, {}).search(c.searched);
  const ShapeCandidate* best = best_of(found, 0);
  ASSERT_NE(best, nullptr);
  const Rigid3 pose = c.view.frame.world_from_camera * best->camera_from_object;
  EXPECT_LT((pose.translation - c.box.world_from_object.translation).norm(), 0.004);
}

TEST(ShapeSearch, WithoutUseColorColoursSayNothing) {
  PlainThings c;
  for (ObjectModel& model : c.library.objects)
    for (std::size_t i = 0; i < model.surface.size(); ++i)
      model.surface.colors[i] = i % 2 == 0 ? Rgb8{240, 20, 20} : Rgb8{20, 20, 240};
  EXPECT_EQ(best_of(ShapeSearch(c.library, {}).search(c.searched), 0), nullptr);
  const MatchCriteria shape_only{.appearance = {.use_color = false}};
  EXPECT_NE(best_of(ShapeSearch(c.library, {}, shape_only).search(c.searched), 0), nullptr);
}

TEST(ShapeSearch, GreyViewsAreComparedByLightnessAlone) {
  const PlainThings c;
  RgbdFrame frame = c.view.frame;
  for (Rgb8& color : frame.color.data()) color = to_grey(color);
  const PreparedView view = prepare_view(frame);
  const auto found = ShapeSearch(c.library, {}).search(SearchView(view, {}, c.library.largest_diameter_m()));
  EXPECT_NE(best_of(found, 0), nullptr);
  EXPECT_NE(best_of(found, 1), nullptr);
}

// Its top is as wide as a small table, which is searched only because the library holds something as large.
TEST(ShapeSearch, FindsAnObjectWithFacesWiderThanATable) {
  const Solid crate{Shape::kBox, {0.6, 0.4, 0.3}, plain({40, 110, 190}), on_table(0, 0, 0.15, 0.3)};
  const ModelLibrary library{.objects = {make_model("crate", crate)}};
  const World world{.solids = {crate}, .table_half_m = 1.5};
  const PreparedView view = prepare_view(render(world, look_at({1.1, 0.7, 1.0}, {0, 0, 0.15})).frame);
  const auto found = ShapeSearch(library, {}).search(SearchView(view, {}, library.largest_diameter_m()));
  const ShapeCandidate* best = best_of(found, 0);
  ASSERT_NE(best, nullptr);
  const Rigid3 pose = view.frame.world_from_camera * best->camera_from_object;
  EXPECT_LT((pose.translation - crate.world_from_object.translation).norm(), 0.01);
}

TEST(ShapeSearch, TriesAPoseAsTheSearchWould) {
  const PlainThings c;
  const ShapeSearch search(c.library, {});
  const Rigid3 truth = c.view.frame.world_from_camera.inverse() * c.box.world_from_object;
  const auto right = search.score_pose(c.searched, 0, truth);
  EXPECT_GT(right.coarse.confirmed, 30);
  EXPECT_GT(right.fit.explained_share, 0.8);
  EXPECT_LT(search.score_pose(c.searched, 2, truth).fit.explained_share, 0.6);
}

TEST(ShapeSearch, ASingleViewRejectsSpuriousHypotheses) {
  PlainThings c;
  const ShapeSearch search(c.library, {});
  const std::vector<Hypothesis> hypotheses = {
      make_hypothesis(0, disturb(c.box.world_from_object, {0.004, -0.003, 0.002}, {1, 1, 0}, 0.05)),
      make_hypothesis(0, on_table(0.1, 0.3, 0.3, 1.0)), make_hypothesis(2, c.box.world_from_object)};
  const auto fits = search.score_hypotheses(c.searched, hypotheses);
  ASSERT_EQ(fits.size(), 3U);
  EXPECT_GT(fits[0].explained_share, 0.8);
  EXPECT_LT(fits[1].explained_share, 0.3);  // In the air.
  EXPECT_LT(fits[2].explained_share, 0.6);
  // Of a model without normals nothing is said.
  for (ObjectModel& model : c.library.objects) model.surface.normals.clear();
  EXPECT_EQ(ShapeSearch(c.library, {}).score_hypotheses(c.searched, hypotheses)[1].explained_share, 1.0);
}

TEST(ShapeSearchOptions, ChecksItsFields) {
  ShapeSearchOptions options;
  options.max_seeds = 0;
  EXPECT_THROW(ShapeSearch(ModelLibrary{}, options), std::invalid_argument);
  options = {};
  options.scene.spacing_m = 0;
  EXPECT_THROW(ShapeSearch(ModelLibrary{}, options), std::invalid_argument);
}

}  // namespace
}  // namespace resight
