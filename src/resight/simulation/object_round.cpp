// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numbers>

#include "resight/simulation/internal/object_makers.hpp"
#include "resight/simulation/internal/object_shapes.hpp"
#include "resight/simulation/mesh_parts.hpp"
#include "resight/simulation/texture_designs.hpp"

namespace resight {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr Rgb8 kSteel{188, 190, 195};

using Profile = std::vector<Vector2d>;

// A straight profile between two points with equal steps, which keeps triangles compact.
Profile straight(const Vector2d& from, const Vector2d& to, int steps) {
  Profile profile;
  for (int i = 0; i <= steps; ++i) profile.push_back(from + (to - from) * (static_cast<double>(i) / steps));
  return profile;
}

// A smooth S curve between two points; the radius has zero slope at both ends.
Profile shoulder(Vector2d from, Vector2d to, int steps) {
  Profile profile;
  for (int i = 0; i <= steps; ++i) {
    const double t = static_cast<double>(i) / steps;
    const double eased = 0.5 - 0.5 * std::cos(std::numbers::pi * t);
    profile.emplace_back(from.x() + (to.x() - from.x()) * eased, from.y() + (to.y() - from.y()) * t);
  }
  return profile;
}

Rigid3 lift(double z) { return Rigid3::from_translation({0, 0, z}); }

void add_print_ring(TextureCanvas canvas, const TextureStyle& style, std::uint64_t part) {
  canvas.fill(kSteel);
  const double r = canvas.width() / 2;
  canvas.ring(r, r, 0.85 * r, 0.06 * r, {140, 142, 148});
  canvas.ring(r, r, 0.6 * r, 0.04 * r, {150, 152, 158});
  Rng rng = style.stream(part);
  canvas.text_in_box(0.6 * r, 0.85 * r, 0.8 * r, 0.3 * r, std::to_string(1000 + rng.below(9000)), {60, 60, 66});
}

}  // namespace

// A tin with a label around it, steel rims and lids.
ProceduralObject make_can(const std::string& name, double radius_m, double height_m, const TextureStyle& style,
                          const std::string& kind) {
  constexpr double kRim = 0.004;
  const double around_mm = 2 * std::numbers::pi * radius_m * kMmPerM;
  TextureAtlas atlas(1024, std::min(4.0, 1000.0 / around_mm));
  const PixelRect label = atlas.allocate(around_mm, (height_m - 2 * kRim) * kMmPerM);
  print_label(atlas.canvas(label), style, 1);
  const PixelRect rim = atlas.solid(kSteel);
  const PixelRect top = atlas.allocate(2 * radius_m * kMmPerM, 2 * radius_m * kMmPerM);
  add_print_ring(atlas.canvas(top), style, 50);
  const PixelRect bottom = atlas.allocate(2 * radius_m * kMmPerM, 2 * radius_m * kMmPerM);
  add_print_ring(atlas.canvas(bottom), style, 51);
  ProceduralObject object{
      name, make_lathe_part(straight({radius_m, height_m - kRim}, {radius_m, kRim}, 16), label), {}, kind};
  TriangleMesh& mesh = object.mesh;
  mesh.append(make_lathe_part(straight({radius_m, height_m}, {radius_m, height_m - kRim}, 2), rim));
  mesh.append(make_lathe_part(straight({radius_m, kRim}, {radius_m, 0}, 2), rim));
  mesh.append(make_disc_part(radius_m, height_m, true, top));
  mesh.append(make_disc_part(radius_m, 0, false, bottom));
  atlas.finish(mesh);
  return object;
}

