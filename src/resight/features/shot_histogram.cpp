// SPDX-License-Identifier: Apache-2.0
#include "resight/features/shot_histogram.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace resight {
namespace {

constexpr auto kPi = std::numbers::pi_v<float>;
constexpr int kAzimuthBins = 8;

/// atan2 within 1e-6 rad: arctangent on [0, 1] (Abramowitz & Stegun 4.4.49), then the octant. libm's is a call per
/// point.
inline float fast_atan2(float y, float x) {
  const float ax = std::abs(x);
  const float ay = std::abs(y);
  const float large = ax > ay ? ax : ay;
  const float small = ax > ay ? ay : ax;
  const float t = small / (large > 1e-30F ? large : 1e-30F);
  const float s = t * t;
  float p = 0.0028662257F;
  p = p * s - 0.0161657367F;
  p = p * s + 0.0429096138F;
  p = p * s - 0.0752896400F;
  p = p * s + 0.1065626393F;
  p = p * s - 0.1420889944F;
  p = p * s + 0.1999355085F;
  p = p * s - 0.3333314528F;
  float angle = t + t * s * p;
  angle = ay > ax ? kPi / 2 - angle : angle;
  angle = x < 0 ? kPi - angle : angle;
  return y < 0 ? -angle : angle;
}

/// A coordinate's own bin, the one next to it (own, where there is none), and how far it lies towards that one.
struct Vote {
  int bin;
  int next;
  float fraction;
};

inline Vote vote(float coordinate, int num_bins) {
  const int bin = std::clamp(static_cast<int>(coordinate + 0.5F), 0, num_bins - 1);  // coordinates are >= -0.5
  const float offset = coordinate - static_cast<float>(bin);
  return {bin, bin + (offset > 0 ? 1 : -1), std::abs(offset)};
}

}  // namespace

void ShotHistogram::compute(const Neighborhood& n, const Eigen::Matrix3f& frame, double radius_m,
                            std::span<float> descriptor) {
  const auto count = static_cast<std::size_t>(n.count);
  for (std::vector<float>* values : {&azimuth_, &radial_, &elevation_, &cosine_})
    if (values->size() < count) values->resize(2 * count);
  locate(n, frame, static_cast<float>(radius_m));
  std::ranges::fill(descriptor, 0.0F);
  for (std::size_t i = 0; i < count; ++i) add_votes(i, descriptor.data());
  float norm_sq = 0;
  for (const float x : descriptor) norm_sq += x * x;
  const float scale = norm_sq > 0 ? 1.0F / std::sqrt(norm_sq) : 0.0F;
  for (float& x : descriptor) x *= scale;
}

void ShotHistogram::locate(const Neighborhood& n, const Eigen::Matrix3f& frame, float radius_m) {
  const float xx = frame(0, 0), xy = frame(0, 1), xz = frame(0, 2);
  const float yx = frame(1, 0), yy = frame(1, 1), yz = frame(1, 2);
  const float zx = frame(2, 0), zy = frame(2, 1), zz = frame(2, 2);
  const float* __restrict dx = n.dx.data();
  const float* __restrict dy = n.dy.data();
  const float* __restrict dz = n.dz.data();
  const float* __restrict distance = n.distance.data();
  const float* __restrict nx = n.nx.data();
  const float* __restrict ny = n.ny.data();
  const float* __restrict nz = n.nz.data();
  float* __restrict azimuth = azimuth_.data();
  float* __restrict radial = radial_.data();
  float* __restrict elevation = elevation_.data();
  float* __restrict cosine = cosine_.data();
  for (int i = 0; i < n.count; ++i) {
    const float x = dx[i] * xx + dy[i] * xy + dz[i] * xz;
    const float y = dx[i] * yx + dy[i] * yy + dz[i] * yz;
    const float z = dx[i] * zx + dy[i] * zy + dz[i] * zz;
    const float inclination = fast_atan2(std::sqrt(x * x + y * y), z);
    const float c = nx[i] * zx + ny[i] * zy + nz[i] * zz;
    azimuth[i] = (fast_atan2(y, x) + kPi) * (4 / kPi) - 0.5F;  // bins of 45 deg from -pi on
    radial[i] = 2 * distance[i] / radius_m - 0.5F;             // two husks
    elevation[i] = 1.5F - inclination * (2 / kPi);             // 0: below, 1: above the tangent plane
    cosine[i] = (1 + std::min(1.0F, std::max(-1.0F, c))) * (0.5F * (kShotCosineBins - 1));
  }
}

void ShotHistogram::add_votes(std::size_t i, float* descriptor) const {
  const Vote a = vote(azimuth_[i], kAzimuthBins);
  const Vote r = vote(radial_[i], 2);
  const Vote e = vote(elevation_[i], 2);
  const Vote c = vote(cosine_[i], kShotCosineBins);
  const auto volume = [](int azimuth, int radial, int elevation) {
    return (4 * azimuth + 2 * radial + elevation) * kShotCosineBins;
  };
  float* own = descriptor + volume(a.bin, r.bin, e.bin);
  own[c.bin] += 4 - a.fraction - r.fraction - e.fraction - c.fraction;
  if (c.next >= 0 && c.next < kShotCosineBins) own[c.next] += c.fraction;
  if (r.next == 0 || r.next == 1) descriptor[volume(a.bin, r.next, e.bin) + c.bin] += r.fraction;
  if (e.next == 0 || e.next == 1) descriptor[volume(a.bin, r.bin, e.next) + c.bin] += e.fraction;
  descriptor[volume((a.next + kAzimuthBins) % kAzimuthBins, r.bin, e.bin) + c.bin] += a.fraction;
}

}  // namespace resight
