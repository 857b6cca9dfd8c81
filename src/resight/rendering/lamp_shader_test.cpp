// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "resight/core/srgb.hpp"
#include "resight/rendering/view_renderer.hpp"
#include "resight/simulation/mesh_parts.hpp"

namespace resight {
namespace {

constexpr Camera kLampCamera{160, 120, 150, 150, 79.5, 59.5};

TriangleMesh block(const Eigen::Vector3d& size) {
  TextureAtlas atlas(64, 1.0);
  const PixelRect grey = atlas.solid({128, 128, 128});
  TriangleMesh mesh = make_box_part(size, {grey, grey, grey, grey, grey, grey}, 1);
  atlas.finish(mesh);
  return mesh;
}

// A floor seen from above, with a post in its middle.
struct LitScene {
  LitScene() {
    floor = scene.add_instance(scene.add_mesh(block({4, 4, 0.01})), Rigid3::identity());
    scene.add_instance(scene.add_mesh(block({0.1, 0.1, 0.4})), Rigid3::identity());
    scene.commit();
  }
  [[nodiscard]] RenderedView render(const Lighting& lighting, int num_threads = 1) const {
    RenderOptions options;
    options.lighting = lighting;
    options.linear_light = true;
    options.num_threads = num_threads;
    return render_scene(scene, kLampCamera, pose, options);
  }
  [[nodiscard]] Eigen::Vector3f light_at(const RenderedView& view, double x_m, double y_m) const {
    const Pixel pixel = *kLampCamera.pixel_of(pose.inverse() * Eigen::Vector3d(x_m, y_m, 0.01));
    return view.light(pixel.u, pixel.v);
  }
  RaycastScene scene;
  Rigid3 pose = look_at({0, -0.01, 2.5}, {0, 0, 0});
  int floor = 0;
};

Lighting two_lamps(double radius_m) {
  Lighting lighting;
  lighting.ambient = 0.1;
  lighting.shadows = true;
  lighting.lamps = {{{2, 0, 2}, {0.8, 0.4, 0.2}, radius_m}, {{-2, 0, 2}, {0.2, 0.4, 0.8}, radius_m}};
  return lighting;
}

TEST(LampShader, ShadowsHaveTheColourOfTheOtherLamp) {
  const LitScene scene;
  const RenderedView view = scene.render(two_lamps(0));
  const Eigen::Vector3f left = scene.light_at(view, -0.2, 0);  // in the shadow of the right, red lamp
  const Eigen::Vector3f right = scene.light_at(view, 0.2, 0);  // in that of the blue lamp
  const Eigen::Vector3f open = scene.light_at(view, 0, -0.6);  // both lamps shine here
  EXPECT_GT(left.z(), 2 * left.x());
  EXPECT_GT(right.x(), 2 * right.z());
  EXPECT_GT(open.x(), 0.95 * right.x());
  EXPECT_GT(open.z(), 0.95 * left.z());
  // Lambert: the albedo times both cosines and the ambient light from above.
  const double cosine = 2 / std::sqrt(4 + 4 + 0.36);
  EXPECT_NEAR(open.y(), decode_srgb(128) * (0.8 * cosine + 0.1), 0.01);
}

TEST(LampShader, LargeLampsCastSoftShadows) {
  const LitScene scene;
  const auto light_in_shadow = [&](double radius_m) {
    Lighting lighting = two_lamps(radius_m);
    lighting.lamps.pop_back();
    return scene.light_at(scene.render(lighting), -0.35, 0).x();
  };
  const float umbra = light_in_shadow(0);
  EXPECT_NEAR(umbra, decode_srgb(128) * 0.1, 0.002);  // ambient only
  EXPECT_GT(light_in_shadow(1.0), 1.5F * umbra) << "the post hides only a part of a large lamp";
}

TEST(LampShader, GlossySurfacesShowHighlights) {
  LitScene scene;
  Lighting lighting = two_lamps(0);
  lighting.shadows = false;
  const RenderedView matte = scene.render(lighting);
  scene.scene.set_material(scene.floor, {.specular = 1, .shininess = 100});
  const RenderedView glossy = scene.render(lighting);
  // The lamp at (2, 0, 2) and the eye at z = 2.5 mirror each other at x = 2 * 2.5 / 4.5.
  EXPECT_GT(scene.light_at(glossy, 1.11, 0).x(), scene.light_at(matte, 1.11, 0).x() + 0.7F);
  EXPECT_NEAR(scene.light_at(glossy, 0, -0.6).x(), scene.light_at(matte, 0, -0.6).x(), 0.01F);
}

TEST(LampShader, HasTheSameBytesForAnyNumberOfThreads) {
  const LitScene scene;
  const RenderedView one = scene.render(two_lamps(0.2));
  const RenderedView three = scene.render(two_lamps(0.2), 3);
  EXPECT_EQ(one.light, three.light);
  EXPECT_EQ(one.color, three.color);
}

TEST(LampShader, RejectsInvalidLamps) {
  Lighting lighting = two_lamps(0);
  lighting.lamps[0].intensity.x() = -1;
  EXPECT_THROW(lighting.check(), std::invalid_argument);
}

}  // namespace
}  // namespace resight
