// SPDX-License-Identifier: Apache-2.0
#include "resight/rendering/view_renderer.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "resight/simulation/mesh_parts.hpp"
#include "resight/simulation/procedural_objects.hpp"

namespace resight {
namespace {

constexpr Camera kViewCamera{160, 120, 130.0, 140.0, 77.3, 61.9};

TriangleMesh sphere(double radius) {
  TextureAtlas atlas(64, 1.0);
  TriangleMesh mesh = make_ellipsoid_part({radius, radius, radius}, atlas.solid({200, 100, 50}), 192);
  atlas.finish(mesh);
  return mesh;
}

TEST(RenderScene, SphereHasItsClosedFormDepth) {
  constexpr double kRadius = 0.2;
  const Eigen::Vector3d center(0.05, -0.02, 1.0);
  RaycastScene scene;
  scene.add_instance(scene.add_mesh(sphere(kRadius)), Rigid3::from_translation(center));
  scene.commit();
  const RenderedView view = render_scene(scene, kViewCamera, Rigid3::identity());
  int hits = 0;
  int misses = 0;
  for (int v = 0; v < kViewCamera.height; ++v)
    for (int u = 0; u < kViewCamera.width; ++u) {
      const Eigen::Vector3d ray = kViewCamera.unproject(u, v, 1.0);
      // |t ray - center| = r
      const double a = ray.squaredNorm();
      const double b = ray.dot(center);
      const double discriminant = b * b - a * (center.squaredNorm() - kRadius * kRadius);
      if (std::abs(discriminant) < 2e-3) continue;  // the silhouette of the polyhedron differs slightly
      if (discriminant < 0) {
        EXPECT_TRUE(std::isnan(view.depth_m(u, v)));
        EXPECT_EQ(view.labels(u, v), -1);
        ++misses;
        continue;
      }
      const double z = (b - std::sqrt(discriminant)) / a;
      EXPECT_NEAR(view.depth_m(u, v), z, 3e-4);
      EXPECT_EQ(view.labels(u, v), 0);
      const Eigen::Vector3d normal = (z * ray - center) / kRadius;
      EXPECT_GT(view.normals_in_camera(u, v).cast<double>().dot(normal), 0.995);
      ++hits;
    }
  EXPECT_GT(hits, 1500);
  EXPECT_GT(misses, 5000);
}

TEST(RenderScene, PointsAppearAtThePixelTheyProjectTo) {
  // A tiny coloured square in the view of a posed camera. Its centre of mass in the image is its projection.
  TextureAtlas atlas(64, 1.0);
  const PixelRect red = atlas.solid({255, 0, 0});
  TriangleMesh chip = make_box_part({0.02, 0.02, 0.0005}, {red, red, red, red, red, red}, 1);
  atlas.finish(chip);
  const Eigen::Vector3d p_in_world(0.3, 0.4, 0.1);
  RaycastScene scene;
  const Rigid3 world_from_camera = look_at({1.0, -0.2, 0.9}, {0.25, 0.5, 0.2});
  Rigid3 facing;  // the square faces the camera
  facing.rotation = look_at(p_in_world, world_from_camera.translation).rotation;
  // Rotated in the image plane, because otherwise a whole side would cross the pixel grid at once.
  facing.rotation = facing.rotation * Rigid3::from_axis_angle(Eigen::Vector3d::UnitZ(), 0.35).rotation;
  facing.translation = p_in_world;
  scene.add_instance(scene.add_mesh(chip), facing);
  scene.commit();
  const Camera camera{320, 240, 900, 900, 159.5, 119.5};
  const RenderedView view = render_scene(scene, camera, world_from_camera);
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  int count = 0;
  for (int v = 0; v < camera.height; ++v)
    for (int u = 0; u < camera.width; ++u)
      if (view.labels(u, v) == 0) {
        sum += Eigen::Vector2d(u, v);
        ++count;
      }
  ASSERT_GT(count, 200);
  const Eigen::Vector2d expected = camera.project(world_from_camera.inverse() * p_in_world);
  EXPECT_LT((sum / count - expected).norm(), 0.15);
}

TEST(RenderScene, PrintIsUprightAndNotMirrored) {
  // Front of a package: the left border is red, the top border green, and the bottom right is white.
  TextureAtlas atlas(512, 1.0);
  const PixelRect front = atlas.allocate(100, 100);
  TextureCanvas canvas = atlas.canvas(front);
  canvas.fill({255, 255, 255});
  canvas.rect(0, 0, 100, 20, {0, 255, 0});
  canvas.rect(0, 20, 20, 80, {255, 0, 0});
  const PixelRect grey = atlas.solid({128, 128, 128});
  TriangleMesh box = make_box_part({0.1, 0.1, 0.1}, {front, grey, grey, grey, grey, grey}, 4);
  atlas.finish(box);
  RaycastScene scene;
  scene.add_instance(scene.add_mesh(box), Rigid3::identity());
  scene.commit();
  const Camera camera{200, 200, 400, 400, 99.5, 99.5};
  RenderOptions options;
  options.lighting.ambient = 1.0;
  options.lighting.diffuse = 0.0;
  const RenderedView view = render_scene(scene, camera, look_at({0, -0.35, 0.05}, {0, 0, 0.05}), options);
  const Rgb8 top = view.color(100, 40);
  const Rgb8 left = view.color(40, 110);
  const Rgb8 rest = view.color(140, 140);
  EXPECT_GT(top.g, 150);
  EXPECT_LT(top.r, 60);
  EXPECT_GT(left.r, 150);
  EXPECT_LT(left.g, 60);
  EXPECT_GT(rest.r, 150);
  EXPECT_GT(rest.g, 150);
}

TEST(RenderScene, SameBytesForAnyNumberOfThreads) {
  RaycastScene scene;
  scene.add_instance(scene.add_mesh(make_procedural_object("mug")->mesh), Rigid3::identity());
  scene.commit();
  const Rigid3 pose = look_at({0.3, -0.3, 0.25}, {0, 0, 0.05});
  RenderOptions options;
  const RenderedView serial = render_scene(scene, kViewCamera, pose, options);
  options.num_threads = 3;
  const RenderedView parallel = render_scene(scene, kViewCamera, pose, options);
  EXPECT_EQ(serial.color, parallel.color);
  EXPECT_EQ(serial.labels, parallel.labels);
  ASSERT_EQ(serial.depth_m.size(), parallel.depth_m.size());
  EXPECT_EQ(0, std::memcmp(serial.depth_m.data().data(), parallel.depth_m.data().data(),
                           serial.depth_m.size() * sizeof(float)));
  EXPECT_GT(std::ranges::count(serial.labels.data(), 0), 500);
}

TEST(RenderScene, LampCastsShadowsWhenAsked) {
  TextureAtlas atlas(64, 1.0);
  const PixelRect white = atlas.solid({220, 220, 220});
  TriangleMesh floor = make_box_part({2, 2, 0.01}, {white, white, white, white, white, white}, 1);
  atlas.finish(floor);
  RaycastScene scene;
  scene.add_instance(scene.add_mesh(floor), Rigid3::identity());
  scene.add_instance(scene.add_mesh(make_procedural_object("plain_box")->mesh), Rigid3::from_translation({0, 0, 0.01}));
  scene.commit();
  RenderOptions options;
  options.lighting.lamp_in_world_m = {1, 0, 1};
  const Rigid3 pose = look_at({-0.2, -1.2, 1.2}, {0, 0, 0});
  const RenderedView lit = render_scene(scene, kViewCamera, pose, options);
  options.lighting.shadows = true;
  const RenderedView shaded = render_scene(scene, kViewCamera, pose, options);
  const Eigen::Vector2d in_shadow = kViewCamera.project(pose.inverse() * Eigen::Vector3d(-0.15, 0, 0.01));
  const Eigen::Vector2d in_light = kViewCamera.project(pose.inverse() * Eigen::Vector3d(0.4, 0, 0.01));
  const auto at = [](const RenderedView& v, const Eigen::Vector2d& p) {
    return v.color(static_cast<int>(std::lround(p.x())), static_cast<int>(std::lround(p.y()))).r;
  };
  EXPECT_LT(at(shaded, in_shadow) + 30, at(lit, in_shadow));
  EXPECT_EQ(at(shaded, in_light), at(lit, in_light));
}

TEST(LookAt, IsRigidUprightAndForward) {
  const Rigid3 pose = look_at({1, 2, 3}, {0, 0, 0.5});
  EXPECT_TRUE(pose.is_rigid(1e-12));
  const Eigen::Vector3d target = pose.inverse() * Eigen::Vector3d(0, 0, 0.5);
  EXPECT_NEAR(target.x(), 0, 1e-12);
  EXPECT_NEAR(target.y(), 0, 1e-12);
  EXPECT_GT(target.z(), 0);
  EXPECT_LT(pose.rotation.col(1).z(), 0);  // image down is world down
  EXPECT_NEAR(pose.rotation.col(0).z(), 0, 1e-12);
  EXPECT_THROW(static_cast<void>(look_at({0, 0, 1}, {0, 0, 0})), std::invalid_argument);
}

TEST(RenderScene, RefusesBadOptions) {
  RaycastScene scene;
  scene.commit();
  RenderOptions options;
  options.samples_per_side = 0;
  EXPECT_THROW(static_cast<void>(render_scene(scene, kViewCamera, Rigid3::identity(), options)), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(render_scene(scene, Camera{}, Rigid3::identity())), std::invalid_argument);
  const RenderedView empty = render_scene(scene, kViewCamera, Rigid3::identity());
  EXPECT_EQ(std::ranges::count(empty.labels.data(), -1), kViewCamera.width * kViewCamera.height);
}

}  // namespace
}  // namespace resight
