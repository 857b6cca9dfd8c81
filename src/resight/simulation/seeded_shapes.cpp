// SPDX-License-Identifier: Apache-2.0
#include "resight/simulation/internal/seeded_shapes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "resight/simulation/internal/object_shapes.hpp"
#include "resight/simulation/mesh_parts.hpp"

namespace resight {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kOverlap_m = 0.002;  // between the parts of a composite object

std::vector<Vector2d> random_profile(Rng& rng, double radius_m, double height_m) {
  std::array<double, 3> amplitude{};
  std::array<double, 3> phase{};
  for (int k = 0; k < 3; ++k) {
    amplitude[k] = rng.uniform(0.05, 0.28) / (k + 1);
    phase[k] = rng.uniform(0, 2 * std::numbers::pi);
  }
  std::vector<Vector2d> profile;
  constexpr int kSteps = 28;
  for (int i = 0; i <= kSteps; ++i) {
    const double t = static_cast<double>(i) / kSteps;
    double factor = 0.8;
    for (int k = 0; k < 3; ++k) factor += amplitude[k] * std::sin((k + 1) * std::numbers::pi * 1.3 * t + phase[k]);
    profile.emplace_back(radius_m * std::clamp(factor, 0.3, 1.15), height_m * (1 - t));
  }
  return profile;
}

// One of several kinds of print.
void print_something(TextureCanvas canvas, const TextureStyle& style, std::uint64_t part) {
  Rng rng = style.stream(900 + part);
  switch (rng.below(4)) {
    case 0:
      canvas.fill(style.base());
      print_blobs(canvas, style.stream(part), style.hue_deg, 20 + static_cast<int>(rng.below(40)), 2, 9);
      break;
    case 1: {
      canvas.fill(style.light());
      const double period_mm = rng.uniform(8, 25);
      canvas.stripes(period_mm, rng.uniform(0, std::numbers::pi), style.accent());
      canvas.text_in_box(0.2 * canvas.width(), 0.3 * canvas.height(), 0.6 * canvas.width(), 0.4 * canvas.height(),
                         style.brand, style.dark(), 0.22);
      break;
    }
    case 2:
      print_front(canvas, style, part);
      break;
    default:
      canvas.gradient(style.base(), style.dark());
      print_emblem(canvas, style.stream(part), 0.5 * canvas.width(), 0.5 * canvas.height(),
                   0.35 * std::min(canvas.width(), canvas.height()), style.hue_deg);
  }
}

PixelRect printed_region(TextureAtlas& atlas, double w_m, double h_m, const TextureStyle& style, std::uint64_t part) {
  const PixelRect region = atlas.allocate(w_m * kMmPerM, h_m * kMmPerM);
  print_something(atlas.canvas(region), style, part);
  return region;
}

TriangleMesh make_piece(TextureAtlas& atlas, Rng& rng, const TextureStyle& style, const Vector3d& size_m,
                        std::uint64_t part) {
  const std::uint32_t shape = rng.below(4);
  const double radius_m = 0.5 * std::min(size_m.x(), size_m.y());
  if (shape == 0) {
    const PixelRect skin =
        printed_region(atlas, std::numbers::pi * size_m.x(), 0.5 * std::numbers::pi * size_m.z(), style, part);
    return moved(make_ellipsoid_part(0.5 * size_m, skin, 32), Rigid3::from_translation({0, 0, 0.5 * size_m.z()}));
  }
  if (shape == 1) {
    const PixelRect side = printed_region(atlas, 2 * std::numbers::pi * radius_m, size_m.z(), style, part);
    const PixelRect lid = printed_region(atlas, 2 * radius_m, 2 * radius_m, style, part + 50);
    const double top_radius_m = radius_m * rng.uniform(0.5, 1);
    const std::array<Vector2d, 2> profile{Vector2d(top_radius_m, size_m.z()), Vector2d(radius_m, 0)};
    TriangleMesh mesh = make_lathe_part(profile, side, 48);
    mesh.append(make_disc_part(top_radius_m, size_m.z(), true, lid, 0, 48));
    mesh.append(make_disc_part(radius_m, 0, false, lid, 0, 48));
    return mesh;
  }
  BoxRegions r;
  r.front = printed_region(atlas, size_m.x(), size_m.z(), style, part);
  r.right = printed_region(atlas, size_m.y(), size_m.z(), style, part + 10);
  r.back = printed_region(atlas, size_m.x(), size_m.z(), style, part + 20);
  r.left = printed_region(atlas, size_m.y(), size_m.z(), style, part + 30);
  r.top = printed_region(atlas, size_m.x(), size_m.y(), style, part + 40);
  r.bottom = atlas.solid(style.dark());
  return shape == 2 ? make_box_part(size_m, r, 8) : make_rounded_box_part(size_m, 0.2 * size_m.minCoeff(), r, 14);
}

}  // namespace

Rgb8 random_paint(Rng& rng) {
  const double hue_deg = rng.uniform(0, 360);
  const double saturation = rng.uniform() < 0.35 ? rng.uniform(0, 0.12) : rng.uniform(0.3, 0.8);
  return hsv_color(hue_deg, saturation, rng.uniform(0.25, 0.92));
}

TextureStyle random_style(Rng& rng) {
  TextureStyle style;
  style.brand = make_word(rng, 2 + static_cast<int>(rng.below(2)));
  style.product = make_word(rng, 2) + " " + make_word(rng, 3);
  style.hue_deg = rng.uniform(0, 360);
  style.seed = rng.next();
  return style;
}