ProceduralObject make_bottle(const std::string& name, const BottleShape& s, Rgb8 glass, const TextureStyle& style) {
  constexpr double kFoot = 0.012;
  const double around_mm = 2 * std::numbers::pi * s.radius_m * kMmPerM;
  TextureAtlas atlas(1024, std::min(4.0, 1000.0 / around_mm));
  const PixelRect label = atlas.allocate(around_mm, (s.label_top_m - kFoot) * kMmPerM);
  print_label(atlas.canvas(label), style, 1);
  const PixelRect shoulder_print = atlas.allocate(around_mm, (s.shoulder_top_m - s.label_top_m) * kMmPerM);
  TextureCanvas shoulder_canvas = atlas.canvas(shoulder_print);
  shoulder_canvas.fill(glass);
  print_blobs(shoulder_canvas.part(0, 0.55 * shoulder_canvas.height(), around_mm, 0.45 * shoulder_canvas.height()),
              style.stream(40), style.hue_deg + 120, 30, 1.5, 6);
  const PixelRect plain = atlas.solid(glass);
  const PixelRect cap = atlas.solid(style.accent());
  const PixelRect cap_top = atlas.allocate(2 * s.cap_radius_m * kMmPerM, 2 * s.cap_radius_m * kMmPerM);
  print_lid(atlas.canvas(cap_top), style, 41);

  const double cap_bottom = s.height_m - 0.022;
  ProceduralObject object{
      name, make_lathe_part(straight({s.radius_m, s.label_top_m}, {s.radius_m, kFoot}, 16), label), {}, "textured"};
  TriangleMesh& mesh = object.mesh;
  mesh.append(make_lathe_part(straight({s.radius_m, kFoot}, {0.93 * s.radius_m, 0}, 3), plain));
  mesh.append(make_disc_part(0.93 * s.radius_m, 0, false, plain));
  mesh.append(
      make_lathe_part(shoulder({s.neck_radius_m, s.shoulder_top_m}, {s.radius_m, s.label_top_m}, 14), shoulder_print));
  mesh.append(make_lathe_part(straight({s.neck_radius_m, cap_bottom}, {s.neck_radius_m, s.shoulder_top_m}, 4), plain));
  mesh.append(make_disc_part(s.cap_radius_m, cap_bottom, false, cap, s.neck_radius_m));
  mesh.append(make_lathe_part(straight({s.cap_radius_m, s.height_m}, {s.cap_radius_m, cap_bottom}, 4), cap));
  mesh.append(make_disc_part(s.cap_radius_m, s.height_m, true, cap_top));
  if (s.flatness != 1.0) mesh = scaled(std::move(mesh), {1.0, s.flatness, 1.0});
  atlas.finish(mesh);
  return object;
}

// Outside, rim, inside and bottom of a cup or bowl. `outside` is wrapped around it.
TriangleMesh make_cup_part(const CupShape& s, const PixelRect& outside, const PixelRect& inside) {
  TriangleMesh mesh = make_lathe_part(shoulder({s.top_radius_m, s.height_m}, {s.bottom_radius_m, 0}, 16), outside);
  mesh.append(make_disc_part(s.bottom_radius_m, 0, false, inside));
  mesh.append(make_disc_part(s.top_radius_m, s.height_m, true, inside, s.top_radius_m - s.wall_m));
  const double floor_radius = s.bottom_radius_m - s.wall_m;
  mesh.append(make_lathe_part(shoulder({floor_radius, s.wall_m}, {s.top_radius_m - s.wall_m, s.height_m}, 16), inside));
  mesh.append(make_disc_part(floor_radius, s.wall_m, true, inside));
  return mesh;
}

TriangleMesh make_handle(double x_m, double center_z_m, double reach_m, double half_height_m, double radius_m,
                         const PixelRect& region) {
  std::vector<Vector3d> path;
  constexpr int kSteps = 24;
  for (int i = 0; i <= kSteps; ++i) {
    const double angle = -std::numbers::pi / 2 + std::numbers::pi * i / kSteps;
    path.emplace_back(x_m + reach_m * std::cos(angle), 0, center_z_m + half_height_m * std::sin(angle));
  }
  return make_tube_part(path, radius_m, region);
}

namespace {

ProceduralObject make_mug(const std::string& name, bool is_plain, const TextureStyle& style) {
  const CupShape shape = is_plain ? CupShape{0.036, 0.043, 0.088, 0.004} : CupShape{0.041, 0.041, 0.095, 0.004};
  const double around_mm = 2 * std::numbers::pi * 0.041 * kMmPerM;
  TextureAtlas atlas(1024, 3.6);
  const PixelRect outside = atlas.allocate(around_mm, shape.height_m * kMmPerM);
  TextureCanvas canvas = atlas.canvas(outside);
  canvas.fill(style.light());
  print_blobs(canvas, style.stream(1), style.hue_deg, 90, 2.5, 11);
  canvas.text_in_box(0.36 * around_mm, 0.3 * canvas.height(), 0.28 * around_mm, 0.4 * canvas.height(), style.brand,
                     style.dark(), 0.22);
  const PixelRect inside = atlas.solid({238, 236, 228});
  const PixelRect handle = atlas.solid(style.base());
  ProceduralObject object{name, make_cup_part(shape, outside, inside), {}, is_plain ? "plain" : "textured"};
  object.mesh.append(make_handle(shape.bottom_radius_m - 0.001, 0.5 * shape.height_m, 0.03, 0.028, 0.0055, handle));
  atlas.finish(object.mesh);
  if (is_plain) make_plain(object.mesh, {62, 112, 170});
  return object;
}

ProceduralObject make_bowl() {
  TextureAtlas atlas(64, 2.0);
  const PixelRect any = atlas.solid({0, 0, 0});
  ProceduralObject object{"bowl", make_cup_part({0.04, 0.08, 0.06, 0.005}, any, any), {}, "plain"};
  make_plain(object.mesh, {206, 190, 120});
  object.symmetries.continuous.push_back({});
  return object;
}

}  // namespace

