// SPDX-License-Identifier: Apache-2.0
#include "resight/inspection/depth_time.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "resight/core/statistics.hpp"
#include "resight/inspection/internal/contour_contrast.hpp"
#include "resight/registration/twist.hpp"

namespace resight {
namespace {

constexpr int kStepsPerView = 4;
constexpr int kNumTimes = 2 * kStepsPerView + 1;  // One view before to one view after.
constexpr int kTimeReach_px = 4;                  // measure_color_offset() reaches as far.
constexpr int kNumOffsets = 2 * kTimeReach_px + 1;
constexpr int kMinTimePixels = 200;

double time_of(int index) { return static_cast<double>(index - kStepsPerView) / kStepsPerView; }

/// Sums of the contrasts and their numbers, per time and shift.
struct TimeScores {
  std::array<std::array<double, kNumOffsets * kNumOffsets>, kNumTimes> sums{};
  std::array<int, kNumTimes> counts{};

  void add(const TimeScores& other) {
    for (std::size_t t = 0; t < kNumTimes; ++t) {
      counts[t] += other.counts[t];
      for (std::size_t i = 0; i < sums[t].size(); ++i) sums[t][i] += other.sums[t][i];
    }
  }
  [[nodiscard]] double contrast_at(int time) const {
    const auto t = static_cast<std::size_t>(time);
    return counts[t] < kMinTimePixels ? 0 : *std::ranges::max_element(sums[t]) / counts[t];
  }
  [[nodiscard]] int best_time() const {
    int best = kStepsPerView;
    for (int t = 0; t < kNumTimes; ++t)
      if (contrast_at(t) > contrast_at(best)) best = t;
    return best;
  }
};

/// The motion from a view to the next one, and from the one before to it, with translations in metres.
struct Neighbours {
  std::optional<Rigid3> next_from_view;
  std::optional<Rigid3> view_from_previous;
};

/// By the number of the view.
std::map<int, Neighbours> find_neighbours(std::span<const ViewPair> pairs, double depth_unit_m) {
  std::map<int, Neighbours> neighbours;
  for (const ViewPair& pair : pairs) {
    if (pair.b != pair.a + 1) continue;
    Rigid3 b_from_a = pair.b_from_a;
    b_from_a.translation *= depth_unit_m;
    neighbours[pair.a].next_from_view = b_from_a;
    neighbours[pair.b].view_from_previous = b_from_a;
  }
  return neighbours;
}

/// The motion that takes points measured at `time` (views after this one) to the camera of this view, if its neighbours
/// reach.
std::optional<Rigid3> motion_to_view(const Neighbours& near, double time) {
  if (time == 0) return Rigid3();
  if (time > 0 && near.next_from_view) return from_twist(time * to_twist(*near.next_from_view)).inverse();
  if (time < 0 && near.view_from_previous) return from_twist(-time * to_twist(*near.view_from_previous));
  return std::nullopt;
}

void add_contrasts(const ContourView& view, const Camera& camera, const Rigid3& motion, int time, TimeScores& scores) {
  auto& sums = scores.sums[static_cast<std::size_t>(time)];
  for (std::size_t i = 0; i < view.points_m.size(); ++i) {
    const Eigen::Vector3d p = motion * view.points_m[i].cast<double>();
    if (p.z() <= 0) continue;
    const Eigen::Vector2d at = camera.project(p);
    if (!(at.cwiseAbs().maxCoeff() < 1e6)) continue;
    const int u = static_cast<int>(std::lround(at.x()));
    const int v = static_cast<int>(std::lround(at.y()));
    const Image<float>& contrast = view.contrasts[view.along_row[i]];
    if (!contrast.contains(u - kTimeReach_px, v - kTimeReach_px) ||
        !contrast.contains(u + kTimeReach_px, v + kTimeReach_px))
      continue;
    ++scores.counts[static_cast<std::size_t>(time)];
    double* sum = sums.data();
    for (int y = v - kTimeReach_px; y <= v + kTimeReach_px; ++y)
      for (int x = u - kTimeReach_px; x <= u + kTimeReach_px; ++x) *sum++ += static_cast<double>(contrast(x, y));
  }
}

double median_displacement_px(const ContourView& view, const Camera& camera, const Rigid3& motion) {
  std::vector<double> distances_px;
  for (std::size_t i = 0; i < view.points_m.size(); ++i) {
    const Eigen::Vector3d p = motion * view.points_m[i].cast<double>();
    if (p.z() > 0) distances_px.push_back((camera.project(p) - view.pixels[i].cast<double>()).norm());
  }
  return upper_median(std::move(distances_px));
}

}  // namespace

ContourView find_contour_view(const PreparedView& view) {
  ContourView contours;
  for (const inspection::ContourPixel& pixel : inspection::find_contour_pixels(view)) {
    contours.points_m.push_back(view.frame.camera.unproject(pixel.u, pixel.v, pixel.depth_m).cast<float>());
    contours.pixels.emplace_back(pixel.u, pixel.v);
    contours.along_row.push_back(pixel.along_row ? 1 : 0);
  }
  contours.contrasts = {inspection::find_contrast(view.frame.color, false),
                        inspection::find_contrast(view.frame.color, true)};
  return contours;
}

std::optional<DepthTime> measure_depth_time(const std::map<int, ContourView>& views, std::span<const ViewPair> pairs,
                                            const Camera& camera, double depth_unit_m) {
  const std::map<int, Neighbours> neighbours = find_neighbours(pairs, depth_unit_m);
  std::array<TimeScores, 2> halves;
  std::size_t number = 0;
  for (const auto& [v, near] : neighbours) {
    if (!views.contains(v)) continue;
    TimeScores& scores = halves[number++ % 2];
    for (int t = 0; t < kNumTimes; ++t)
      if (const auto motion = motion_to_view(near, time_of(t))) add_contrasts(views.at(v), camera, *motion, t, scores);
  }
  TimeScores all = halves[0];
  all.add(halves[1]);
  const int best = all.best_time();
  DepthTime time;
  time.views_late = time_of(best);
  time.mean_contrast = all.contrast_at(best);
  time.gain = std::numeric_limits<double>::infinity();
  for (const TimeScores& half : halves) {
    if (half.contrast_at(kStepsPerView) <= 0) return std::nullopt;
    time.gain = std::min(time.gain, half.contrast_at(best) / half.contrast_at(kStepsPerView));
  }
  std::vector<double> displacements_px;
  for (const auto& [v, near] : neighbours)
    if (const auto motion = motion_to_view(near, time.views_late))
      if (views.contains(v) && !views.at(v).points_m.empty())
        displacements_px.push_back(median_displacement_px(views.at(v), camera, *motion));
  time.displacement_px = upper_median(std::move(displacements_px));
  return time;
}

}  // namespace resight
