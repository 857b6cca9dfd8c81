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

// Allocates regions of the six sides of a box, in the order in which they are painted.
BoxRegions allocate_box(TextureAtlas& atlas, const Vector3d& size_m) {
  const Vector3d mm = size_m * kMmPerM;
  BoxRegions r;
  r.front = atlas.allocate(mm.x(), mm.z());
  r.right = atlas.allocate(mm.y(), mm.z());
  r.back = atlas.allocate(mm.x(), mm.z());
  r.left = atlas.allocate(mm.y(), mm.z());
  r.top = atlas.allocate(mm.x(), mm.y());
  r.bottom = atlas.allocate(mm.x(), mm.y());
  return r;
}

// Pixels per millimetre such that the unfolded box fills an atlas of about 1000 px width.
double box_scale(const Vector3d& size_m) {
  const double strip_mm = 2 * (size_m.x() + size_m.y()) * kMmPerM;
  return std::min(4.0, (1024.0 - 5 * 16) / strip_mm);
}

}  // namespace

ProceduralObject make_package(const std::string& name, const Vector3d& size_m, const TextureStyle& style,
                              const std::string& kind) {
  TextureAtlas atlas(1024, box_scale(size_m));
  const BoxRegions r = allocate_box(atlas, size_m);
  print_front(atlas.canvas(r.front), style, 1);
  print_side(atlas.canvas(r.right), style, 2);
  print_back(atlas.canvas(r.back), style, 3);
  print_side(atlas.canvas(r.left), style, 4);
  print_lid(atlas.canvas(r.top), style, 5);
  print_back(atlas.canvas(r.bottom), style, 6);
  ProceduralObject object{name, make_box_part(size_m, r), {}, kind};
  atlas.finish(object.mesh);
  return object;
}

// A flat package on its back, with the front on top.
ProceduralObject make_lying_package(const std::string& name, const Vector3d& size_m, const TextureStyle& style) {
  TextureAtlas atlas(1024, box_scale(size_m));
  const BoxRegions r = allocate_box(atlas, size_m);
  print_lid(atlas.canvas(r.front), style, 1);
  print_lid(atlas.canvas(r.right), style, 2);
  print_lid(atlas.canvas(r.back), style, 3);
  print_lid(atlas.canvas(r.left), style, 4);
  print_front(atlas.canvas(r.top), style, 5);
  print_back(atlas.canvas(r.bottom), style, 6);
  ProceduralObject object{name, make_box_part(size_m, r), {}, "textured"};
  atlas.finish(object.mesh);
  return object;
}

namespace {

void print_pages(TextureCanvas canvas, Rng rng) {
  canvas.fill({236, 230, 214});
  for (double y = 0; y < canvas.height(); y += 0.9) {
    const auto grey = static_cast<std::uint8_t>(195 + rng.below(40));
    canvas.rect(0, y, canvas.width(), 0.4, {grey, grey, static_cast<std::uint8_t>(grey - 12)});
  }
}

}  // namespace

// A book on its back cover, with the spine to the left (-x).
ProceduralObject make_book(const std::string& name, const Vector3d& size_m, const TextureStyle& style) {
  TextureAtlas atlas(1024, box_scale(size_m));
  const BoxRegions r = allocate_box(atlas, size_m);
  print_pages(atlas.canvas(r.front), style.stream(1));
  print_pages(atlas.canvas(r.right), style.stream(2));
  print_pages(atlas.canvas(r.back), style.stream(3));
  TextureCanvas spine = atlas.canvas(r.left);
  spine.fill(style.dark());
  spine.text_in_box(0.05 * spine.width(), 0.15 * spine.height(), 0.6 * spine.width(), 0.7 * spine.height(), style.brand,
                    style.light());
  print_emblem(spine, style.stream(4), 0.85 * spine.width(), 0.5 * spine.height(), 0.35 * spine.height(),
               style.hue_deg);
  print_front(atlas.canvas(r.top), style, 5);
  print_back(atlas.canvas(r.bottom), style, 6);
  ProceduralObject object{name, make_box_part(size_m, r), {}, "textured"};
  atlas.finish(object.mesh);
  return object;
}