// Symmetries of an upright body of revolution that is the same upside down.
ObjectSymmetries cylinder_symmetries(double height_m) {
  ObjectSymmetries symmetries;
  symmetries.continuous.push_back({});
  symmetries.discrete.push_back(lift(height_m / 2) * Rigid3::from_axis_angle(Vector3d::UnitX(), std::numbers::pi) *
                                lift(-height_m / 2));
  return symmetries;
}

namespace {

ProceduralObject make_plain_can() {
  constexpr double kRadius = 0.0375;
  constexpr double kHeight = 0.11;
  TextureAtlas atlas(64, 2.0);
  const PixelRect any = atlas.solid({0, 0, 0});
  ProceduralObject object{"plain_can", make_lathe_part(straight({kRadius, kHeight}, {kRadius, 0}, 16), any),
                          cylinder_symmetries(kHeight), "plain"};
  object.mesh.append(make_disc_part(kRadius, kHeight, true, any));
  object.mesh.append(make_disc_part(kRadius, 0, false, any));
  make_plain(object.mesh, {172, 176, 182});
  return object;
}

ProceduralObject make_paper_roll() {
  constexpr double kRadius = 0.055;
  constexpr double kCore = 0.02;
  constexpr double kHeight = 0.10;
  TextureAtlas atlas(64, 2.0);
  const PixelRect any = atlas.solid({0, 0, 0});
  ProceduralObject object{"paper_roll", make_lathe_part(straight({kRadius, kHeight}, {kRadius, 0}, 14), any),
                          cylinder_symmetries(kHeight), "plain"};
  object.mesh.append(make_lathe_part(straight({kCore, 0}, {kCore, kHeight}, 14), any));
  object.mesh.append(make_disc_part(kRadius, kHeight, true, any, kCore));
  object.mesh.append(make_disc_part(kRadius, 0, false, any, kCore));
  make_plain(object.mesh, {232, 230, 226});
  return object;
}

}  // namespace

std::vector<ObjectMaker> round_makers() {
  return {
      {"soup_tomato",
       [] {
         return make_can("soup_tomato", 0.034, 0.102, {"POMODA", "TOMATO", 8, 1212});
       }},
      {"soup_pea",
       [] {
         return make_can("soup_pea", 0.034, 0.102, {"GRUENA", "PEA SOUP", 95, 1313}, "twin");
       }},
      {"coffee_tin",
       [] {
         return make_can("coffee_tin", 0.051, 0.14, {"MOKARI", "COFFEE", 28, 1414});
       }},
      {"cookie_tin",
       [] {
         return make_can("cookie_tin", 0.095, 0.07, {"BISKA", "COOKIES", 330, 1515});
       }},
      {"water_bottle",
       [] {
         return make_bottle("water_bottle", {0.034, 0.14, 0.19, 0.013, 0.0155, 0.23}, {130, 175, 205},
                            {"AQUILA", "STILL", 205, 1616});
       }},
      {"ketchup",
       [] {
         return make_bottle("ketchup", {0.036, 0.12, 0.155, 0.015, 0.02, 0.185, 0.65}, {170, 28, 24},
                            {"TOMARO", "KETCHUP", 355, 1717});
       }},
      {"detergent",
       [] {
         return make_bottle("detergent", {0.048, 0.17, 0.215, 0.016, 0.02, 0.26, 0.6}, {225, 215, 60},
                            {"LIMPIO", "LEMON", 60, 1818});
       }},
      {"mug",
       [] {
         return make_mug("mug", false, {"HELLO", "", 340, 1919});
       }},
      {"plain_mug",
       [] {
         return make_mug("plain_mug", true, {"", "", 200, 2020});
       }},
      {"bowl", make_bowl},
      {"plain_can", make_plain_can},
      {"paper_roll", make_paper_roll},
  };
}

}  // namespace resight
