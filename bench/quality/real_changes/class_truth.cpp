// SPDX-License-Identifier: Apache-2.0
#include "class_truth.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "resight/core/statistics.hpp"
#include "resight/io/images.hpp"

namespace resight::bench {
namespace {

constexpr int kBorder_px = 2;
constexpr double kMinRise_m = 0.005;
constexpr double kMinOverlap = 0.9;

// Whether another class lies within kBorder_px rows and columns.
bool is_at_border(const ClassImage& classes, int u, int v) {
  for (int row = std::max(0, v - kBorder_px); row <= std::min(classes.height() - 1, v + kBorder_px); ++row)
    for (int column = std::max(0, u - kBorder_px); column <= std::min(classes.width() - 1, u + kBorder_px); ++column)
      if (classes(column, row) != classes(u, v)) return true;
  return false;
}

// Pixels with depth in both views and away from borders of classes.
Mask find_valid_pixels(const LabelledView& before, const LabelledView& after) {
  Mask valid(before.classes.width(), before.classes.height());
  for (int v = 0; v < valid.height(); ++v)
    for (int u = 0; u < valid.width(); ++u)
      valid(u, v) = !std::isnan(before.frame.depth_m(u, v)) && !std::isnan(after.frame.depth_m(u, v)) &&
                    !is_at_border(before.classes, u, v) && !is_at_border(after.classes, u, v);
  return valid;
}

// One side of the changes before the other side is considered. `shows`: the view that shows the objects.
struct RawSide {
  SideTruth truth;  ///< Pixels without an object of this side are unchanged.
  Mask is_flat;     ///< Of objects that rise too little.
};

RawSide find_raw_side(const LabelledView& shows, const LabelledView& other, const Mask& valid) {
  const int width = valid.width();
  const int height = valid.height();
  RawSide side{{Image<TruthPixel>(width, height, TruthPixel::kUnchanged), {}}, Mask(width, height, 0)};
  const auto rise_at = [&](int pixel) -> double { return other.frame.depth_m[pixel] - shows.frame.depth_m[pixel]; };
  // Where one object replaced another, only the nearer one counts. Unknown depth does not count at all.
  const auto counts = [&](int pixel) { return valid[pixel] != 0 && (other.classes[pixel] == 0 || rise_at(pixel) > 0); };
  Image<std::int32_t> changed_classes = shows.classes;
  for (std::size_t i = 0; i < changed_classes.size(); ++i)
    if (shows.classes[i] == other.classes[i]) changed_classes[i] = 0;
  for (const Region& region : find_components(changed_classes).regions) {
    ChangedObject object;
    std::vector<double> rises_m;
    for (const int pixel : region) {
      side.truth.pixels[pixel] = TruthPixel::kIgnored;
      if (!counts(pixel)) continue;
      object.pixels.push_back(pixel);
      rises_m.push_back(rise_at(pixel));
    }
    if (object.pixels.empty()) continue;
    object.rise_m = upper_median(std::move(rises_m));
    const bool is_flat = object.rise_m < kMinRise_m;
    for (const int pixel : region) side.is_flat[pixel] = is_flat;
    if (is_flat) continue;
    for (const int pixel : object.pixels) side.truth.pixels[pixel] = TruthPixel::kChanged;
    side.truth.objects.push_back(std::move(object));
  }
  return side;
}

// Ignores pixels that are not valid, or that show a flat object of the other side.
SideTruth finish_side(SideTruth side, const RawSide& other, const Mask& valid) {
  for (std::size_t i = 0; i < valid.size(); ++i)
    if (valid[i] == 0 || (other.is_flat[i] != 0 && side.pixels[i] == TruthPixel::kUnchanged))
      side.pixels[i] = TruthPixel::kIgnored;
  return side;
}

// Fills the truth of what did not change class.
void find_unchanged_objects(const ClassImage& before, const ClassImage& after, const Mask& valid, ChangeTruth& truth) {
  const Components old_objects = find_components(before);
  truth.same_class = Mask(before.width(), before.height(), 0);
  for (const Region& region : find_components(after).regions) {
    std::map<int, std::size_t> shared;  // Pixels by number of the old object.
    for (const int pixel : region)
      if (before[pixel] == after[pixel]) ++shared[old_objects.numbers[pixel]];
    const bool is_unchanged = std::ranges::any_of(shared, [&](const auto& entry) {
      const auto& [number, num_shared] = entry;
      const std::size_t num_either = region.size() + old_objects.regions[number].size() - num_shared;
      return static_cast<double>(num_shared) > kMinOverlap * static_cast<double>(num_either);
    });
    if (is_unchanged) truth.unchanged_objects.emplace_back();
    for (const int pixel : region) {
      if (!is_unchanged && before[pixel] == after[pixel]) truth.same_class[pixel] = 1;
      if (is_unchanged && valid[pixel] != 0) truth.unchanged_objects.back().push_back(pixel);
    }
  }
}

}  // namespace

Result<ClassImage> read_classes(const std::filesystem::path& file) {
  const auto colors = read_color(file);
  if (!colors) return colors.error();
  ClassImage classes(colors->width(), colors->height());
  std::ranges::transform(colors->data(), classes.data().begin(), [](Rgb8 c) { return (c.r << 16) | (c.g << 8) | c.b; });
  return classes;
}

ChangeTruth find_change_truth(const LabelledView& before, const LabelledView& after) {
  const Mask valid = find_valid_pixels(before, after);
  RawSide added = find_raw_side(after, before, valid);
  RawSide removed = find_raw_side(before, after, valid);
  ChangeTruth truth;
  truth.sides[kAdded] = finish_side(std::move(added.truth), removed, valid);
  truth.sides[kRemoved] = finish_side(std::move(removed.truth), added, valid);
  find_unchanged_objects(before.classes, after.classes, valid, truth);
  return truth;
}

}  // namespace resight::bench
