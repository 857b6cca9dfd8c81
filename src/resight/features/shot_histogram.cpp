// SPDX-License-Identifier: Apache-2.0
#include "resight/features/shot_histogram.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace resight {
namespace {

constexpr auto kPi = std::numbers::pi_v<float>;
constexpr int kAzimuthBins = 8;

/// atan2 with an error of 1e-6 rad: arctangent on [0, 1] (Abramowitz & Stegun 4.4.49), then the octant. The function of
/// libm would be a call per point.
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

struct Frame {
  float xx, xy, xz, yx, yy, yz, zx, zy, zz;
};

// Separate loops with arrays as parameters: compilers honour __restrict only there, and the loops are not vectorised
// without it.
void find_angles(const float* __restrict dx, const float* __restrict dy, const float* __restrict dz, Frame f, int count,
                 float* __restrict azimuth, float* __restrict elevation) {
  for (int i = 0; i < count; ++i) {
    const float x = dx[i] * f.xx + dy[i] * f.xy + dz[i] * f.xz;
    const float y = dx[i] * f.yx + dy[i] * f.yy + dz[i] * f.yz;
    const float z = dx[i] * f.zx + dy[i] * f.zy + dz[i] * f.zz;
    azimuth[i] = (fast_atan2(y, x) + kPi) * (4 / kPi) - 0.5F;                   // bins of 45 deg starting at -pi
    elevation[i] = 1.5F - fast_atan2(std::sqrt(x * x + y * y), z) * (2 / kPi);  // 0: below, 1: above the tangent plane
  }
}

void find_cosines(const float* __restrict nx, const float* __restrict ny, const float* __restrict nz, Frame f,
                  int count, float* __restrict cosine) {
  for (int i = 0; i < count; ++i) {
    const float c = nx[i] * f.zx + ny[i] * f.zy + nz[i] * f.zz;
    const float low = c < -1 ? -1.0F : c;
    cosine[i] = (1 + (low > 1 ? 1.0F : low)) * (0.5F * (kShotCosineBins - 1));
  }
}

void find_husks(const float* __restrict distance, float radius_m, int count, float* __restrict radial) {
  const float scale = 2 / radius_m;
  for (int i = 0; i < count; ++i) radial[i] = scale * distance[i] - 0.5F;
}

/// Splits coordinates >= -0.5 into the bin with the nearest centre and the offset from that centre.
void split(float* __restrict coordinate, int* __restrict bin, int num_bins, int count) {
  for (int i = 0; i < count; ++i) {
    const int nearest = static_cast<int>(coordinate[i] + 0.5F);
    const int own = nearest < num_bins ? nearest : num_bins - 1;
    bin[i] = own;
    coordinate[i] -= static_cast<float>(own);
  }
}

}  // namespace

void ShotHistogram::compute(const Neighborhood& n, const Eigen::Matrix3f& frame, double radius_m,
                            std::span<float> descriptor) {
  const auto count = static_cast<std::size_t>(n.count);
  for (std::vector<float>* values : {&azimuth_, &radial_, &elevation_, &cosine_})
    if (values->size() < count) values->resize(2 * count);
  for (std::vector<int>* values : {&azimuth_bin_, &radial_bin_, &elevation_bin_, &cosine_bin_})
    if (values->size() < count) values->resize(2 * count);
  locate(n, frame, static_cast<float>(radius_m));
  std::ranges::fill(descriptor, 0.0F);
  for (std::size_t i = 0; i < count; ++i) add_votes(i, descriptor.data());
  float norm_sq = 0;
  for (const float x : descriptor) norm_sq += x * x;
  const float scale = norm_sq > 0 ? 1.0F / std::sqrt(norm_sq) : 0.0F;
  for (float& x : descriptor) x *= scale;
}

void ShotHistogram::locate(const Neighborhood& n, const Eigen::Matrix3f& axes, float radius_m) {
  const Frame frame{axes(0, 0), axes(0, 1), axes(0, 2), axes(1, 0), axes(1, 1),
                    axes(1, 2), axes(2, 0), axes(2, 1), axes(2, 2)};
  find_angles(n.dx.data(), n.dy.data(), n.dz.data(), frame, n.count, azimuth_.data(), elevation_.data());
  find_cosines(n.nx.data(), n.ny.data(), n.nz.data(), frame, n.count, cosine_.data());
  find_husks(n.distance.data(), radius_m, n.count, radial_.data());
  split(azimuth_.data(), azimuth_bin_.data(), kAzimuthBins, n.count);
  split(radial_.data(), radial_bin_.data(), 2, n.count);
  split(elevation_.data(), elevation_bin_.data(), 2, n.count);
  split(cosine_.data(), cosine_bin_.data(), kShotCosineBins, n.count);
}

void ShotHistogram::add_votes(std::size_t i, float* descriptor) const {
  constexpr int kAzimuthStep = 4 * kShotCosineBins;
  constexpr int kRadialStep = 2 * kShotCosineBins;
  const int azimuth = azimuth_bin_[i];
  const int radial = radial_bin_[i];
  const int above = elevation_bin_[i];
  const int bin = cosine_bin_[i];
  const float a = azimuth_[i];
  const float r = radial_[i];
  const float e = elevation_[i];
  const float c = cosine_[i];
  float* own = descriptor + azimuth * kAzimuthStep + radial * kRadialStep + above * kShotCosineBins + bin;
  *own += 4 - (std::abs(a) + std::abs(r) + std::abs(e) + std::abs(c));
  // If the offset points to the other of two bins, that bin gets a vote. Otherwise its vote has weight 0, which avoids
  // a branch.
  own[radial == 0 ? kRadialStep : -kRadialStep] += std::max(0.0F, radial == 0 ? r : -r);
  own[above == 0 ? kShotCosineBins : -kShotCosineBins] += std::max(0.0F, above == 0 ? e : -e);
  const int next = bin + (c > 0 ? 1 : -1);
  if (next >= 0 && next < kShotCosineBins) own[next - bin] += std::abs(c);
  const int next_azimuth = (azimuth + (a > 0 ? 1 : kAzimuthBins - 1)) % kAzimuthBins;
  own[(next_azimuth - azimuth) * kAzimuthStep] += std::abs(a);
}

}  // namespace resight
