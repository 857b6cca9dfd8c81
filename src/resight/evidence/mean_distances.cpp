// SPDX-License-Identifier: Apache-2.0
#include "resight/evidence/mean_distances.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "resight/core/statistics.hpp"

namespace resight {
namespace {

constexpr int kRadiiPerWidth = 80;  // 8 px of 640: a square of 3 cm at 1 m.
constexpr int kSquareStep_px = 4;   // One square in 16 is enough for a median.
constexpr std::size_t kMinSquares = 500;
constexpr float kUnitsPerSigma = 64;  // Sums are of integers.
constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

}  // namespace

MeanDistances::MeanDistances(const Image<float>& distances, float max_distance)
    : radius_px_(std::max(distances.width() / kRadiiPerWidth, 1)),
      sums_(distances.width(), distances.height(),
            [&](int u, int v) -> Eigen::Matrix<std::int64_t, 2, 1> {
              const float distance = distances(u, v);
              if (!(std::abs(distance) < max_distance)) return {0, 0};  // nor does NaN count
              return {std::lround(distance * kUnitsPerSigma), 1};
            }),
      scale_(kNaN) {
  std::vector<float> means;
  for (int v = 0; v < distances.height(); v += kSquareStep_px)
    for (int u = 0; u < distances.width(); u += kSquareStep_px)
      if (const float m = mean(u, v); !std::isnan(m)) means.push_back(std::abs(m));
  if (means.size() < kMinSquares) return;
  const float of_independent_noise = 1 / static_cast<float>(2 * radius_px_ + 1);
  scale_ = std::max(of_independent_noise, static_cast<float>(kNormalizedMad) * upper_median(std::move(means)));
}

float MeanDistances::mean(int u, int v) const {
  const Eigen::Matrix<std::int64_t, 2, 1> sum =
      sums_.sum(u - radius_px_, v - radius_px_, u + radius_px_, v + radius_px_);
  const int side_px = 2 * radius_px_ + 1;
  return 2 * sum[1] < side_px * side_px ? kNaN
                                        : static_cast<float>(sum[0]) / (kUnitsPerSigma * static_cast<float>(sum[1]));
}

float MeanDistances::at(int u, int v) const { return mean(u, v) / scale_; }

}  // namespace resight
