// SPDX-License-Identifier: Apache-2.0
#include "resight/verification/cues.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <map>
#include <numbers>

#include "resight/verification/scene_association.hpp"
#include "resight/verification/testing/analytic_scene.hpp"

namespace resight {
namespace {

using namespace analytic;

const float kNan = std::numeric_limits<float>::quiet_NaN();

struct SmallCase {
  Solid solid{Shape::kBox, {0.08, 0.06, 0.1}, checks({200, 50, 40}, {40, 50, 200}, 0.03), on_table(0, 0, 0.05, 0.3)};
  Solid occluder{Shape::kBox, {0.05, 0.05, 0.06}, plain({90, 90, 90}), on_table(0.12, 0, 0.03)};
  World world{.solids = {solid, occluder}};
  std::vector<PreparedView> views = render_all(world, circle_of_cameras(3));
  std::vector<VerificationView> refs = references(views);
  VerifyOptions options;
  PreparedModel model = prepare_model(make_model("box", solid), options);
  PreparedScene scene = prepare_scene(merge(views), options);
  std::vector<DepthView> depth_views = prepare_depth_views(refs, 0, 1);
  std::vector<std::uint8_t> everywhere = std::vector<std::uint8_t>(3, 1);

  std::vector<Eigen::Vector3f> points_at(const Rigid3& pose) const {
    std::vector<Eigen::Vector3f> points;
    for (const Eigen::Vector3f& p : model.points) points.push_back(Rigid3f(pose) * p);
    return points;
  }
  std::vector<Eigen::Vector3f> normals_at(const Rigid3& pose) const {
    std::vector<Eigen::Vector3f> normals;
    for (const Eigen::Vector3f& n : model.normals) normals.push_back(Rigid3f(pose).rotation * n);
    return normals;
  }
};

// What a view must see of a point of the box, by casting the ray to it.
Evidence expected_evidence(const SmallCase& c, const Eigen::Vector3d& p, const Eigen::Vector3d& n,
                           const PreparedView& view) {
  const Rigid3& world_from_camera = view.frame.world_from_camera;
  const Eigen::Vector3d in_camera = world_from_camera.inverse() * p;
  if ((world_from_camera.translation - p).normalized().dot(n) < kMinFacing) return Evidence::kUnobserved;
  const Eigen::Vector2d pixel = view.frame.camera.project(in_camera);
  if (!view.frame.camera.contains(pixel)) return Evidence::kUnobserved;
  const float depth = view.cloud.z(static_cast<int>(std::lround(pixel.x())), static_cast<int>(std::lround(pixel.y())));
  if (std::isnan(depth)) return Evidence::kUnobserved;
  if (in_camera.z() - depth > c.options.visibility.margin_m) return Evidence::kOccluded;
  return depth - in_camera.z() > c.options.visibility.margin_m ? Evidence::kSeenThrough : Evidence::kPresent;
}

TEST(PrepareDepthViews, PixelsNearDepthEdgesAreUnobserved) {
  SmallCase c;
  for (PreparedView& view : c.views) view.edge_distance_px = find_edge_distance(find_depth_edges(view.cloud.z, {}), 5);
  const std::vector<DepthView> narrowed = prepare_depth_views(c.refs, 3, 1);
  int dropped = 0;
  for (std::size_t v = 0; v < narrowed.size(); ++v)
    for (std::size_t i = 0; i < narrowed[v].depth_m.size(); ++i) {
      const bool near_edge = c.views[v].edge_distance_px[i] < 3;
      const float z_m = narrowed[v].depth_m[i];
      if (near_edge)
        EXPECT_TRUE(std::isnan(z_m));
      else
        EXPECT_TRUE(z_m == c.depth_views[v].depth_m[i] || std::isnan(c.depth_views[v].depth_m[i]));
      dropped += near_edge && !std::isnan(c.depth_views[v].depth_m[i]) ? 1 : 0;
    }
  EXPECT_GT(dropped, 100);
}

TEST(PrepareDepthViews, WhatIsTooFarForThePointsIsStillFreeSpace) {
  RgbdFrame frame;
  frame.camera = {64, 48, 60, 60, 31.5, 23.5};
  frame.depth_m = Image<float>(64, 48, 2.0F);
  frame.color = Image<Rgb8>(64, 48);
  PrepareViewOptions options;
  options.max_depth_m = 1.5;
  const PreparedView view = prepare_view(frame, options);
  ASSERT_TRUE(std::isnan(view.cloud.z(30, 20)));
  const VerificationView reference{&view};
  EXPECT_EQ(prepare_depth_views(std::span(&reference, 1), 0, 1)[0].depth_m(30, 20), 2.0F);
}

TEST(FindVisiblePoints, AgreesWithTheDepthImagesPointByPoint) {
  const SmallCase c;
  // A convex model hides itself by its back faces alone; so its z-buffer must not take anything away.
  for (const Rigid3& pose : {c.solid.world_from_object, on_table(0.04, 0.05, 0.06, 0.5), on_table(0.1, 0, 0.05, 0.1)}) {
    const auto points = c.points_at(pose);
    const auto normals = c.normals_at(pose);
    const ModelVisibility found =
        find_visible_points(points, normals, c.depth_views, c.everywhere, c.options.visibility, c.options.resolution_m);
    int wrong = 0;
    std::array<int, 4> count{};
    std::vector<std::uint8_t> visible(points.size(), 0);
    for (std::size_t v = 0; v < 3; ++v)
      for (std::size_t i = 0; i < points.size(); ++i) {
        const Evidence expected = expected_evidence(c, points[i].cast<double>(), normals[i].cast<double>(), c.views[v]);
        if (found.evidence[v][i] != expected) ++wrong;
        ++count[static_cast<std::size_t>(expected)];
        if (is_observed(found.evidence[v][i])) visible[i] = 1;
      }
    EXPECT_GT(count[static_cast<std::size_t>(Evidence::kUnobserved)], 500);
    EXPECT_GT(count[static_cast<std::size_t>(Evidence::kPresent)], 150);
    EXPECT_LT(wrong, 0.005 * static_cast<double>(3 * points.size()));  // Rounding at pixel borders, corner normals.
    EXPECT_EQ(static_cast<long>(found.visible.size()), std::count(visible.begin(), visible.end(), 1));
  }
}

TEST(FindVisiblePoints, AModelHidesItself) {
  // Two parallel boards, the rear one 10 cm behind, and nothing else in the world but a wall far behind.
  const Camera camera = test_camera();
  DepthView view{camera, Rigid3::identity(), nullptr, Image<float>(camera.width, camera.height, 3.0F)};
  std::vector<Eigen::Vector3f> points;
  std::vector<Eigen::Vector3f> normals;
  for (int i = -10; i <= 10; ++i)
    for (int j = -10; j <= 10; ++j)
      for (const float z : {0.8F, 0.9F}) {
        points.emplace_back(0.005F * static_cast<float>(i) + (z > 0.85F ? 0.05F : 0.0F), 0.005F * static_cast<float>(j),
                            z);
        normals.emplace_back(0, 0, -1);
      }
  const std::vector<DepthView> views = {view};
  const std::vector<std::uint8_t> allowed = {1};
  const ModelVisibility found = find_visible_points(points, normals, views, allowed, {}, 0.005);
  int rear_seen = 0;
  int rear_hidden = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3f& p = points[i];
    if (p.z() < 0.85F) {
      EXPECT_EQ(found.evidence[0][i], Evidence::kSeenThrough);
      continue;
    }
    const float x_on_front = p.x() * 0.8F / 0.9F;  // Where its ray meets the front board, whose edge is at 5 cm.
    if (std::abs(x_on_front - 0.05F) < 0.01F) continue;
    (found.evidence[0][i] == Evidence::kOccluded ? rear_hidden : rear_seen) += 1;
    EXPECT_EQ(found.evidence[0][i] == Evidence::kOccluded, x_on_front < 0.05F);
  }
  EXPECT_GT(rear_seen, 100);
  EXPECT_GT(rear_hidden, 100);
}

// The formulas of CueComputer over all pairs, in double precision.
struct BruteForce {
  std::map<int, double> explained;
  int num_inliers = 0;
};

BruteForce brute_force(const SmallCase& c, const Rigid3& pose, const ModelVisibility& visibility,
                       const PhotometricFit& light) {
  const auto points = c.points_at(pose);
  const auto normals = c.normals_at(pose);
  const VerifyOptions& o = c.options;
  BruteForce result;
  for (std::size_t v = 0; v < visibility.visible.size(); ++v) {
    const int i = visibility.visible[v];
    double best_fit = 0;
    for (std::size_t q = 0; q < c.scene.points.size(); ++q) {
      const double d = (points[i] - c.scene.points[q]).cast<double>().norm();
      if (d > o.support.max_distance_m) continue;
      const double angle = std::acos(std::clamp<double>(normals[i].dot(c.scene.normals[q]), -1, 1));
      const LabColor lab = to_lab(light(c.model.linear_light[i], normals[i]));
      const double dl = lab.l - c.scene.lab[q].l;
      const double da = lab.a - c.scene.lab[q].a;
      const double db = lab.b - c.scene.lab[q].b;
      const double saturation = o.appearance.sigma_saturation * std::hypot(lab.a, lab.b);
      const double variance_ab = o.appearance.sigma_ab * o.appearance.sigma_ab + saturation * saturation;
      const double color = std::exp(-0.5 * (dl * dl / (2 * o.appearance.sigma_l * o.appearance.sigma_l) +
                                            (da * da + db * db) / (2 * variance_ab)));
      const double w = std::exp(-d * d / (2 * o.support.max_distance_m * o.support.max_distance_m)) * color *
                       std::max(0.0, 1 - angle / (std::numbers::pi / 2));
      if (w > 0) result.explained[static_cast<int>(q)] = std::max(result.explained[static_cast<int>(q)], w);
      const double wide = o.support.max_distance_m + o.resolution_m;
      if (angle < kMaxInlierAngle_rad) best_fit = std::max(best_fit, std::exp(-d * d / (2 * wide * wide)) * color);
    }
    if (best_fit > o.support.min_weight && visibility.seen_through[v] == 0) ++result.num_inliers;
  }
  return result;
}

TEST(CueComputer, AgreesWithTheFormulasOverAllPairs) {
  SmallCase c;
  c.options.planes.reset();
  c.options.refine.max_iterations.reset();
  c.options.appearance.light = {0, 0, 0, 0};
  c.options.appearance.sigma_saturation = 0.6;
  c.scene = prepare_scene(merge(c.views), c.options);
  for (const Rigid3& pose :
       {c.solid.world_from_object, disturb(c.solid.world_from_object, {0.006, -0.004, 0.003}, {1, 1, 1}, 0.15)}) {
    const ModelVisibility visibility = find_visible_points(c.points_at(pose), c.normals_at(pose), c.depth_views,
                                                           c.everywhere, c.options.visibility, c.options.resolution_m);
    CueComputer computer(c.model, pose, {}, c.scene, c.depth_views, c.everywhere, c.options);
    const PhotometricFit light = limit_chromaticity(computer.light(), Eigen::Array3f::Zero());
    const HypothesisCues cues = computer.finish(Eigen::Array3f::Zero());
    const BruteForce expected = brute_force(c, pose, visibility, light);
    EXPECT_EQ(cues.evidence.num_visible, static_cast<int>(visibility.visible.size()));
    EXPECT_NEAR(cues.evidence.num_explained, expected.num_inliers, 2);
    EXPECT_GT(expected.num_inliers, 300);
    std::size_t num_expected = 0;
    for (const auto& [q, w] : expected.explained)
      if (w >= 0.051) ++num_expected;
    EXPECT_GT(num_expected, 400U);
    EXPECT_GE(cues.explained.size(), num_expected);
    for (const WeightedPoint& w : cues.explained) {
      ASSERT_TRUE(expected.explained.contains(w.point));
      EXPECT_NEAR(w.weight, expected.explained.at(w.point), 1e-3);
    }
  }
}

TEST(CueComputer, ClutterIsTheUnexplainedRestOfASegmentNearby) {
  // The lower half of the box alone is the model: the upper half of its sides is left over.
  SmallCase c;
  c.options.planes.reset();
  c.options.acceptance.min_explained_share = 0;
  const Solid half{Shape::kBox, {0.08, 0.06, 0.05}, c.solid.paint, on_table(0, 0, 0.025, 0.3)};
  const PreparedModel model = prepare_model(make_model("half", half), c.options);
  const HypothesisCues cues =
      CueComputer(model, half.world_from_object, {}, c.scene, c.depth_views, c.everywhere, c.options)
          .finish(Eigen::Array3f::Zero());
  std::map<int, float> explained;
  for (const WeightedPoint& w : cues.explained) explained[w.point] = w.weight;
  int same_segment = 0;
  for (const WeightedPoint& q : cues.clutter) {
    EXPECT_FALSE(explained.contains(q.point));
    float nearest = 1;
    for (const auto& [p, w] : explained)
      if (c.scene.segment[p] == c.scene.segment[q.point] && c.scene.segment[p] >= 0)
        nearest = std::min(nearest, (c.scene.points[p] - c.scene.points[q.point]).norm());
    EXPECT_EQ(q.weight == 1.0F, nearest <= 0.03F) << q.weight << " " << nearest;
    if (q.weight == 1.0F && c.scene.points[q.point].z() > 0.05F) ++same_segment;
  }
  EXPECT_GT(same_segment, 150);
  EXPECT_GT(cues.evidence.costs.clutter, 150);
}

}  // namespace
}  // namespace resight
