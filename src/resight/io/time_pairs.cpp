// SPDX-License-Identifier: Apache-2.0
#include "resight/io/internal/time_pairs.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <queue>
#include <tuple>
#include <utility>

namespace resight::io {
namespace {

/// An image of either stream, linked to those before and after it in time that have no partner yet.
struct Moment {
  double time_s = 0;
  bool is_color = false;
  std::size_t index = 0;
  std::size_t before = 0;
  std::size_t after = 0;
  bool has_partner = false;
};

/// Moments by time, between two that are never paired.
std::vector<Moment> merge_streams(std::span<const double> colors_s, std::span<const double> depths_s) {
  std::vector<Moment> moments(1);
  for (std::size_t i = 0; i < colors_s.size(); ++i)
    if (std::isfinite(colors_s[i])) moments.push_back({.time_s = colors_s[i], .is_color = true, .index = i});
  for (std::size_t i = 0; i < depths_s.size(); ++i)
    if (std::isfinite(depths_s[i])) moments.push_back({.time_s = depths_s[i], .is_color = false, .index = i});
  std::ranges::stable_sort(moments.begin() + 1, moments.end(), {}, &Moment::time_s);
  moments.emplace_back();
  for (std::size_t m = 1; m + 1 < moments.size(); ++m) {
    moments[m].before = m - 1;
    moments[m].after = m + 1;
  }
  return moments;
}

}  // namespace

std::vector<TimePair> pair_by_time(std::span<const double> colors_s, std::span<const double> depths_s,
                                   double max_gap_s) {
  std::vector<Moment> moments = merge_streams(colors_s, depths_s);
  const std::size_t last = moments.size() - 1;
  // The nearest colour and depth images have no other image between them, so only neighbours are candidates.
  using Candidate = std::tuple<double, std::size_t, std::size_t>;  // Gap, first and second moment.
  std::priority_queue<Candidate, std::vector<Candidate>, std::greater<>> nearest_first;
  const auto add_candidate = [&](std::size_t first, std::size_t second) {
    if (first == 0 || second == last || moments[first].is_color == moments[second].is_color) return;
    const double gap_s = moments[second].time_s - moments[first].time_s;
    if (gap_s <= max_gap_s) nearest_first.emplace(gap_s, first, second);
  };
  for (std::size_t m = 1; m + 1 < last; ++m) add_candidate(m, m + 1);
  std::vector<TimePair> pairs;
  while (!nearest_first.empty()) {
    const auto [gap_s, first, second] = nearest_first.top();
    nearest_first.pop();
    if (moments[first].has_partner || moments[second].has_partner) continue;
    moments[first].has_partner = moments[second].has_partner = true;
    const auto [color, depth] = moments[first].is_color ? std::pair(first, second) : std::pair(second, first);
    pairs.push_back({.color = moments[color].index, .depth = moments[depth].index});
    moments[moments[first].before].after = moments[second].after;
    moments[moments[second].after].before = moments[first].before;
    add_candidate(moments[first].before, moments[second].after);
  }
  std::ranges::sort(pairs, {}, [&](const TimePair& pair) { return std::pair(colors_s[pair.color], pair.color); });
  return pairs;
}

}  // namespace resight::io
