// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numbers>

#include "resight/simulation/internal/object_makers.hpp"
#include "resight/simulation/mesh_parts.hpp"
#include "resight/simulation/room.hpp"
#include "resight/simulation/texture_designs.hpp"

namespace resight {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// A rotation body with a closed bottom and top; the profile goes from top to bottom.
TriangleMesh turned(TextureAtlas& atlas, const std::vector<Vector2d>& profile, const PixelRect& side, Rgb8 caps) {
  const PixelRect cap = atlas.solid(caps);
  TriangleMesh mesh = make_lathe_part(profile, side, 48);
  mesh.append(make_disc_part(profile.front().x(), profile.front().y(), true, cap, 0, 48));
  mesh.append(make_disc_part(profile.back().x(), profile.back().y(), false, cap, 0, 48));
  return mesh;
}

PixelRect blob_region(TextureAtlas& atlas, double w_mm, double h_mm, Rgb8 base, double hue_deg, std::uint64_t seed,
                      int count, double max_radius_mm) {
  const PixelRect region = atlas.allocate(w_mm, h_mm);
  atlas.canvas(region).fill(base);
  print_blobs(atlas.canvas(region), Rng(seed), hue_deg, count, 0.25 * max_radius_mm, max_radius_mm);
  return region;
}

ProceduralObject make_vase() {
  TextureAtlas atlas(1024, 2.5);
  const PixelRect side = blob_region(atlas, 310, 240, {60, 90, 150}, 210, 51, 60, 14);
  std::vector<Vector2d> profile;
  for (int i = 0; i <= 24; ++i) {
    const double t = i / 24.0;
    profile.emplace_back(0.032 + 0.022 * std::sin(std::numbers::pi * (0.15 + 1.1 * t)) + 0.006 * t, 0.23 * (1 - t));
  }
  ProceduralObject object{"vase", turned(atlas, profile, side, {30, 40, 60}), {}, "distractor"};
  atlas.finish(object.mesh);
  return object;
}

ProceduralObject make_lamp() {
  TextureAtlas atlas(1024, 2.0);
  const PixelRect shade = atlas.allocate(400, 130);
  atlas.canvas(shade).fill({230, 215, 180});
  atlas.canvas(shade).stripes(22, 0.0, {205, 180, 135});
  const PixelRect metal = atlas.solid({70, 72, 78});
  ProceduralObject object{
      "lamp", turned(atlas, {{0.035, 0.30}, {0.08, 0.18}}, shade, {245, 240, 220}), {}, "distractor"};
  object.mesh.append(make_lathe_part(std::vector<Vector2d>{{0.008, 0.20}, {0.008, 0.02}}, metal, 24));
  object.mesh.append(turned(atlas, {{0.06, 0.02}, {0.065, 0.0}}, metal, {70, 72, 78}));
  atlas.finish(object.mesh);
  return object;
}

ProceduralObject make_plant() {
  TextureAtlas atlas(1024, 2.0);
  const PixelRect pot = blob_region(atlas, 300, 90, {175, 95, 60}, 20, 53, 25, 8);
  const PixelRect leaf = atlas.allocate(60, 30);
  atlas.canvas(leaf).fill({50, 120, 50});
  atlas.canvas(leaf).stripes(8, 0.5, {90, 160, 70});
  ProceduralObject object{"plant", turned(atlas, {{0.05, 0.085}, {0.036, 0.0}}, pot, {70, 50, 35}), {}, "distractor"};
  Rng rng(530);
  for (int i = 0; i < 22; ++i) {
    const double yaw = rng.uniform(0, 2 * std::numbers::pi);
    const double tilt = rng.uniform(0.1, 1.2);
    const double length = rng.uniform(0.05, 0.09);
    const Rigid3 pose = Rigid3::from_translation({0, 0, 0.08}) * Rigid3::from_axis_angle(Vector3d::UnitZ(), yaw) *
                        Rigid3::from_axis_angle(Vector3d::UnitY(), tilt) * Rigid3::from_translation({0, 0, length});
    object.mesh.append(moved(make_ellipsoid_part({0.004, 0.016, length}, leaf, 16), pose));
  }
  atlas.finish(object.mesh);
  stand_on_origin(object.mesh);
  return object;
}

ProceduralObject make_speaker() {
  TextureAtlas atlas(1024, 2.5);
  const PixelRect side = atlas.solid({58, 50, 46});
  const PixelRect front = atlas.allocate(110, 180);
  TextureCanvas canvas = atlas.canvas(front);
  canvas.fill({40, 40, 44});
  canvas.disc(55, 120, 42, {75, 75, 80});
  canvas.ring(55, 120, 34, 6, {30, 30, 32});
  canvas.disc(55, 120, 14, {110, 110, 115});
  canvas.disc(55, 45, 22, {75, 75, 80});
  canvas.disc(55, 45, 9, {120, 120, 125});
  canvas.text_in_box(35, 168, 40, 9, "SONORA", {210, 210, 200});
  ProceduralObject object{
      "speaker", make_box_part({0.11, 0.10, 0.18}, {front, side, side, side, side, side}), {}, "distractor"};
  atlas.finish(object.mesh);
  return object;
}

ProceduralObject make_globe() {
  TextureAtlas atlas(1024, 1.8);
  const PixelRect sea =
      blob_region(atlas, 2 * std::numbers::pi * 85, std::numbers::pi * 85, {70, 130, 190}, 90, 55, 40, 40);
  const PixelRect foot = atlas.solid({90, 60, 35});
  ProceduralObject object{
      "globe",
      moved(make_ellipsoid_part({0.085, 0.085, 0.085}, sea, 48), Rigid3::from_translation({0, 0, 0.125})),
      {},
      "distractor"};
  object.mesh.append(turned(atlas, {{0.012, 0.05}, {0.012, 0.02}}, foot, {90, 60, 35}));
  object.mesh.append(turned(atlas, {{0.055, 0.02}, {0.06, 0.0}}, foot, {90, 60, 35}));
  atlas.finish(object.mesh);
  return object;
}

ProceduralObject make_pyramid() {
  TextureAtlas atlas(1024, 2.0);
  const PixelRect side = atlas.allocate(4 * 120, 150);
  TextureCanvas canvas = atlas.canvas(side);
  for (int i = 0; i < 4; ++i) canvas.part(i * 120, 0, 120, 150).fill(hsv_color(30 + 90 * i, 0.5, 0.8));
  print_blobs(canvas, Rng(56), 130, 50, 3, 12);
  // A cone of four segments is a pyramid.
  ProceduralObject object{
      "pyramid",
      make_lathe_part(std::vector<Vector2d>{{0.0, 0.15}, {0.0283, 0.1}, {0.0566, 0.05}, {0.085, 0.0}}, side, 4),
      {},
      "distractor"};
  object.mesh.append(make_disc_part(0.085, 0, false, atlas.solid({120, 90, 60}), 0, 4));
  object.mesh.normals.clear();  // flat sides
  atlas.finish(object.mesh);
  return object;
}

ProceduralObject make_basket() {
  TextureAtlas atlas(1024, 2.0);
  const PixelRect weave = atlas.allocate(480, 110);
  TextureCanvas canvas = atlas.canvas(weave);
  canvas.fill({190, 150, 95});
  canvas.stripes(16, std::numbers::pi / 4, {140, 100, 55});
  canvas.stripes(16, -std::numbers::pi / 4, {165, 125, 75});
  const PixelRect inside = atlas.solid({120, 90, 55});
  ProceduralObject object{
      "basket", make_lathe_part(std::vector<Vector2d>{{0.085, 0.11}, {0.065, 0.0}}, weave, 48), {}, "distractor"};
  object.mesh.append(make_disc_part(0.065, 0, false, inside, 0, 48));
  object.mesh.append(make_disc_part(0.085, 0.11, true, inside, 0.079, 48));
  object.mesh.append(make_lathe_part(std::vector<Vector2d>{{0.059, 0.006}, {0.079, 0.11}}, inside, 48));
  object.mesh.append(make_disc_part(0.059, 0.006, true, inside, 0, 48));
  atlas.finish(object.mesh);
  return object;
}

ProceduralObject make_thermos() {
  TextureAtlas atlas(1024, 2.5);
  const PixelRect side = atlas.allocate(2 * std::numbers::pi * 0.038 * kMmPerM, 240);
  TextureCanvas canvas = atlas.canvas(side);
  canvas.fill({40, 95, 75});
  canvas.stripes(30, 1.2, {200, 205, 200});
  canvas.text_in_box(80, 120, 80, 40, "TERMIX", {250, 240, 120}, 0.2);
  ProceduralObject object{
      "thermos",
      turned(atlas, {{0.03, 0.26}, {0.03, 0.215}, {0.038, 0.2}, {0.038, 0.0}}, side, {150, 152, 158}),
      {},
      "distractor"};
  atlas.finish(object.mesh);
  return object;
}

const std::vector<ObjectMaker>& makers() {
  static const std::vector<ObjectMaker> all{
      {"vase", make_vase},   {"lamp", make_lamp},       {"plant", make_plant},   {"speaker", make_speaker},
      {"globe", make_globe}, {"pyramid", make_pyramid}, {"basket", make_basket}, {"thermos", make_thermos}};
  return all;
}

}  // namespace

const std::vector<std::string>& distractor_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (const ObjectMaker& maker : makers()) all.push_back(maker.name);
    return all;
  }();
  return names;
}

Result<ProceduralObject> make_distractor(std::string_view name) {
  for (const ObjectMaker& maker : makers())
    if (maker.name == name) return maker.make();
  std::string known;
  for (const std::string& n : distractor_names()) known += (known.empty() ? "" : ", ") + n;
  return Error{"no distractor '" + std::string(name) + "' (known: " + known + ")"};
}

}  // namespace resight
