// SPDX-License-Identifier: Apache-2.0
#include "resight/training/training.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <set>
#include <stdexcept>

#include "resight/core/random.hpp"

namespace resight {
namespace {

using testing::HasSubstr;

const Eigen::Vector3f kSize(0.12F, 0.08F, 0.16F);

// A closed box around the origin with random blotches on each face: one texture, faces side by side.
TriangleMesh make_printed_box(const Eigen::Vector3f& size = kSize) {
  constexpr int kCell = 256;
  TriangleMesh box;
  Rng rng(1);
  box.texture = Image<Rgb8>(6 * kCell, kCell, Rgb8{235, 230, 220});
  for (int blotch = 0; blotch < 900; ++blotch) {
    const int u0 = static_cast<int>(rng.below(6 * kCell));
    const int v0 = static_cast<int>(rng.below(kCell));
    const int radius = 3 + static_cast<int>(rng.below(12));
    const Rgb8 color{static_cast<std::uint8_t>(rng.below(256)), static_cast<std::uint8_t>(rng.below(256)),
                     static_cast<std::uint8_t>(rng.below(256))};
    for (int v = v0 - radius; v <= v0 + radius; ++v)
      for (int u = u0 - radius; u <= u0 + radius; ++u)
        if (box.texture.contains(u, v) && (u - u0) * (u - u0) + (v - v0) * (v - v0) <= radius * radius)
          box.texture(u, v) = color;
  }
  for (int axis = 0; axis < 3; ++axis)
    for (int side = 0; side < 2; ++side) {
      const float sign = side == 0 ? -1.0F : 1.0F;
      const int u_axis = (axis + (side == 0 ? 2 : 1)) % 3;
      const int v_axis = (axis + (side == 0 ? 1 : 2)) % 3;
      const int first = static_cast<int>(box.vertices.size());
      for (int corner = 0; corner < 4; ++corner) {
        const bool right = corner == 1 || corner == 2;
        const bool top = corner >= 2;
        Eigen::Vector3f p;
        p[axis] = sign;
        p[u_axis] = right ? 1.0F : -1.0F;
        p[v_axis] = top ? 1.0F : -1.0F;
        box.vertices.emplace_back(0.5F * p.cwiseProduct(size));
        const float cell = static_cast<float>(2 * axis + side) + (right ? 0.99F : 0.01F);
        box.uvs.emplace_back(cell / 6.0F, top ? 0.01F : 0.99F);
      }
      box.faces.push_back({first, first + 1, first + 2});
      box.faces.push_back({first, first + 2, first + 3});
    }
  return box;
}

// Signed distance to the box, negative inside.
float box_distance(const Eigen::Vector3f& p) {
  const Eigen::Vector3f q = p.cwiseAbs() - 0.5F * kSize;
  return q.cwiseMax(0.0F).norm() + std::min(q.maxCoeff(), 0.0F);
}

// Outward normal of the face nearest to p.
Eigen::Vector3f box_normal(const Eigen::Vector3f& p) {
  int axis = 0;
  (p.cwiseAbs() - 0.5F * kSize).maxCoeff(&axis);
  Eigen::Vector3f n = Eigen::Vector3f::Zero();
  n[axis] = p[axis] < 0 ? -1.0F : 1.0F;
  return n;
}

TrainOptions quick_training_options() {
  TrainOptions options;
  options.turntable.step_deg = 90;
  return options;
}

// Rendered once: 12 views from above (30 deg apart), then 12 from below.
const std::vector<TrainingView>& printed_box_views() {
  static const std::vector<TrainingView> views = [] {
    TurntableOptions turntable;
    turntable.step_deg = 30;
    return render_turntable(make_printed_box(), turntable);
  }();
  return views;
}

void expect_surface_on_box(const ObjectModel& model, float tolerance_m) {
  ASSERT_GT(model.surface.size(), 1000U);
  ASSERT_TRUE(model.surface.has_normals() && model.surface.has_colors());
  int agreeing = 0;
  std::set<int> faces;
  for (std::size_t i = 0; i < model.surface.size(); ++i) {
    const Eigen::Vector3f& p = model.surface.points[i];
    ASSERT_LT(std::abs(box_distance(p)), tolerance_m) << p.transpose();
    ASSERT_NEAR(model.surface.normals[i].norm(), 1, 1e-4);
    const Eigen::Vector3f n = box_normal(p);
    agreeing += model.surface.normals[i].dot(n) > 0.9F ? 1 : 0;
    if (box_distance(p) > -0.0015F) faces.insert(static_cast<int>(n.dot(Eigen::Vector3f(1, 2, 3))));
  }
  EXPECT_GT(agreeing, 0.9 * static_cast<double>(model.surface.size()));
  EXPECT_EQ(faces.size(), 6U);  // all six sides are present
}

double box_area() { return 2.0 * (kSize.x() * kSize.y() + kSize.y() * kSize.z() + kSize.z() * kSize.x()); }

void expect_features_on_box(const ObjectModel& model) {
  ASSERT_GT(model.sift.size(), 100U);
  ASSERT_GT(model.shot.size(), 100U);
  EXPECT_EQ(model.sift.dimension, 128);
  EXPECT_EQ(model.shot.dimension, 352);
  for (const FeatureSet& set : {decode(model.sift), decode(model.shot)})
    for (std::size_t i = 0; i < set.size(); ++i) {
      ASSERT_LT(std::abs(box_distance(set.points[i])), 0.004F);
      ASSERT_NEAR(set.normals[i].norm(), 1, 1e-4);
      const auto row = set.descriptor(i);
      ASSERT_NEAR(Eigen::Map<const Eigen::VectorXf>(row.data(), set.dimension).norm(), 1, 1e-3);
    }
}

TEST(TrainObjectFromMesh, GivesACompleteSurfaceAndFeaturesOnIt) {
  const Result<ObjectModel> model = train_object("box", make_printed_box(), quick_training_options());
  ASSERT_TRUE(model.ok()) << model.error().message;
  EXPECT_EQ(model->name, "box");
  expect_surface_on_box(*model, 0.0015F);
  expect_features_on_box(*model);
  EXPECT_GT(static_cast<double>(model->surface.size()), 0.95 * box_area() / (0.003 * 0.003));
  EXPECT_LT(model->center.norm(), 0.001F);
  EXPECT_NEAR(model->diameter_m, kSize.norm(), 1e-5);
}

TEST(TrainObjectFromViews, GivesTheSurfaceThatTheViewsSee) {
  const Result<ObjectModel> model = train_object("box", printed_box_views());
  ASSERT_TRUE(model.ok()) << model.error().message;
  expect_surface_on_box(*model, 0.0015F);  // the views have no noise
  expect_features_on_box(*model);
  EXPECT_GT(static_cast<double>(model->surface.size()), 0.85 * box_area() / (0.003 * 0.003));
  EXPECT_LT(model->center.norm(), 0.005F);
  EXPECT_NEAR(model->diameter_m, kSize.norm(), 0.01);
}

// A feature of one view must find its own physical point in an adjacent view. Both are in the object frame.
TEST(TrainFeatures, KeypointsOfTwoViewsLandOnTheSamePoint) {
  TurntableOptions turntable;
  turntable.both_sides = false;
  const std::vector<TrainingView> views = render_turntable(make_printed_box(), turntable);
  ASSERT_EQ(views.size(), 24U);
  const TrainOptions options;
  const Result<ObjectFeatures> a = train_features("a", std::span(views).subspan(0, 1), options);
  const Result<ObjectFeatures> b = train_features("b", std::span(views).subspan(1, 1), options);
  ASSERT_TRUE(a.ok() && b.ok());
  int matched = 0;
  int same_place = 0;
  for (std::size_t i = 0; i < a->sift.size(); ++i) {
    float best = std::numeric_limits<float>::max();
    std::size_t match = 0;
    const Eigen::Map<const Eigen::VectorXf> query(a->sift.descriptor(i).data(), 128);
    for (std::size_t j = 0; j < b->sift.size(); ++j) {
      const float d = (query - Eigen::Map<const Eigen::VectorXf>(b->sift.descriptor(j).data(), 128)).squaredNorm();
      if (d < best) {
        best = d;
        match = j;
      }
    }
    if (best > 0.1F) continue;  // visible in one view only
    ++matched;
    same_place += (a->sift.points[i] - b->sift.points[match]).norm() < 0.003F ? 1 : 0;
  }
  ASSERT_GT(matched, 30);
  EXPECT_GT(same_place, 0.9 * matched);
}

void expect_same_bytes(const ObjectModel& a, const ObjectModel& b) {
  EXPECT_EQ(a.surface.points, b.surface.points);
  EXPECT_EQ(a.surface.normals, b.surface.normals);
  EXPECT_EQ(a.surface.colors, b.surface.colors);
  EXPECT_EQ(a.sift.points, b.sift.points);
  EXPECT_EQ(a.sift.codes, b.sift.codes);
  EXPECT_EQ(a.shot.points, b.shot.points);
  EXPECT_EQ(a.shot.normals, b.shot.normals);
  EXPECT_EQ(a.shot.codes, b.shot.codes);
  EXPECT_EQ(a.center, b.center);
  EXPECT_EQ(a.diameter_m, b.diameter_m);
}

TEST(TrainObject, SameBytesAgainAndForAnyNumberOfThreads) {
  TrainOptions options = quick_training_options();
  options.turntable.both_sides = false;
  options.turntable.sensor_noise = true;
  const Result<ObjectModel> serial = train_object("box", make_printed_box(), options);
  ASSERT_TRUE(serial.ok());
  expect_same_bytes(*train_object("box", make_printed_box(), options), *serial);
  options.num_threads = 2;
  expect_same_bytes(*train_object("box", make_printed_box(), options), *serial);
  const auto views = std::span(printed_box_views()).first(5);
  const Result<ObjectModel> parallel = train_object("box", views, options);
  options.num_threads = 1;
  expect_same_bytes(*train_object("box", views, options), *parallel);
}

TEST(TrainObject, MergingLeavesFewerFeatures) {
  const auto views = std::span(printed_box_views()).first(12);
  TrainOptions options;
  const Result<ObjectFeatures> merged = train_features("box", views, options);
  options.sift_merging = {};
  options.shot_merging = {};
  const Result<ObjectFeatures> all = train_features("box", views, options);
  ASSERT_TRUE(merged.ok() && all.ok());
  EXPECT_LT(merged->sift.size(), all->sift.size());
  EXPECT_LT(static_cast<double>(merged->shot.size()), 0.9 * static_cast<double>(all->shot.size()));
  EXPECT_GT(merged->shot.size(), 100U);
}

TEST(TrainObject, AnObjectWithOneKindOfFeatureIsTrained) {
  TriangleMesh plain = make_printed_box();
  plain.texture = Image<Rgb8>(4, 4, Rgb8{200, 40, 40});
  TrainOptions options = quick_training_options();
  options.turntable.both_sides = false;
  const Result<ObjectModel> model = train_object("plain box", plain, options);
  ASSERT_TRUE(model.ok()) << model.error().message;
  EXPECT_GT(model->shot.size(), 100U);
}

TEST(TrainObject, AnObjectWithoutAnyFeatureIsAnError) {
  TriangleMesh plain = make_printed_box();
  plain.texture = Image<Rgb8>(4, 4, Rgb8{200, 40, 40});
  TrainOptions options = quick_training_options();
  options.turntable.both_sides = false;
  options.sift.contrast_threshold = 1e6;
  options.shot.min_neighbors = 1000000;
  const Result<ObjectModel> model = train_object("plain box", plain, options);
  ASSERT_FALSE(model.ok());
  EXPECT_THAT(model.error().message, HasSubstr("'plain box': no SIFT and no SHOT feature"));
}

TEST(TrainObjectFromViews, EachBadInputHasItsLine) {
  struct Case {
    const char* expected;
    std::function<void(std::vector<TrainingView>&)> spoil;
  };
  const std::vector<TrainingView> good(printed_box_views().begin(), printed_box_views().begin() + 2);
  const std::vector<Case> cases{
      {"no training views", [](auto& v) { v.clear(); }},
      {"masks of all training views are empty",
       [](auto& v) {
         for (auto& x : v) std::ranges::fill(x.mask.data(), std::uint8_t{0});
       }},
      {"mask is 10x10, but the image is", [](auto& v) { v[1].mask = Image<std::uint8_t>(10, 10, 1); }},
      {"colour image", [](auto& v) { v[0].frame.color = Image<Rgb8>(3, 3); }},
      {"not a rigid motion", [](auto& v) { v[0].frame.world_from_camera.rotation *= 1.2; }},
      {"not a rigid motion", [](auto& v) { v[0].frame.world_from_camera.translation.x() = std::nan(""); }},
      {"zero, negative or infinite", [](auto& v) { v[1].frame.depth_m[5] = 0; }},
      {"has depth",
       [](auto& v) {
         for (auto& x : v) std::ranges::fill(x.frame.depth_m.data(), std::numeric_limits<float>::quiet_NaN());
       }},
  };
  for (const Case& c : cases) {
    std::vector<TrainingView> views = good;
    c.spoil(views);
    const Result<ObjectModel> model = train_object("box", views, quick_training_options());
    ASSERT_FALSE(model.ok()) << c.expected;
    EXPECT_THAT(model.error().message, HasSubstr(c.expected));
    EXPECT_THAT(model.error().message, HasSubstr("model 'box'"));
  }
  std::vector<TrainingView> one_empty = good;
  std::ranges::fill(one_empty[0].mask.data(), std::uint8_t{0});  // as if the object left the image
  const Result<ObjectModel> model = train_object("box", one_empty, quick_training_options());
  ASSERT_TRUE(model.ok());
  EXPECT_EQ(model->sift.type, FeatureType::kSift);
  EXPECT_EQ(model->shot.type, FeatureType::kShot);
}

TEST(TrainObjectFromMesh, EachBadInputHasItsLine) {
  const auto message = [](const TriangleMesh& mesh) {
    const Result<ObjectModel> model = train_object("box", mesh, quick_training_options());
    return model.ok() ? "trained" : model.error().message;
  };
  EXPECT_THAT(message({}), HasSubstr("model 'box': the mesh has no triangles"));
  EXPECT_THAT(message(make_printed_box(1000.0F * kSize)),
              HasSubstr("215.407 m across (expected 0.005 to 5): it looks as if it were in millimetres"));
  EXPECT_THAT(message(make_printed_box(0.01F * kSize)), HasSubstr("this looks like another unit"));
  TriangleMesh bad_index = make_printed_box();
  bad_index.faces[3][1] = 24;
  EXPECT_THAT(message(bad_index), HasSubstr("vertex 24, but the mesh has 24 vertices"));
  TriangleMesh bad_point = make_printed_box();
  bad_point.vertices[7].z() = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THAT(message(bad_point), HasSubstr("vertex 7 of the mesh is not finite"));
  TriangleMesh lines;
  lines.vertices = {{0, 0, 0}, {0.1F, 0, 0}};
  lines.faces = {{0, 1, 1}};
  EXPECT_THAT(message(lines), HasSubstr("no area"));
}

TEST(TrainObjectFromMesh, AVertexThatNoTriangleUsesDoesNotCount) {
  TriangleMesh mesh = make_printed_box();
  mesh.vertices.emplace_back(100.0F, 0.0F, 0.0F);
  mesh.uvs.emplace_back(0.0F, 0.0F);
  const Result<PointCloud> surface = train_surface("box", mesh);
  ASSERT_TRUE(surface.ok()) << surface.error().message;
  EXPECT_NEAR(diameter(surface->points), kSize.norm(), 0.01);
}

TEST(TrainObjectFromMesh, ATriangleWithoutAreaDoesNotCount) {
  TriangleMesh mesh = make_printed_box();
  mesh.vertices.emplace_back(0.5F, 0.0F, 0.0F);
  mesh.uvs.emplace_back(0.0F, 0.0F);
  mesh.faces.push_back({0, 0, 24});
  const Result<ObjectModel> model = train_object("box", mesh, quick_training_options());
  ASSERT_TRUE(model.ok()) << model.error().message;
  EXPECT_FLOAT_EQ(model->diameter_m, kSize.norm());
  mesh.vertices.back().x() = 100;
  EXPECT_TRUE(check_training_input("box", mesh).ok());
}

TEST(TrainOptions, RefusesNonsense) {
  const auto check = [](auto&& spoil) {
    TrainOptions options;
    spoil(options);
    options.check();
  };
  EXPECT_NO_THROW(check([](TrainOptions&) {}));
  EXPECT_THROW(check([](TrainOptions& o) { o.surface_voxel_m = 0; }), std::invalid_argument);
  EXPECT_THROW(check([](TrainOptions& o) { o.num_threads = 0; }), std::invalid_argument);
  EXPECT_THROW(check([](TrainOptions& o) { o.min_edge_distance_px = -1; }), std::invalid_argument);
  EXPECT_THROW(check([](TrainOptions& o) { o.sift_merging.max_distance_m = std::nan(""); }), std::invalid_argument);
  EXPECT_THROW(check([](TrainOptions& o) { o.shot.support_radius_m = -1; }), std::invalid_argument);
  EXPECT_THROW(check([](TrainOptions& o) { o.symmetry.max_distance_m = 0; }), std::invalid_argument);
  EXPECT_THROW(check([](TrainOptions& o) { o.turntable.step_deg = 0; }), std::invalid_argument);
}

TEST(TrainOptions, HashCoversEveryFieldThatChangesTheResult) {
  const std::vector<std::function<void(TrainOptions&)>> changes{
      [](TrainOptions&) {},
      [](TrainOptions& o) { o.sift.contrast_threshold = 0.04; },
      [](TrainOptions& o) { o.sift.edge_threshold = 12; },
      [](TrainOptions& o) { o.sift.num_octave_layers = 4; },
      [](TrainOptions& o) { o.sift.root_sift = !o.sift.root_sift; },
      [](TrainOptions& o) { o.shot.keypoint_spacing_m = 0.02; },
      [](TrainOptions& o) { o.shot.support_radius_m = 0.03; },
      [](TrainOptions& o) { o.shot.support_voxel_m = 0.004; },
      [](TrainOptions& o) { o.shot.min_surface_variation = 0.02; },
      [](TrainOptions& o) { o.shot.max_keypoint_depth_m = 1.8; },
      [](TrainOptions& o) { o.shot.min_neighbors = 11; },
      [](TrainOptions& o) { o.surface_voxel_m = 0.004; },
      [](TrainOptions& o) { o.min_edge_distance_px = 3; },
      [](TrainOptions& o) { o.turntable.step_deg = 10; },
      [](TrainOptions& o) { o.turntable.elevation_deg = 20; },
      [](TrainOptions& o) { o.turntable.both_sides = false; },
      [](TrainOptions& o) { o.turntable.distance_m = 1; },
      [](TrainOptions& o) { o.turntable.sensor_noise = true; },
      [](TrainOptions& o) { o.turntable.seed = 2; },
      [](TrainOptions& o) { o.sift_merging.max_distance_m = 0.004; },
      [](TrainOptions& o) { o.sift_merging.max_descriptor_distance = 0.123; },
      [](TrainOptions& o) { o.shot_merging.max_distance_m = 0.004; },
      [](TrainOptions& o) { o.shot_merging.max_descriptor_distance = 0.123; },
      [](TrainOptions& o) { o.find_symmetries = false; },
      [](TrainOptions& o) { o.symmetry.min_agreement = 0.96; },
      [](TrainOptions& o) { o.symmetry.min_close_agreement = 0.8; },
      [](TrainOptions& o) { o.symmetry.max_distance_m = 0.002; },
      [](TrainOptions& o) { o.symmetry.max_distance_share = 0.02; },
      [](TrainOptions& o) { o.symmetry.max_normal_angle_rad = 0.6; },
      [](TrainOptions& o) { o.symmetry.blur_share = 0.03; },
      [](TrainOptions& o) { o.symmetry.max_brightness_difference = 0.1; },
      [](TrainOptions& o) { o.symmetry.max_chroma_difference = 0.1; },
      [](TrainOptions& o) { o.symmetry.num_samples = 500; },
  };
  std::set<std::uint64_t> hashes;
  for (const auto& change : changes) {
    TrainOptions options;
    change(options);
    hashes.insert(options.hash());
    options.num_threads = 7;
    options.turntable.num_threads = 7;
    options.shot.num_threads = 7;
    options.symmetry.num_threads = 7;
    hashes.insert(options.hash());  // numbers of threads do not change the hash
  }
  EXPECT_EQ(hashes.size(), changes.size());
}

}  // namespace
}  // namespace resight
