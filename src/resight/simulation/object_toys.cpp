// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <numbers>

#include "resight/simulation/internal/object_makers.hpp"
#include "resight/simulation/internal/object_shapes.hpp"
#include "resight/simulation/mesh_parts.hpp"
#include "resight/simulation/texture_designs.hpp"

namespace resight {
namespace {

using Eigen::Vector3d;

BoxRegions same_regions(const PixelRect& r) { return {r, r, r, r, r, r}; }

// A body of boxes with wheels and stickers on all sides. The car drives to +x.
ProceduralObject make_toy_car() {
  const TextureStyle style{"TURBO", "7", 48, 3131};
  TextureAtlas atlas(1024, 3.0);
  const auto printed = [&](double w_m, double h_m, std::uint64_t part, const std::string& word) {
    const PixelRect region = atlas.allocate(w_m * kMmPerM, h_m * kMmPerM);
    TextureCanvas canvas = atlas.canvas(region);
    canvas.fill(hsv_color(48, 0.85, 0.95));
    canvas.rect(0, 0.42 * canvas.height(), canvas.width(), 0.2 * canvas.height(), {200, 30, 30});
    print_blobs(canvas, style.stream(part), 200, 14, 2, 7);
    if (!word.empty())
      canvas.text_in_box(0.15 * canvas.width(), 0.25 * canvas.height(), 0.7 * canvas.width(), 0.5 * canvas.height(),
                         word, {20, 20, 60}, 0.22);
    return region;
  };
  const Vector3d body(0.18, 0.08, 0.04);
  const Vector3d cabin(0.085, 0.07, 0.035);
  const BoxRegions body_regions{printed(0.18, 0.04, 1, "TURBO 7"), printed(0.08, 0.04, 2, "GO"),
                                printed(0.18, 0.04, 3, "RALLY"),   printed(0.08, 0.04, 4, "XR4"),
                                printed(0.18, 0.08, 5, ""),        atlas.solid({70, 70, 75})};
  const auto window = [&](double w_m) {
    const PixelRect region = atlas.allocate(w_m * kMmPerM, 35);
    TextureCanvas canvas = atlas.canvas(region);
    canvas.fill(hsv_color(48, 0.85, 0.9));
    canvas.rounded_rect(5, 5, canvas.width() - 10, 20, 4, {60, 85, 110});
    canvas.line(10, 22, 22, 8, 2, {190, 215, 230});
    return region;
  };
  const BoxRegions cabin_regions{window(0.085),
                                 window(0.07),
                                 window(0.085),
                                 window(0.07),
                                 printed(0.085, 0.07, 6, "7"),
                                 atlas.solid({70, 70, 75})};
  const PixelRect hub = atlas.allocate(36, 36);
  TextureCanvas hub_canvas = atlas.canvas(hub);
  hub_canvas.fill({35, 35, 38});
  hub_canvas.disc(18, 18, 11, {205, 205, 210});
  hub_canvas.star(18, 18, 10, 4, 5, 0.3, {90, 90, 100});
  const PixelRect tyre = atlas.solid({35, 35, 38});

  ProceduralObject object{
      "toy_car", moved(make_box_part(body, body_regions, 12), Rigid3::from_translation({0, 0, 0.014})), {}, "textured"};
  object.mesh.append(moved(make_box_part(cabin, cabin_regions, 10), Rigid3::from_translation({-0.012, 0, 0.0535})));
  constexpr double kWheelRadius = 0.018;
  constexpr double kWheelWidth = 0.014;
  const std::vector<Eigen::Vector2d> tread{{kWheelRadius, kWheelWidth}, {kWheelRadius, 0}};
  TriangleMesh wheel = make_lathe_part(tread, tyre, 32);
  wheel.append(make_disc_part(kWheelRadius, kWheelWidth, true, hub, 0, 32));
  wheel.append(make_disc_part(kWheelRadius, 0, false, hub, 0, 32));
  for (const double x : {-0.055, 0.055})
    for (const double y : {-0.047, 0.033})
      object.mesh.append(moved(wheel, Rigid3::from_translation({x, y + kWheelWidth, kWheelRadius}) *
                                          Rigid3::from_axis_angle(Vector3d::UnitX(), std::numbers::pi / 2)));
  atlas.finish(object.mesh);
  return object;
}

ProceduralObject make_duck() {
  const TextureStyle style{"", "", 52, 3232};
  TextureAtlas atlas(512, 2.0);
  const PixelRect body = atlas.allocate(230, 100);
  TextureCanvas canvas = atlas.canvas(body);
  canvas.fill(hsv_color(52, 0.8, 0.97));
  print_blobs(canvas, style.stream(1), 20, 45, 2.5, 8);
  const PixelRect head = atlas.allocate(160, 80);
  TextureCanvas head_canvas = atlas.canvas(head);
  head_canvas.fill(hsv_color(52, 0.8, 0.97));
  for (const double x : {92.0, 148.0}) {  // eyes left and right of the beak (which points to +x, 3/4 around)
    head_canvas.disc(x, 30, 8, {250, 250, 250});
    head_canvas.disc(x, 31, 4.5, {20, 20, 25});
  }
  print_blobs(head_canvas.part(0, 0, 70, 60), style.stream(2), 300, 10, 2, 5);
  const PixelRect beak = atlas.solid({235, 120, 20});
  ProceduralObject object{
      "duck",
      moved(make_ellipsoid_part({0.055, 0.04, 0.035}, body, 48), Rigid3::from_translation({0, 0, 0.035})),
      {},
      "textured"};
  object.mesh.append(
      moved(make_ellipsoid_part({0.028, 0.026, 0.027}, head, 40), Rigid3::from_translation({0.03, 0, 0.082})));
  object.mesh.append(
      moved(make_ellipsoid_part({0.018, 0.014, 0.006}, beak, 24), Rigid3::from_translation({0.062, 0, 0.078})));
  object.mesh.append(
      moved(make_ellipsoid_part({0.024, 0.018, 0.012}, body, 24),
            Rigid3::from_translation({-0.055, 0, 0.05}) * Rigid3::from_axis_angle(Vector3d::UnitY(), 0.6)));
  atlas.finish(object.mesh);
  stand_on_origin(object.mesh);
  return object;
}

// A block with a roof and a chimney.
ProceduralObject make_toy_house() {
  const TextureStyle style{"", "", 15, 3333};
  TextureAtlas atlas(1024, 3.0);
  const auto wall = [&](double w_m, std::uint64_t part, bool has_door) {
    const PixelRect region = atlas.allocate(w_m * kMmPerM, 80);
    TextureCanvas canvas = atlas.canvas(region);
    canvas.fill({228, 205, 170});
    Rng rng = style.stream(part);
    for (int row = 0; row < 10; ++row)  // bricks
      for (double x = row % 2 == 0 ? 0 : -9; x < canvas.width(); x += 18) {
        const double value = rng.uniform(0.55, 0.8);
        const double hue_deg = rng.uniform(12, 26);
        canvas.rounded_rect(x + 0.6, row * 8 + 0.6, 16.5, 6.8, 0.8, hsv_color(hue_deg, 0.6, value));
      }
    for (double x = 10; x + 22 < canvas.width(); x += 34) {
      const bool is_door = has_door && x == 10;
      canvas.rect(x, is_door ? 30 : 20, 22, is_door ? 50 : 26, {245, 245, 240});
      canvas.rect(x + 3, is_door ? 33 : 23, 16, is_door ? 47 : 20,
                  is_door ? Rgb8{90, 50, 25} : hsv_color(200, 0.5, rng.uniform(0.4, 0.8)));
    }
    canvas.text_in_box(8, 4, 40, 12, std::to_string(10 + rng.below(90)), {30, 30, 60}, 0.25);
    return region;
  };
  const Vector3d block(0.13, 0.10, 0.08);
  const BoxRegions regions{wall(0.13, 1, true), wall(0.10, 2, false),       wall(0.13, 3, false),
                           wall(0.10, 4, true), atlas.solid({120, 90, 70}), atlas.solid({120, 90, 70})};
  ProceduralObject object{"toy_house", make_box_part(block, regions), {}, "textured"};
  const double slope = std::hypot(0.065, 0.055);
  const PixelRect roof = atlas.allocate((0.13 + 2 * slope) * kMmPerM, 150);
  TextureCanvas canvas = atlas.canvas(roof);
  canvas.fill({150, 45, 35});
  Rng rng = style.stream(9);
  for (double y = 0; y < 150; y += 10)
    for (double x = 0; x < canvas.width(); x += 12) {
      const double value = rng.uniform(0.35, 0.8);
      const double hue_deg = rng.uniform(5, 25);
      canvas.ellipse(x + 6, y + 4, 5.6, 7, 0, hsv_color(hue_deg, 0.75, value));
    }
  const PixelRect gable = atlas.allocate(130, 55);
  TextureCanvas gable_canvas = atlas.canvas(gable);
  gable_canvas.fill({240, 225, 190});
  gable_canvas.disc(65, 35, 12, {60, 90, 130});
  gable_canvas.line(53, 35, 77, 35, 2, {240, 240, 240});
  gable_canvas.line(65, 23, 65, 47, 2, {240, 240, 240});
  const std::vector<Eigen::Vector2d> triangle{{-0.065, 0}, {0.065, 0}, {0, 0.055}};
  Rigid3 house_from_prism;
  house_from_prism.rotation << 1, 0, 0, 0, 0, -1, 0, 1, 0;  // prism z becomes -y
  house_from_prism.translation = Vector3d(0, 0.055, 0.08);
  object.mesh.append(moved(make_prism_part(triangle, 0.11, roof, gable, gable), house_from_prism));
  object.mesh.append(moved(make_box_part({0.02, 0.02, 0.05}, same_regions(atlas.solid({110, 60, 45})), 4),
                           Rigid3::from_translation({0.03, 0.02, 0.095})));
  atlas.finish(object.mesh);
  return object;
}

ProceduralObject make_ball() {
  const TextureStyle style{"BOLIDO", "", 120, 3434};
  constexpr double kRadius = 0.075;
  TextureAtlas atlas(1024, 2.0);
  const PixelRect skin = atlas.allocate(2 * std::numbers::pi * kRadius * kMmPerM, std::numbers::pi * kRadius * kMmPerM);
  TextureCanvas canvas = atlas.canvas(skin);
  const double w = canvas.width();
  const double h = canvas.height();
  for (int i = 0; i < 6; ++i)
    canvas.part(i * w / 6, 0, w / 6, h).fill(hsv_color(120 + 60 * i, 0.65, i % 2 == 0 ? 0.9 : 0.6));
  print_blobs(canvas.part(0, 0.15 * h, w, 0.7 * h), style.stream(1), 0, 90, 4, 16);
  canvas.text_in_box(0.3 * w, 0.4 * h, 0.4 * w, 0.2 * h, style.brand, {250, 250, 250}, 0.25);
  ProceduralObject object{"ball", make_ellipsoid_part({kRadius, kRadius, kRadius}, skin, 64), {}, "textured"};
  atlas.finish(object.mesh);
  stand_on_origin(object.mesh);
  return object;
}

ProceduralObject make_sponge() {
  const TextureStyle style{"", "", 55, 3535};
  const Vector3d size(0.11, 0.07, 0.035);
  TextureAtlas atlas(512, 2.0);
  const auto pores = [&](double w_m, double h_m, std::uint64_t part, Rgb8 color) {
    const PixelRect region = atlas.allocate(w_m * kMmPerM, h_m * kMmPerM);
    TextureCanvas canvas = atlas.canvas(region);
    canvas.fill(color);
    Rng rng = style.stream(part);
    for (int i = 0; i < static_cast<int>(w_m * h_m * 2.5e4); ++i) {
      const double x = rng.uniform(0, canvas.width());
      const double y = rng.uniform(0, canvas.height());
      const double r = rng.uniform(0.6, 3.0);
      const double slimness = rng.uniform(0.5, 1);
      const double value = rng.uniform(0.35, 0.65);
      canvas.ellipse(x, y, r, r * slimness, rng.uniform(0, 3), hsv_color(45, 0.8, value));
    }
    return region;
  };
  const Rgb8 yellow = hsv_color(52, 0.65, 0.95);
  const BoxRegions regions{pores(0.11, 0.035, 1, yellow),
                           pores(0.07, 0.035, 2, yellow),
                           pores(0.11, 0.035, 3, yellow),
                           pores(0.07, 0.035, 4, yellow),
                           pores(0.11, 0.07, 5, hsv_color(140, 0.7, 0.5)),
                           pores(0.11, 0.07, 6, yellow)};
  ProceduralObject object{"sponge", make_rounded_box_part(size, 0.006, regions), {}, "textured"};
  atlas.finish(object.mesh);
  return object;
}

}  // namespace

// The three half turns of a block on z = 0.
ObjectSymmetries block_symmetries(double height_m) {
  ObjectSymmetries symmetries;
  const Rigid3 up = Rigid3::from_translation({0, 0, height_m / 2});
  for (const Vector3d& axis : {Vector3d(Vector3d::UnitX()), Vector3d(Vector3d::UnitY()), Vector3d(Vector3d::UnitZ())})
    symmetries.discrete.push_back(up * Rigid3::from_axis_angle(axis, std::numbers::pi) * up.inverse());
  return symmetries;
}

ProceduralObject make_plain_block(const std::string& name, const Vector3d& size, double radius, Rgb8 color) {
  TextureAtlas atlas(64, 2.0);
  const BoxRegions regions = same_regions(atlas.solid(color));
  ProceduralObject object{name,
                          radius > 0 ? make_rounded_box_part(size, radius, regions) : make_box_part(size, regions),
                          block_symmetries(size.z()), "plain"};
  make_plain(object.mesh, color);
  return object;
}

std::vector<ObjectMaker> toy_makers() {
  return {
      {"toy_car", make_toy_car},
      {"duck", make_duck},
      {"toy_house", make_toy_house},
      {"ball", make_ball},
      {"sponge", make_sponge},
      {"brick",
       [] {
         return make_plain_block("brick", {0.20, 0.095, 0.06}, 0.004, {165, 70, 50});
       }},
      {"plain_box",
       [] {
         return make_plain_block("plain_box", {0.15, 0.11, 0.19}, 0.0, {182, 148, 104});
       }},
  };
}

}  // namespace resight
