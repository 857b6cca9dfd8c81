// SPDX-License-Identifier: Apache-2.0
#include "resight/simulation/room.hpp"

#include <algorithm>

#include "resight/core/check.hpp"
#include "resight/core/random.hpp"
#include "resight/simulation/mesh_parts.hpp"
#include "resight/simulation/texture_designs.hpp"

namespace resight {
namespace {

using Eigen::Vector3d;

constexpr double kBoard_m = 0.025;

BoxRegions all_sides(const PixelRect& r) { return {r, r, r, r, r, r}; }

TriangleMesh box_at(const Vector3d& size, const BoxRegions& regions, const Vector3d& bottom_center, int cells = 2) {
  return moved(make_box_part(size, regions, cells), Rigid3::from_translation(bottom_center));
}

struct WoodTones {
  Rgb8 light, dark;
};

WoodTones random_wood(Rng& rng) {
  const double hue = rng.uniform(22, 38);
  const double saturation = rng.uniform(0.3, 0.5);
  return {hsv_color(hue, saturation, rng.uniform(0.7, 0.85)), hsv_color(hue - 4, saturation + 0.15, 0.45)};
}

PixelRect wood_region(TextureAtlas& atlas, double w_m, double h_m, const Rng& rng, const WoodTones& tones,
                      double plank_mm) {
  const PixelRect region = atlas.allocate(w_m * kMmPerM, h_m * kMmPerM);
  print_wood(atlas.canvas(region), rng, tones.light, tones.dark, plank_mm);
  return region;
}

Furniture make_table(const Vector3d& size, std::uint64_t seed) {
  Rng rng(seed);
  const WoodTones tones = random_wood(rng);
  TextureAtlas atlas(1024, 1000.0 / (std::max(size.x(), size.y()) * kMmPerM));
  BoxRegions top = all_sides(wood_region(atlas, size.x(), 0.04, Rng::stream(seed, 1), tones, 40));
  top.top = wood_region(atlas, size.x(), size.y(), Rng::stream(seed, 2), tones, 130);
  const BoxRegions leg = all_sides(wood_region(atlas, 0.1, size.z(), Rng::stream(seed, 3), tones, 60));
  Furniture table{box_at({size.x(), size.y(), kBoard_m}, top, {0, 0, size.z() - kBoard_m}), {size.z()}};
  for (const double x : {-0.5, 0.5})
    for (const double y : {-0.5, 0.5})
      table.mesh.append(
          box_at({0.05, 0.05, size.z() - kBoard_m}, leg, {x * (size.x() - 0.08), y * (size.y() - 0.08), 0}));
  atlas.finish(table.mesh);
  return table;
}

Furniture make_shelf(const Vector3d& size, std::uint64_t seed) {
  constexpr int kBoards = 4;
  Rng rng(seed);
  const WoodTones tones = random_wood(rng);
  TextureAtlas atlas(1024, 0.5);
  const BoxRegions board = all_sides(wood_region(atlas, size.x(), size.y(), Rng::stream(seed, 1), tones, 90));
  const BoxRegions side = all_sides(wood_region(atlas, size.y(), size.z(), Rng::stream(seed, 2), tones, 150));
  const BoxRegions back = all_sides(wood_region(atlas, size.x(), size.z(), Rng::stream(seed, 3), tones, 120));
  Furniture shelf;
  for (const double x : {-0.5, 0.5})
    shelf.mesh.append(box_at({kBoard_m, size.y(), size.z()}, side, {x * (size.x() - kBoard_m), 0, 0}));
  shelf.mesh.append(box_at({size.x() - 2 * kBoard_m, 0.01, size.z()}, back, {0, 0.5 * size.y() - 0.005, 0}));
  for (int i = 0; i < kBoards; ++i) {
    const double top = kBoard_m + (size.z() - kBoard_m) * i / (kBoards - 1);
    shelf.mesh.append(box_at({size.x() - 2 * kBoard_m, size.y() - 0.01, kBoard_m}, board, {0, -0.005, top - kBoard_m}));
    shelf.level_heights_m.push_back(top);
  }
  atlas.finish(shelf.mesh);
  return shelf;
}

Furniture make_cabinet(const Vector3d& size, std::uint64_t seed) {
  Rng rng(seed);
  const Rgb8 paint = hsv_color(rng.uniform(0, 360), 0.15, 0.8);
  TextureAtlas atlas(1024, 0.4);
  const PixelRect plain = atlas.allocate(size.x() * kMmPerM, size.z() * kMmPerM);
  atlas.canvas(plain).fill(paint);
  print_grain(atlas.canvas(plain), Rng::stream(seed, 1), paint, 300, 5, 30);
  BoxRegions regions = all_sides(plain);
  regions.front = atlas.allocate(size.x() * kMmPerM, size.z() * kMmPerM);
  TextureCanvas front = atlas.canvas(regions.front);
  front.fill(paint);
  const double drawer = front.height() / 3;
  for (int i = 0; i < 3; ++i) {
    front.rect(15, i * drawer + 12, front.width() - 30, 4, {90, 90, 90});
    front.rounded_rect(front.width() / 2 - 70, (i + 0.45) * drawer, 140, 22, 10, {70, 70, 75});
  }
  Furniture cabinet{make_box_part(size, regions, 4), {size.z()}};
  atlas.finish(cabinet.mesh);
  return cabinet;
}

Furniture make_monitor(const Vector3d& size, std::uint64_t seed) {
  TextureAtlas atlas(1024, std::min(1.5, 900 / (size.x() * kMmPerM)));
  const BoxRegions black = all_sides(atlas.solid({35, 36, 40}));
  BoxRegions panel = black;
  panel.front = atlas.allocate(size.x() * kMmPerM, 0.75 * size.z() * kMmPerM);
  TextureCanvas screen = atlas.canvas(panel.front);
  screen.fill({35, 36, 40});
  TextureCanvas page = screen.part(14, 14, screen.width() - 28, screen.height() - 34);
  page.fill({225, 230, 236});
  page.rect(0, 0, page.width(), 16, {50, 90, 150});
  print_paragraph(page, Rng::stream(seed, 1), 12, 28, 0.55 * page.width(), page.height() - 40, 7, {50, 55, 70});
  print_blobs(page.part(0.62 * page.width(), 28, 0.34 * page.width(), page.height() - 44), Rng::stream(seed, 2), 210,
              26, 4, 22);
  Furniture monitor{box_at({size.x(), 0.03, 0.75 * size.z()}, panel, {0, 0.02, 0.25 * size.z()}, 6), {}};
  monitor.mesh.append(box_at({0.06, 0.03, 0.5 * size.z()}, black, {0, 0.05, 0.01}));
  monitor.mesh.append(box_at({0.4 * size.x(), size.y(), 0.012}, black, {0, 0, 0}));
  atlas.finish(monitor.mesh);
  return monitor;
}

Furniture make_keyboard(const Vector3d& size, std::uint64_t seed) {
  TextureAtlas atlas(1024, std::min(2.2, 1000 / (size.x() * kMmPerM)));
  BoxRegions regions = all_sides(atlas.solid({50, 50, 55}));
  regions.top = atlas.allocate(size.x() * kMmPerM, size.y() * kMmPerM);
  TextureCanvas top = atlas.canvas(regions.top);
  top.fill({50, 50, 55});
  Rng rng(seed);
  const double key = (top.height() - 12) / 5;
  for (int row = 0; row < 5; ++row)
    for (double x = 6 + 4 * row; key > 0 && x + key < top.width() - 6; x += key) {
      top.rounded_rect(x + 1, 6 + row * key + 1, key - 2, key - 2, 2, {205, 205, 200});
      top.text(x + 0.3 * key, 6 + (row + 0.28) * key, 0.4 * key, 0.08 * key,
               std::string(1, static_cast<char>('A' + rng.below(26))), {40, 40, 45});
    }
  Furniture keyboard{make_box_part(size, regions, 4), {}};
  atlas.finish(keyboard.mesh);
  return keyboard;
}

Furniture make_papers(const Vector3d& size, std::uint64_t seed) {
  TextureAtlas atlas(1024, std::min(3.0, 1000 / (size.x() * kMmPerM)));
  BoxRegions regions = all_sides(atlas.solid({222, 220, 212}));
  regions.top = atlas.allocate(size.x() * kMmPerM, size.y() * kMmPerM);
  TextureCanvas top = atlas.canvas(regions.top);
  top.fill({240, 240, 236});
  top.text_in_box(15, 12, top.width() - 30, 18, "REPORT", {30, 30, 50});
  print_paragraph(top, Rng::stream(seed, 1), 15, 40, top.width() - 30, top.height() - 55, 4.5, {60, 60, 66});
  Furniture papers{make_box_part(size, regions, 4), {size.z()}};
  atlas.finish(papers.mesh);
  return papers;
}

void paint_wall(TextureCanvas canvas, Rng rng, Rgb8 paint, std::uint64_t seed) {
  canvas.fill(paint);
  print_grain(canvas, rng, paint, 900, 8, 60);
  for (int i = 0; i < 3; ++i) {  // pictures
    const double w = rng.uniform(300, 600);
    const double h = rng.uniform(300, 600);
    const double x = (i + 0.5) / 3 * canvas.width() - w / 2;
    const double y = rng.uniform(0.25, 0.45) * canvas.height();
    canvas.rect(x - 25, y - 25, w + 50, h + 50, {60, 45, 35});
    TextureCanvas picture = canvas.part(x, y, w, h);
    const double hue_below_deg = rng.uniform(0, 360);
    const double hue_above_deg = rng.uniform(0, 360);
    picture.gradient(hsv_color(hue_above_deg, 0.4, 0.9), hsv_color(hue_below_deg, 0.5, 0.6));
    print_blobs(picture, Rng::stream(seed, 70 + i), rng.uniform(0, 360), 30, 10, 90);
  }
}

}  // namespace

const std::vector<std::string>& furniture_kinds() {
  static const std::vector<std::string> kinds{"table", "shelf", "cabinet", "monitor", "keyboard", "papers"};
  return kinds;
}

Result<Furniture> make_furniture(std::string_view kind, const Vector3d& size_m, std::uint64_t seed) {
  require(size_m.allFinite() && size_m.minCoeff() > 0 && size_m.maxCoeff() <= kMaxFurnitureSize_m,
          "make_furniture: size_m must be > 0 and at most kMaxFurnitureSize_m");
  if (kind == "table") return make_table(size_m, seed);
  if (kind == "shelf") return make_shelf(size_m, seed);
  if (kind == "cabinet") return make_cabinet(size_m, seed);
  if (kind == "monitor") return make_monitor(size_m, seed);
  if (kind == "keyboard") return make_keyboard(size_m, seed);
  if (kind == "papers") return make_papers(size_m, seed);
  std::string known;
  for (const std::string& k : furniture_kinds()) known += (known.empty() ? "" : ", ") + k;
  return Error{"no furniture of kind '" + std::string(kind) + "' (known: " + known + ")"};
}

TriangleMesh make_room(const Vector3d& size_m, std::uint64_t seed) {
  require(size_m.allFinite() && size_m.minCoeff() > 0, "make_room: size_m must be > 0");
  Rng rng(seed);
  TextureAtlas atlas(1024, 1000.0 / (size_m.maxCoeff() * kMmPerM));
  BoxRegions r;
  const Rgb8 paint = hsv_color(rng.uniform(0, 360), 0.12, 0.85);
  std::uint64_t wall = 10;
  for (PixelRect* region : {&r.front, &r.right, &r.back, &r.left}) {
    const bool along_x = region == &r.front || region == &r.back;
    *region = atlas.allocate((along_x ? size_m.x() : size_m.y()) * kMmPerM, size_m.z() * kMmPerM);
    paint_wall(atlas.canvas(*region), Rng::stream(seed, wall), paint, seed + wall);
    ++wall;
  }
  const WoodTones tones = random_wood(rng);
  r.bottom = wood_region(atlas, size_m.x(), size_m.y(), Rng::stream(seed, 2), tones, 180);
  r.top = atlas.solid({235, 235, 232});
  TriangleMesh room = make_box_part(size_m, r, 6);
  // Flips the faces, because a room is seen from inside.
  for (auto& f : room.faces) std::swap(f[1], f[2]);
  for (auto& n : room.normals) n = -n;
  atlas.finish(room);
  return room;
}

}  // namespace resight
