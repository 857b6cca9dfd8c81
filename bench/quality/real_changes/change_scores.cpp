// SPDX-License-Identifier: Apache-2.0
#include "change_scores.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

namespace resight::bench {
namespace {

constexpr std::size_t kMinObject_px = 30;
constexpr double kMinFoundShare = 0.25;
constexpr double kMaxThinRise_m = 0.020;
constexpr double kMaxUnchangedShare = 0.1;
constexpr std::size_t kMinRegion_px = 20;
constexpr double kMinRegionShare = 0.5;

double share_in(const Region& pixels, const Mask& mask) {
  const auto num = std::ranges::count_if(pixels, [&](int pixel) { return mask[pixel] != 0; });
  return static_cast<double>(num) / static_cast<double>(pixels.size());
}

void score_pixels(const ChangeTruth& truth, Side side, const Mask& mask, ChangeScore& score) {
  SideScore& of_side = score.sides[side];
  for (std::size_t i = 0; i < mask.size(); ++i) {
    const TruthPixel true_pixel = truth.sides[side].pixels[i];
    if (true_pixel == TruthPixel::kIgnored) continue;
    const bool changed = true_pixel == TruthPixel::kChanged;
    if (mask[i] != 0) of_side.precision.add(changed);
    if (changed) of_side.recall.add(mask[i] != 0);
    if (mask[i] != 0 && !changed) score.false_in_class.add(truth.same_class[i] != 0);
  }
}

// Share of the object that one reported region covers.
double largest_cover(const ChangedObject& object, const Components& reported) {
  std::map<int, int> num_pixels;  // By region.
  int largest = 0;
  for (const int pixel : object.pixels) {
    const int number = reported.numbers[pixel];
    if (number < 0 || reported.regions[number].size() < kMinRegion_px) continue;
    largest = std::max(largest, ++num_pixels[number]);
  }
  return static_cast<double>(largest) / static_cast<double>(object.pixels.size());
}

// Whether the object is found, and covered by one region.
void score_object(const ChangedObject& object, Side side, const Mask& mask, const Components& reported,
                  SideScore& score, std::vector<Mistake>* mistakes) {
  const double share = share_in(object.pixels, mask);
  const bool is_thin = object.rise_m <= kMaxThinRise_m;
  const bool is_found = share >= kMinFoundShare;
  if (object.pixels.size() >= kMinObject_px) (is_thin ? score.thin : score.tall).add(is_found);
  if (object.pixels.size() < kMinRegion_px) return;
  const double cover = largest_cover(object, reported);
  const bool is_covered = cover >= kMinRegionShare;
  score.region_recall.add(is_covered);
  if (mistakes == nullptr || (is_found && is_covered)) return;
  mistakes->push_back({false, side, object.pixels,
                       fmt::format("{} {}: {:.0f} mm high, {} px, {:.0f} % found, largest part {:.0f} %",
                                   to_string(side), is_found ? "in pieces" : "missed", 1e3 * object.rise_m,
                                   object.pixels.size(), 100 * share, 100 * cover)});
}

// Whether the reported region is mostly right. Regions without a pixel that counts are skipped.
void score_region(const Region& region, Side side, const SideTruth& truth, SideScore& score,
                  std::vector<Mistake>* mistakes) {
  if (region.size() < kMinRegion_px) return;
  const auto count = [&](TruthPixel kind) {
    return static_cast<double>(std::ranges::count_if(region, [&](int pixel) { return truth.pixels[pixel] == kind; }));
  };
  const double num_right = count(TruthPixel::kChanged);
  const double num_valid = num_right + count(TruthPixel::kUnchanged);
  if (num_valid == 0) return;
  const bool is_right = num_right >= kMinRegionShare * num_valid;
  score.region_precision.add(is_right);
  if (mistakes == nullptr || is_right) return;
  mistakes->push_back({true, side, region,
                       fmt::format("false {}: {} px, {:.0f} of them count, {:.0f} right", to_string(side),
                                   region.size(), num_valid, num_right)});
}

void score_unchanged_object(const Region& pixels, const ReportedChanges& reported, ChangeScore& score,
                            std::vector<Mistake>* mistakes) {
  if (pixels.size() < kMinObject_px) return;
  const Mask& added = reported.masks[kAdded];
  const Mask& removed = reported.masks[kRemoved];
  const auto is_called = [&](int pixel) { return added[pixel] != 0 || removed[pixel] != 0; };
  const auto num_called = static_cast<double>(std::ranges::count_if(pixels, is_called));
  const double share = num_called / static_cast<double>(pixels.size());
  score.unchanged.add(share > kMaxUnchangedShare);
  if (mistakes == nullptr || share <= kMaxUnchangedShare) return;
  const Side side = share_in(pixels, added) > share_in(pixels, removed) ? kAdded : kRemoved;
  mistakes->push_back(
      {true, side, pixels,
       fmt::format("unchanged, called {}: {:.0f} % of {} px", to_string(side), 100 * share, pixels.size())});
}

}  // namespace

void score_changes(const ChangeTruth& truth, const ReportedChanges& reported, ChangeScore& score,
                   std::vector<Mistake>* mistakes) {
  for (const Side side : kSides) {
    const SideTruth& true_side = truth.sides[side];
    const Mask& mask = reported.masks[side];
    score_pixels(truth, side, mask, score);
    const Components& regions = reported.regions[side];
    for (const ChangedObject& object : true_side.objects)
      score_object(object, side, mask, regions, score.sides[side], mistakes);
    for (const Region& region : regions.regions) score_region(region, side, true_side, score.sides[side], mistakes);
  }
  for (const Region& pixels : truth.unchanged_objects) score_unchanged_object(pixels, reported, score, mistakes);
}

}  // namespace resight::bench
