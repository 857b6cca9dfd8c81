// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "resight/core/check.hpp"
#include "resight/core/parallel.hpp"
#include "resight/sensor/organized_cloud.hpp"

// All loops process arrays along an image row, without branches or calls, so that the compiler can vectorise them.
namespace resight {
namespace {

constexpr int kBlock = 128;  // columns per block, so that their sums stay in the first-level cache
constexpr int kNormalRowsPerTask = 8;
constexpr int kNewtonSteps = 6;
// Smallest |cross product| / trace^2 of a window that spans a plane. The ratio is about l1 / l2, 0.03 at 80 deg
// incidence.
constexpr float kMinSpread = 1e-4F;
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

using Lane = std::array<float, kBlock>;

/// First and second moments over the window of each pixel of a block, of differences to the point of the pixel. In
/// single precision, sums of squares of absolute coordinates would lose all digits of the spread.
struct WindowSums {
  Lane count, x, y, z, xx, xy, xz, yy, yz, zz;
  void clear() {
    for (Lane* lane : {&count, &x, &y, &z, &xx, &xy, &xz, &yy, &yz, &zz}) lane->fill(0);
  }
};

/// Adds the neighbour at (du, dv) for the pixels [begin, end) of row v. All neighbours must lie within the image.
void add_neighbors(const OrganizedCloud& cloud, int v, int begin, int end, int du, int dv, int block_begin,
                   float max_depth_change, WindowSums& s) {
  const std::size_t here = cloud.z.index(begin, v);
  const std::size_t there = cloud.z.index(begin + du, v + dv);
  const float* x = cloud.x.data().data() + here;
  const float* y = cloud.y.data().data() + here;
  const float* z = cloud.z.data().data() + here;
  const float* x_n = cloud.x.data().data() + there;
  const float* y_n = cloud.y.data().data() + there;
  const float* z_n = cloud.z.data().data() + there;
  const int offset = begin - block_begin;
  const int num = end - begin;
  for (int i = 0; i < num; ++i) {
    const float dz_all = z_n[i] - z[i];
    const bool counts = std::abs(dz_all) < max_depth_change * z[i];  // false if either depth is NaN
    const float dx = counts ? x_n[i] - x[i] : 0.0F;
    const float dy = counts ? y_n[i] - y[i] : 0.0F;
    const float dz = counts ? dz_all : 0.0F;
    const int j = i + offset;
    s.count[j] += counts ? 1.0F : 0.0F;
    s.x[j] += dx;
    s.y[j] += dy;
    s.z[j] += dz;
    s.xx[j] += dx * dx;
    s.xy[j] += dx * dy;
    s.xz[j] += dx * dz;
    s.yy[j] += dy * dy;
    s.yz[j] += dy * dz;
    s.zz[j] += dz * dz;
  }
}

void sum_windows(const OrganizedCloud& cloud, int v, int block_begin, int block_end,
                 const ComputeNormalsOptions& options, WindowSums& sums) {
  sums.clear();
  const int radius = options.window_radius_px;
  const auto max_depth_change = static_cast<float>(options.max_depth_change);
  for (int dv = std::max(-radius, -v); dv <= std::min(radius, cloud.height() - 1 - v); ++dv)
    for (int du = -radius; du <= radius; ++du) {
      if (du == 0 && dv == 0) continue;
      const int begin = std::max(block_begin, -du);
      const int end = std::min(block_end, cloud.width() - du);
      if (begin < end) add_neighbors(cloud, v, begin, end, du, dv, block_begin, max_depth_change, sums);
    }
}

struct Vector {
  float x, y, z;
  [[nodiscard]] float dot(const Vector& o) const { return x * o.x + y * o.y + z * o.z; }
};

/// Symmetric 3x3 matrix with unit trace.
struct Symmetric {
  float xx, xy, xz, yy, yz, zz;
  [[nodiscard]] Vector operator*(const Vector& n) const {
    return {xx * n.x + xy * n.y + xz * n.z, xy * n.x + yy * n.y + yz * n.z, xz * n.x + yz * n.y + zz * n.z};
  }
};

/// Smallest root of the characteristic polynomial of a positive semi-definite matrix with unit trace. The polynomial is
/// concave and increases up to that root, so Newton's method from 0 approaches it from below without overshooting.
inline float smallest_eigenvalue(const Symmetric& a) {
  const float minors = a.xx * a.yy - a.xy * a.xy + a.xx * a.zz - a.xz * a.xz + a.yy * a.zz - a.yz * a.yz;
  const float determinant =
      a.xx * (a.yy * a.zz - a.yz * a.yz) - a.xy * (a.xy * a.zz - a.yz * a.xz) + a.xz * (a.xy * a.yz - a.yy * a.xz);
  float l = 0;
  for (int step = 0; step < kNewtonSteps; ++step) {
    const float value = ((l - 1.0F) * l + minors) * l - determinant;
    const float slope = (3.0F * l - 2.0F) * l + minors;
    l -= slope > 1e-12F ? value / slope : 0.0F;
  }
  return l;
}

/// Eigenvector of eigenvalue `l`, not normalised: the longest cross product of two rows of A - l I.
inline Vector eigenvector(const Symmetric& a, float l) {
  const float xx = a.xx - l;
  const float yy = a.yy - l;
  const float zz = a.zz - l;
  const Vector c01{a.xy * a.yz - a.xz * yy, a.xz * a.xy - xx * a.yz, xx * yy - a.xy * a.xy};
  const Vector c02{a.xy * zz - a.xz * a.yz, a.xz * a.xz - xx * zz, xx * a.yz - a.xy * a.xz};
  const Vector c12{yy * zz - a.yz * a.yz, a.yz * a.xz - a.xy * zz, a.xy * a.yz - yy * a.xz};
  const float n01 = c01.dot(c01);
  const float n02 = c02.dot(c02);
  const float n12 = c12.dot(c12);
  const bool first = n01 >= n02;
  Vector best{first ? c01.x : c02.x, first ? c01.y : c02.y, first ? c01.z : c02.z};
  const bool keep = (first ? n01 : n02) >= n12;
  best = {keep ? best.x : c12.x, keep ? best.y : c12.y, keep ? best.z : c12.z};
  return best;
}

/// Covariance of each of `num` windows, scaled to unit trace. Overwrites the sums of squares.
void normalize_covariances(WindowSums& s, int num) {
  for (int i = 0; i < num; ++i) {
    const float weight = 1.0F / (s.count[i] + 1.0F);  // includes the pixel itself, at difference 0
    const float mx = s.x[i] * weight;
    const float my = s.y[i] * weight;
    const float mz = s.z[i] * weight;
    const float xx = s.xx[i] * weight - mx * mx;
    const float yy = s.yy[i] * weight - my * my;
    const float zz = s.zz[i] * weight - mz * mz;
    const float trace = xx + yy + zz;
    const float scale = trace > 0 ? 1.0F / trace : 0.0F;
    s.xx[i] = xx * scale;
    s.yy[i] = yy * scale;
    s.zz[i] = zz * scale;
    s.xy[i] = (s.xy[i] * weight - mx * my) * scale;
    s.xz[i] = (s.xz[i] * weight - mx * mz) * scale;
    s.yz[i] = (s.yz[i] * weight - my * mz) * scale;
  }
}

/// Smallest eigenvector of each covariance, not normalised. Stored in x, y, z of the sums.
void solve_eigenvectors(WindowSums& s, int num) {
  for (int i = 0; i < num; ++i) {
    const Symmetric a{s.xx[i], s.xy[i], s.xz[i], s.yy[i], s.yz[i], s.zz[i]};
    // The polynomial gives the eigenvalue to about 1e-7 of the trace. The Rayleigh quotient of the resulting vector
    // squares its error, and a second vector from that quotient reaches the limit of single precision.
    const Vector rough = eigenvector(a, smallest_eigenvalue(a));
    const float rough_sq = rough.dot(rough);
    const Vector n = eigenvector(a, rough.dot(a * rough) / (rough_sq > 0 ? rough_sq : 1.0F));
    s.x[i] = n.x;
    s.y[i] = n.y;
    s.z[i] = n.z;
  }
}

/// Writes unit normals that face the camera, NaN for windows that do not span a plane. (vx, vy, vz) are the
/// eigenvectors. Passes pointers as parameters, because compilers honour __restrict only there; otherwise the loop is
/// not vectorised.
void write_normals(const float* __restrict count, const float* __restrict vx, const float* __restrict vy,
                   const float* __restrict vz, const float* __restrict x, const float* __restrict y,
                   const float* __restrict z, int num, float min_neighbors, float* __restrict nx, float* __restrict ny,
                   float* __restrict nz) {
  for (int i = 0; i < num; ++i) {
    const float length_sq = vx[i] * vx[i] + vy[i] * vy[i] + vz[i] * vz[i];
    const float towards = vx[i] * x[i] + vy[i] * y[i] + vz[i] * z[i];
    const float enough = count[i] >= min_neighbors ? 1.0F : kNan;
    const float spans = length_sq > kMinSpread * kMinSpread ? 1.0F : kNan;
    const float factor = enough * spans * (towards > 0 ? -1.0F : 1.0F) / std::sqrt(length_sq);
    nx[i] = vx[i] * factor;
    ny[i] = vy[i] * factor;
    nz[i] = vz[i] * factor;
  }
}

/// Computes the normals of the pixels [begin, end) of row v.
void compute_block(OrganizedCloud& cloud, int v, int begin, int end, const ComputeNormalsOptions& options,
                   WindowSums& sums) {
  const int num = end - begin;
  const std::size_t at = cloud.z.index(begin, v);
  sum_windows(cloud, v, begin, end, options, sums);
  normalize_covariances(sums, num);
  solve_eigenvectors(sums, num);
  write_normals(sums.count.data(), sums.x.data(), sums.y.data(), sums.z.data(), &cloud.x[at], &cloud.y[at],
                &cloud.z[at], num, static_cast<float>(options.min_neighbors), &cloud.nx[at], &cloud.ny[at],
                &cloud.nz[at]);
}

}  // namespace

void compute_normals(OrganizedCloud& cloud, const ComputeNormalsOptions& options) {
  options.check();
  const int width = cloud.width();
  require(cloud.x.size() == cloud.z.size() && cloud.y.size() == cloud.z.size(),
          "compute_normals: x, y and z have different sizes");
  for (Image<float>* normal : {&cloud.nx, &cloud.ny, &cloud.nz}) *normal = Image<float>(width, cloud.height(), kNan);
  parallel_for_blocks(static_cast<std::size_t>(cloud.height()), kNormalRowsPerTask, options.num_threads,
                      [&](std::size_t first_row, std::size_t last_row) {
                        WindowSums sums;
                        for (int v = static_cast<int>(first_row); v < static_cast<int>(last_row); ++v)
                          for (int begin = 0; begin < width; begin += kBlock)
                            compute_block(cloud, v, begin, std::min(begin + kBlock, width), options, sums);
                      });
}

}  // namespace resight
