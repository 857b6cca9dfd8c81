// SPDX-License-Identifier: Apache-2.0
#include "resight/io/internal/time_pairs.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <queue>
#include <tuple>
#include <utility>

namespace resight::io {
namespace {

/// An image of either stream, linked to those before and after it in time that have no partner yet.
struct Moment {
  double time_s = 0;
  std::size_t ordinal = 0;  ///< Among the images of its stream that have this time.
  bool is_color = false;
  std::size_t index = 0;
  std::size_t before = 0;
  std::size_t after = 0;
  bool has_partner = false;
};

void add_stream(std::span<const double> times_s, bool is_color, std::vector<Moment>& moments) {
  std::map<double, std::size_t> num_of_time;
  for (std::size_t i = 0; i < times_s.size(); ++i)
    if (std::isfinite(times_s[i]))
      moments.push_back({.time_s = times_s[i], .ordinal = num_of_time[times_s[i]]++, .is_color = is_color, .index = i});
}

/// Moments by time, between two that are never paired. Of one time, the first colour and depth images lie side by side,
/// then the second ones: that is all that is known of their order.
std::vector<Moment> merge_streams(std::span<const double> colors_s, std::span<const double> depths_s) {
  std::vector<Moment> moments(1);
  add_stream(colors_s, true, moments);
  add_stream(depths_s, false, moments);
  std::ranges::stable_sort(moments.begin() + 1, moments.end(), {},
                           [](const Moment& moment) { return std::pair(moment.time_s, moment.ordinal); });
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
