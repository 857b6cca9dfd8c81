// SPDX-License-Identifier: Apache-2.0
#include "resight/simulation/seeded_objects.hpp"

#include <algorithm>
#include <cctype>
#include <functional>

#include "resight/simulation/internal/object_shapes.hpp"
#include "resight/simulation/internal/seeded_shapes.hpp"

namespace resight {
namespace {

using Eigen::Vector3d;

constexpr std::uint64_t kNameStream = 0x5EED0;
constexpr std::uint64_t kObjectStream = 0x5EED1000;

// What is drawn for an object. Twins and look-alikes share the shape stream or the print stream of another slot.
struct SlotStreams {
  Rng shape;
  Rng print;
  Rng finish;
};

struct Slot {
  const char* family;
  std::function<ProceduralObject(const std::string& name, SlotStreams)> make;
  int shape_of = -1;  ///< Slot whose shape it has; -1 = its own.
  int print_of = -1;  ///< Slot whose print it has; -1 = its own.
};

Vector3d random_size(Rng& rng, const Vector3d& low_m, const Vector3d& high_m) {
  const double x = rng.uniform(low_m.x(), high_m.x());
  const double y = rng.uniform(low_m.y(), high_m.y());
  return {x, y, rng.uniform(low_m.z(), high_m.z())};
}

// Coated board reflects a little, tin and plastic more, glaze most.
SurfaceMaterial random_material(Rng& rng, double max_specular, double min_shininess, double max_shininess) {
  const double specular = rng.uniform(0.1, 1) * max_specular;
  return {.specular = specular, .shininess = rng.uniform(min_shininess, max_shininess)};
}

// Prints of real packages are less pure than those that the designs draw.
void fade(TriangleMesh& mesh, Rng& rng) {
  const double purity = rng.uniform(0.45, 1.05);
  const double depth = rng.uniform(0.8, 1);
  const auto faded = [&](Rgb8 c) {
    const double grey = 0.3 * c.r + 0.59 * c.g + 0.11 * c.b;
    const auto mix = [&](double x) {
      return static_cast<std::uint8_t>(std::clamp(depth * (grey + purity * (x - grey)) + 0.5, 0.0, 255.0));
    };
    return Rgb8{mix(c.r), mix(c.g), mix(c.b)};
  };
  for (Rgb8& c : mesh.texture.data()) c = faded(c);
}

ProceduralObject finished(ProceduralObject object, SlotStreams streams, double max_specular, double min_shininess,
                          double max_shininess) {
  fade(object.mesh, streams.finish);
  object.material = random_material(streams.finish, max_specular, min_shininess, max_shininess);
  return object;
}

auto box_slot(const Vector3d& low_m, const Vector3d& high_m, const char* kind) {
  return [=](const std::string& name, SlotStreams s) {
    const Vector3d size = random_size(s.shape, low_m, high_m);
    return finished(make_package(name, size, random_style(s.print), kind), s, 0.35, 15, 70);
  };
}

auto can_slot(double min_height_m, double max_height_m, const char* kind) {
  return [=](const std::string& name, SlotStreams s) {
    const double radius_m = s.shape.uniform(0.03, 0.055);
    const double height_m = s.shape.uniform(min_height_m, max_height_m);
    return finished(make_can(name, radius_m, height_m, random_style(s.print), kind), s, 0.8, 40, 200);
  };
}

ProceduralObject make_flat_package(const std::string& name, SlotStreams s) {
  const Vector3d size = random_size(s.shape, {0.13, 0.09, 0.018}, {0.26, 0.17, 0.06});
  return finished(make_lying_package(name, size, random_style(s.print)), s, 0.3, 15, 60);
}

ProceduralObject make_seeded_book(const std::string& name, SlotStreams s) {
  const Vector3d size = random_size(s.shape, {0.11, 0.16, 0.01}, {0.18, 0.25, 0.035});
  return finished(make_book(name, size, random_style(s.print)), s, 0.3, 15, 60);
}

ProceduralObject make_seeded_carton(const std::string& name, SlotStreams s) {
  const double width_m = s.shape.uniform(0.065, 0.095);
  const double height_m = s.shape.uniform(0.12, 0.19);
  const double roof_m = s.shape.uniform(0.028, 0.042);
  return finished(make_carton(name, width_m, height_m, roof_m, random_style(s.print)), s, 0.35, 15, 60);
}

BottleShape random_bottle(Rng& rng) {
  const double radius_m = rng.uniform(0.03, 0.048);
  const double height_m = rng.uniform(0.17, 0.27);
  const double neck_m = rng.uniform(0.011, 0.016);
  const double label_top_m = rng.uniform(0.52, 0.66) * height_m;
  return {.radius_m = radius_m,
          .label_top_m = label_top_m,
          .shoulder_top_m = rng.uniform(0.8, 0.86) * height_m,
          .neck_radius_m = neck_m,
          .cap_radius_m = neck_m + 0.003,
          .height_m = height_m,
          .flatness = rng.uniform() < 0.5 ? 1.0 : rng.uniform(0.55, 0.8)};
}

ProceduralObject make_seeded_bottle(const std::string& name, SlotStreams s) {
  const BottleShape shape = random_bottle(s.shape);
  const TextureStyle style = random_style(s.print);
  return finished(make_bottle(name, shape, random_paint(s.print), style), s, 0.8, 30, 150);
}

// Glass with a small label: it shines, and the depth camera gets almost no return.
ProceduralObject make_clear_bottle(const std::string& name, SlotStreams s) {
  BottleShape shape = random_bottle(s.shape);
  shape.flatness = 1;
  const TextureStyle style = random_style(s.print);
  const Rgb8 glass = hsv_color(s.print.uniform(80, 220), 0.25, 0.75);
  ProceduralObject object = finished(make_bottle(name, shape, glass, style), s, 1, 30, 150);
  object.material = {.specular = 1.5, .shininess = 250, .depth_return = 0.12};
  return object;
}

// For makers that draw shape and print from one stream.
auto one_stream(ProceduralObject (*make)(const std::string&, Rng), double max_specular, double min_shininess,
                double max_shininess) {
  return [=](const std::string& name, SlotStreams s) {
    return finished(make(name, s.shape), s, max_specular, min_shininess, max_shininess);
  };
}

ProceduralObject make_block(const std::string& name, SlotStreams s) {
  const Vector3d size = random_size(s.shape, {0.09, 0.06, 0.04}, {0.2, 0.12, 0.16});
  const double radius_m = s.shape.uniform() < 0.5 ? 0.0 : 0.005;
  return finished(make_plain_block(name, size, radius_m, random_paint(s.print)), s, 0.1, 10, 30);
}

const std::vector<Slot>& known_slots() {
  static const auto printed_cup = [](const std::string& name, Rng rng) { return make_seeded_cup(name, rng, false); };
  static const auto plain_cup = [](const std::string& name, Rng rng) { return make_seeded_cup(name, rng, true); };
  static const auto turned = [](const std::string& name, Rng rng) { return make_turned_object(name, rng, false); };
  static const auto plain_turned = [](const std::string& name, Rng rng) { return make_turned_object(name, rng, true); };
  static const Vector3d kTallLow(0.1, 0.045, 0.17), kTallHigh(0.2, 0.08, 0.29);
  static const Vector3d kLow(0.08, 0.05, 0.06), kHigh(0.17, 0.09, 0.15);
  static const Vector3d kSmallLow(0.035, 0.025, 0.03), kSmallHigh(0.06, 0.04, 0.05);
  static const std::vector<Slot> slots{
      {"box", box_slot(kTallLow, kTallHigh, "textured")},           // 0
      {"box", box_slot(kTallLow, kTallHigh, "twin"), 0},            // 1: twin of 0
      {"box", box_slot(kTallLow, kTallHigh, "textured")},           // 2
      {"box", box_slot(kLow, kHigh, "textured")},                   // 3
      {"box", box_slot(kLow, kHigh, "textured")},                   // 4
      {"small", box_slot(kSmallLow, kSmallHigh, "textured")},       // 5
      {"flat", make_flat_package},                                  // 6
      {"flat", make_flat_package},                                  // 7
      {"book", make_seeded_book},                                   // 8
      {"book", make_seeded_book},                                   // 9
      {"carton", make_seeded_carton},                               // 10
      {"can", can_slot(0.08, 0.13, "textured")},                    // 11
      {"can", can_slot(0.08, 0.13, "twin"), 11},                    // 12: twin of 11
      {"can", can_slot(0.05, 0.09, "textured")},                    // 13
      {"can", can_slot(0.12, 0.2, "textured")},                     // 14
      {"bottle", make_seeded_bottle},                               // 15
      {"bottle", make_seeded_bottle},                               // 16
      {"clear", make_clear_bottle},                                 // 17
      {"cup", one_stream(printed_cup, 1.0, 100, 300)},              // 18
      {"cup", one_stream(plain_cup, 1.0, 100, 300)},                // 19
      {"bowl", one_stream(make_seeded_bowl, 1.0, 80, 300)},         // 20
      {"cylinder", one_stream(make_plain_cylinder, 0.5, 20, 100)},  // 21
      {"block", make_block},                                        // 22
      {"figure", one_stream(turned, 0.6, 20, 150)},                 // 23
      {"figure", one_stream(plain_turned, 0.6, 20, 150)},           // 24
      {"toy", one_stream(make_composite_object, 0.5, 20, 120)},     // 25
      {"toy", one_stream(make_composite_object, 0.5, 20, 120)},     // 26
      {"toy", one_stream(make_composite_object, 0.5, 20, 120)},     // 27
  };
  return slots;
}

const std::vector<Slot>& unknown_slots() {
  static const auto turned = [](const std::string& name, Rng rng) { return make_turned_object(name, rng, false); };
  static const auto plain_cup = [](const std::string& name, Rng rng) { return make_seeded_cup(name, rng, true); };
  static const Vector3d kTallLow(0.1, 0.045, 0.17), kTallHigh(0.2, 0.08, 0.29);
  static const Vector3d kLow(0.08, 0.05, 0.06), kHigh(0.17, 0.09, 0.15);
  static const std::vector<Slot> slots{
      {"box", box_slot(kTallLow, kTallHigh, "textured"), 2},  // the shape of a known box
      {"box", box_slot(kLow, kHigh, "textured"), -1, 3},      // the print of a known box
      {"can", can_slot(0.12, 0.2, "textured"), 14},           // the shape of a known can
      {"cup", one_stream(plain_cup, 1.0, 100, 300)},
      {"book", make_seeded_book},
      {"bottle", make_seeded_bottle},
      {"clear", make_clear_bottle},
      {"figure", one_stream(turned, 0.6, 20, 150)},
      {"block", make_block},
      {"toy", one_stream(make_composite_object, 0.5, 20, 120)},
      {"toy", one_stream(make_composite_object, 0.5, 20, 120)},
  };
  return slots;
}

// Names are unique within a seed: a word that occurs twice is drawn again.
std::vector<std::string> draw_names(const std::vector<Slot>& slots, Rng& rng, std::vector<std::string> taken) {
  std::vector<std::string> names;
  for (const Slot& slot : slots) {
    std::string name;
    do {
      name = make_word(rng, 2);
      std::ranges::transform(name, name.begin(),
                             [](char c) { return static_cast<char>(std::tolower(static_cast<unsigned char>(c))); });
      name.insert(0, std::string(slot.family) + "_");
    } while (std::ranges::find(taken, name) != taken.end());
    taken.push_back(name);
    names.push_back(name);
  }
  return names;
}

ProceduralObject make_slot(const Slot& slot, const std::string& name, std::uint64_t seed, std::uint64_t index) {
  const auto stream = [&](int shared, std::uint64_t purpose) {
    const std::uint64_t own = shared < 0 ? index : static_cast<std::uint64_t>(shared);
    return Rng::stream(seed, kObjectStream + 4 * own + purpose);
  };
  return slot.make(name, {stream(slot.shape_of, 0), stream(slot.print_of, 1), stream(-1, 2)});
}

}  // namespace

SeededObjectNames seeded_object_names(std::uint64_t seed) {
  Rng rng = Rng::stream(seed, kNameStream);
  SeededObjectNames names;
  names.known = draw_names(known_slots(), rng, {});
  names.unknown = draw_names(unknown_slots(), rng, names.known);
  return names;
}

Result<ProceduralObject> make_seeded_object(std::uint64_t seed, std::string_view name) {
  const SeededObjectNames names = seeded_object_names(seed);
  const auto find_in = [&](const std::vector<std::string>& list) { return std::ranges::find(list, name); };
  if (const auto found = find_in(names.known); found != names.known.end()) {
    const auto i = static_cast<std::size_t>(found - names.known.begin());
    return make_slot(known_slots()[i], *found, seed, i);
  }
  if (const auto found = find_in(names.unknown); found != names.unknown.end()) {
    const auto i = static_cast<std::size_t>(found - names.unknown.begin());
    return make_slot(unknown_slots()[i], *found, seed, known_slots().size() + i);
  }
  return Error{"seed " + std::to_string(seed) + " makes no object '" + std::string(name) + "'"};
}

}  // namespace resight