// A carton with a gable: a box, two slanted roofs, two triangles and a fin.
ProceduralObject make_carton(const std::string& name, double width_m, double box_height_m, double roof_height_m,
                             const TextureStyle& style) {
  const Vector3d box_size(width_m, width_m, box_height_m);
  TextureAtlas atlas(1024, box_scale(box_size));
  BoxRegions r = allocate_box(atlas, box_size);
  print_front(atlas.canvas(r.front), style, 1);
  print_side(atlas.canvas(r.right), style, 2);
  print_back(atlas.canvas(r.back), style, 3);
  print_side(atlas.canvas(r.left), style, 4);
  print_lid(atlas.canvas(r.top), style, 5);
  print_back(atlas.canvas(r.bottom), style, 6);
  ProceduralObject object{name, make_box_part(box_size, r), {}, "textured"};

  // The roof is a prism along x with a triangular cross-section (y, z), so a prism along z is laid on its side.
  const double roof_length = std::hypot(width_m / 2, roof_height_m);
  const PixelRect roof = atlas.allocate((width_m + 2 * roof_length) * kMmPerM, width_m * kMmPerM);
  TextureCanvas roof_canvas = atlas.canvas(roof);
  roof_canvas.fill(style.base());
  print_blobs(roof_canvas, style.stream(7), style.hue_deg + 180, 40, 2, 9);
  const PixelRect gable = atlas.allocate(width_m * kMmPerM, roof_height_m * kMmPerM);
  atlas.canvas(gable).fill(style.light());
  print_blobs(atlas.canvas(gable), style.stream(8), style.hue_deg + 60, 25, 2, 7);
  const std::vector<Vector2d> triangle{{-width_m / 2, 0}, {width_m / 2, 0}, {0, roof_height_m}};
  Rigid3 carton_from_prism;
  carton_from_prism.rotation << 0, 0, 1, 1, 0, 0, 0, 1, 0;  // prism x, y, z become carton y, z, x
  carton_from_prism.translation = Vector3d(-width_m / 2, 0, box_height_m);
  object.mesh.append(moved(make_prism_part(triangle, width_m, roof, gable, gable), carton_from_prism));
  const PixelRect fin = atlas.allocate(width_m * kMmPerM, 15);
  atlas.canvas(fin).fill(style.accent());
  object.mesh.append(moved(make_box_part({width_m, 0.004, 0.022}, {fin, fin, fin, fin, fin, fin}, 4),
                           Rigid3::from_translation({0, 0, box_height_m + roof_height_m - 0.006})));
  atlas.finish(object.mesh);
  return object;
}

namespace {

ProceduralObject make_gift_box() {
  const TextureStyle style{"JUBILO", "GIFT", 300, 4711};
  constexpr double kRadius = 0.06;
  constexpr double kHeight = 0.09;
  std::vector<Vector2d> hexagon;
  for (int i = 0; i < 6; ++i)
    hexagon.emplace_back(kRadius * std::cos(std::numbers::pi * i / 3), kRadius * std::sin(std::numbers::pi * i / 3));
  TextureAtlas atlas(1024, 2.5);
  const PixelRect side = atlas.allocate(6 * kRadius * kMmPerM, kHeight * kMmPerM);
  const PixelRect top = atlas.allocate(2 * kRadius * kMmPerM, std::sqrt(3.0) * kRadius * kMmPerM);
  const PixelRect bottom = atlas.allocate(2 * kRadius * kMmPerM, std::sqrt(3.0) * kRadius * kMmPerM);
  for (int i = 0; i < 6; ++i) {
    TextureCanvas canvas = atlas.canvas(side).part(i * kRadius * kMmPerM, 0, kRadius * kMmPerM, kHeight * kMmPerM);
    canvas.fill(i % 2 == 0 ? style.base() : style.accent());
    print_blobs(canvas, style.stream(10 + i), style.hue_deg + 60 * i, 16, 2, 10);
    canvas.text_in_box(4, 32, kRadius * kMmPerM - 8, 22, std::string(1, "JUBILO"[i]), style.light(), 0.2);
  }
  print_lid(atlas.canvas(top), style, 20);
  print_back(atlas.canvas(bottom), style, 21);
  ProceduralObject object{"gift_box", make_prism_part(hexagon, kHeight, side, top, bottom), {}, "textured"};
  atlas.finish(object.mesh);
  return object;
}

}  // namespace

std::vector<ObjectMaker> package_makers() {
  return {
      {"cereal_red",
       [] {
         return make_package("cereal_red", {0.19, 0.065, 0.28}, {"KRUNCHO", "HONEY RINGS", 2, 101});
       }},
      {"cereal_blue",
       [] {
         return make_package("cereal_blue", {0.19, 0.065, 0.28}, {"MAZIBA", "COCOA STARS", 215, 202}, "twin");
       }},
      {"tea_box",
       [] {
         return make_package("tea_box", {0.13, 0.075, 0.07}, {"TEAVIRA", "GREEN TEA", 110, 303});
       }},
      {"medicine_box",
       [] {
         return make_package("medicine_box", {0.12, 0.045, 0.065}, {"DOLOFIN", "400 MG", 185, 404});
       }},
      {"cracker_box",
       [] {
         return make_package("cracker_box", {0.16, 0.06, 0.21}, {"SALTINO", "CRACKERS", 38, 505});
       }},
      {"tissue_box",
       [] {
         return make_lying_package("tissue_box", {0.23, 0.12, 0.08}, {"SOFTELA", "100 TISSUES", 275, 606});
       }},
      {"puzzle_box",
       [] {
         return make_lying_package("puzzle_box", {0.27, 0.19, 0.045}, {"ZEBULON", "PUZZLE 500", 75, 707});
       }},
      {"milk_carton",
       [] {
         return make_carton("milk_carton", 0.075, 0.17, 0.035, {"ALPINA", "WHOLE MILK", 200, 808});
       }},
      {"juice_carton",
       [] {
         return make_carton("juice_carton", 0.09, 0.15, 0.04, {"FRUTELA", "ORANGE", 25, 909});
       }},
      {"novel",
       [] {
         return make_book("novel", {0.13, 0.20, 0.032}, {"NIGHT", "A STORY", 240, 111});
       }},
      {"atlas",
       [] {
         return make_book("atlas", {0.22, 0.29, 0.022}, {"WORLD", "MAPS & SEAS", 150, 222});
       }},
      {"gift_box", make_gift_box},
  };
}

}  // namespace resight