ProceduralObject make_turned_object(const std::string& name, Rng rng, bool is_plain) {
  const double height_m = rng.uniform(0.09, 0.2);
  const double radius_m = rng.uniform(0.032, 0.06);
  const std::vector<Vector2d> profile = random_profile(rng, radius_m, height_m);
  const TextureStyle style = random_style(rng);
  const double around_m = 2 * std::numbers::pi * radius_m;
  TextureAtlas atlas(1024, std::min(4.0, 900 / (around_m * kMmPerM)));
  const PixelRect side = printed_region(atlas, around_m, height_m, style, 1);
  const PixelRect cap = atlas.solid(style.dark());
  ProceduralObject object{name, make_lathe_part(profile, side, 56), {}, is_plain ? "plain" : "textured"};
  object.mesh.append(make_disc_part(profile.front().x(), height_m, true, cap, 0, 56));
  object.mesh.append(make_disc_part(profile.back().x(), 0, false, cap, 0, 56));
  atlas.finish(object.mesh);
  if (!is_plain) return object;
  make_plain(object.mesh, random_paint(rng));
  object.symmetries.continuous.push_back({});
  return object;
}

ProceduralObject make_composite_object(const std::string& name, Rng rng) {
  const TextureStyle style = random_style(rng);
  TextureAtlas atlas(1024, 2.0);
  ProceduralObject object{name, {}, {}, "textured"};
  const double height_m = rng.uniform(0.03, 0.07);
  const double depth_m = rng.uniform(0.06, 0.1);
  Vector3d size(rng.uniform(0.08, 0.15), depth_m, height_m);
  Vector3d at = Vector3d::Zero();
  const int num_parts = 3 + static_cast<int>(rng.below(3));
  for (int i = 0; i < num_parts; ++i) {
    object.mesh.append(
        moved(make_piece(atlas, rng, style, size, 100 * static_cast<std::uint64_t>(i)), Rigid3::from_translation(at)));
    const double shift_x = rng.uniform(-0.25, 0.25) * size.x();
    const double shift_y = rng.uniform(-0.15, 0.15) * size.y();
    at += Vector3d(shift_x, shift_y, size.z() - kOverlap_m);
    const double narrower = rng.uniform(0.55, 0.8);
    const double lower = rng.uniform(0.6, 1.1);
    size = size.cwiseProduct(Vector3d(narrower, narrower, lower)).cwiseMax(0.02);
  }
  atlas.finish(object.mesh);
  stand_on_origin(object.mesh);
  return object;
}

ProceduralObject make_seeded_cup(const std::string& name, Rng rng, bool is_plain) {
  const double bottom_m = rng.uniform(0.03, 0.042);
  const double top_m = bottom_m * rng.uniform(0.95, 1.25);
  const CupShape shape{bottom_m, top_m, rng.uniform(0.075, 0.115), 0.004};
  const TextureStyle style = random_style(rng);
  const double around_m = 2 * std::numbers::pi * std::max(bottom_m, top_m);
  TextureAtlas atlas(1024, std::min(3.4, 1008 / (around_m * kMmPerM)));  // 1008 px: what its gutters leave of a row.
  const PixelRect outside = printed_region(atlas, around_m, shape.height_m, style, 1);
  const PixelRect inside = atlas.solid({236, 234, 228});
  const PixelRect handle = atlas.solid(style.base());
  ProceduralObject object{name, make_cup_part(shape, outside, inside), {}, is_plain ? "plain" : "textured"};
  const double reach_m = rng.uniform(0.022, 0.034);
  object.mesh.append(
      make_handle(bottom_m - 0.001, 0.5 * shape.height_m, reach_m, 0.3 * shape.height_m, 0.0055, handle));
  atlas.finish(object.mesh);
  if (is_plain) make_plain(object.mesh, random_paint(rng));
  return object;
}

ProceduralObject make_seeded_bowl(const std::string& name, Rng rng) {
  TextureAtlas atlas(64, 2.0);
  const PixelRect any = atlas.solid({0, 0, 0});
  const double bottom_m = rng.uniform(0.03, 0.045);
  const double top_m = rng.uniform(0.065, 0.085);
  ProceduralObject object{
      name, make_cup_part({bottom_m, top_m, rng.uniform(0.045, 0.075), 0.005}, any, any), {}, "plain"};
  make_plain(object.mesh, random_paint(rng));
  object.symmetries.continuous.push_back({});
  return object;
}

ProceduralObject make_plain_cylinder(const std::string& name, Rng rng) {
  const double radius_m = rng.uniform(0.028, 0.05);
  const double height_m = rng.uniform(0.07, 0.17);
  TextureAtlas atlas(64, 2.0);
  const PixelRect any = atlas.solid({0, 0, 0});
  std::vector<Vector2d> profile;
  for (int i = 0; i <= 14; ++i) profile.emplace_back(radius_m, height_m * (1 - i / 14.0));
  ProceduralObject object{name, make_lathe_part(profile, any), cylinder_symmetries(height_m), "plain"};
  object.mesh.append(make_disc_part(radius_m, height_m, true, any));
  object.mesh.append(make_disc_part(radius_m, 0, false, any));
  make_plain(object.mesh, random_paint(rng));
  return object;
}

}  // namespace resight
