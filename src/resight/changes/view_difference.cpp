// SPDX-License-Identifier: Apache-2.0
#include "resight/changes/view_difference.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "resight/changes/depth_tiles.hpp"
#include "resight/changes/difference.hpp"
#include "resight/core/check.hpp"
#include "resight/core/parallel.hpp"

namespace resight {
namespace {

using Points = std::vector<Eigen::Vector3f>;
constexpr std::size_t kPixelsPerTask = 4096;
constexpr std::size_t kRowGrain = 16;
constexpr int kMaxFirstLook_px = 4;
constexpr double kRounding_px = 1.0;  // For points that project not quite where their pixel is.

/// Rectangle of pixels, clipped to the image; empty if begin >= end.
struct PixelWindow {
  int begin_u, end_u;
  int begin_v, end_v;
};

/// A row of the points of a view.
struct PixelRow {
  const float* x;
  const float* y;
  const float* z;
  PixelRow(const OrganizedCloud& view, int v)
      : x(view.x.row(v).data()), y(view.y.row(v).data()), z(view.z.row(v).data()) {}
  [[nodiscard]] float distance_sq(int u, const Eigen::Vector3f& p) const {
    const float dx = x[u] - p.x();
    const float dy = y[u] - p.y();
    const float dz = z[u] - p.z();
    return dx * dx + dy * dy + dz * dz;
  }
};

/// The search for pixels around points.
class PixelSearch {
 public:
  PixelSearch(const OrganizedCloud& view, const Camera& camera, double tolerance_m)
      : view_(view), camera_(camera), tolerance_m_(tolerance_m) {}

  /// Whether a pixel explains `p`; `tiles` are those of the view. Marks some of those that do.
  bool is_explained(const Eigen::Vector3f& p, const DepthTiles& tiles, Image<std::uint8_t>* explained_pixels) const {
    if (!(p.z() > 0)) return tiles.may_be_near(p) && any_within(p, tolerance_m_);
    const float focal_over_z = static_cast<float>(camera_.fx) / p.z();
    const float u = focal_over_z * p.x() + static_cast<float>(camera_.cx);
    const float v = static_cast<float>(camera_.fy) * p.y() / p.z() + static_cast<float>(camera_.cy);
    if (!tiles.may_be_near(u, v, p.z())) return false;
    const bool in_image = u > -0.5F && v > -0.5F && u < static_cast<float>(camera_.width) - 0.5F &&
                          v < static_cast<float>(camera_.height) - 0.5F;
    // A third of the tolerance, square: marks all that lies between the points of a cloud of 5 mm.
    const float half_px = focal_over_z * static_cast<float>(tolerance_m_) / 6;
    const int reach_px = half_px < 2 ? 1 : static_cast<int>(std::min<float>(half_px, kMaxFirstLook_px));
    if (in_image &&
        mark_around(p, {static_cast<int>(u + 0.5F), static_cast<int>(v + 0.5F)}, reach_px, explained_pixels))
      return true;
    return any_within(p, tolerance_m_);
  }

 private:
  bool mark_around(const Eigen::Vector3f& p, const Pixel& center, int reach_px,
                   Image<std::uint8_t>* explained_pixels) const {
    const PixelWindow window = clip(center, reach_px);
    const auto limit = static_cast<float>(tolerance_m_);
    const float limit_sq = limit * limit;
    bool found = false;
    for (int v = window.begin_v; v < window.end_v; ++v) {
      const PixelRow row(view_, v);
      std::uint8_t* marks = explained_pixels != nullptr ? explained_pixels->row(v).data() : nullptr;
      for (int u = window.begin_u; u < window.end_u; ++u) {
        if (!(row.distance_sq(u, p) <= limit_sq)) continue;
        found = true;
        if (marks == nullptr) return true;
        std::atomic_ref(marks[u]).store(1, std::memory_order_relaxed);  // others may write the same
      }
    }
    return found;
  }

  /// Whether any pixel of the view lies within the radius.
  [[nodiscard]] bool any_within(const Eigen::Vector3f& p, double radius_m) const {
    if (!p.allFinite()) return false;
    const Pixel center = pixel_of(p);
    const PixelWindow window = window_of(p, radius_m);
    const auto radius = static_cast<float>(radius_m);
    // From the middle outwards: there it is likeliest.
    const int farthest = std::max(center.v - window.begin_v, window.end_v - 1 - center.v);
    for (int step = 0; step <= farthest; ++step) {
      if (row_has(center.v - step, window, p, radius * radius)) return true;
      if (step > 0 && row_has(center.v + step, window, p, radius * radius)) return true;
    }
    return false;
  }

  /// That `p` projects to, within some images' size of the image.
  [[nodiscard]] Pixel pixel_of(const Eigen::Vector3f& p) const {
    const auto near_image = [](double x, int size) {  // In this order NaN becomes a number.
      return static_cast<int>(std::max(-4.0 * size, std::min(5.0 * size, std::floor(x + 0.5))));
    };
    if (!(p.z() > 0)) return {camera_.width / 2, camera_.height / 2};
    return {near_image(camera_.fx * p.x() / p.z() + camera_.cx, camera_.width),
            near_image(camera_.fy * p.y() / p.z() + camera_.cy, camera_.height)};
  }
  [[nodiscard]] PixelWindow clip(const Pixel& center, int reach_px) const {
    return {std::max(center.u - reach_px, 0), std::min(center.u + reach_px + 1, camera_.width),
            std::max(center.v - reach_px, 0), std::min(center.v + reach_px + 1, camera_.height)};
  }
  /// Where points within the radius project to: at most f r sqrt(1 + s^2) / (z - r) from the projection of `p` itself,
  /// with its slope s (see DepthTiles::close()).
  [[nodiscard]] PixelWindow window_of(const Eigen::Vector3f& p, double radius_m) const {
    const double nearest_m = p.z() - radius_m * (1 + 1e-4);
    if (!(nearest_m > 0)) return {0, camera_.width, 0, camera_.height};
    const Eigen::Vector2d projected = camera_.project(p.cast<double>());
    const double s = p.x() / p.z();
    const double t = p.y() / p.z();
    const double reach_u = camera_.fx * radius_m * std::sqrt(1 + s * s) / nearest_m + kRounding_px;
    const double reach_v = camera_.fy * radius_m * std::sqrt(1 + t * t) / nearest_m + kRounding_px;
    const auto limit = [](double x, int size) { return static_cast<int>(std::clamp(x, 0.0, double(size))); };
    return {limit(std::floor(projected.x() - reach_u), camera_.width),
            limit(std::ceil(projected.x() + reach_u) + 1, camera_.width),
            limit(std::floor(projected.y() - reach_v), camera_.height),
            limit(std::ceil(projected.y() + reach_v) + 1, camera_.height)};
  }
  [[nodiscard]] bool row_has(int v, const PixelWindow& window, const Eigen::Vector3f& p, float radius_sq) const {
    if (v < window.begin_v || v >= window.end_v) return false;
    const PixelRow row(view_, v);
    int found = 0;
    for (int u = window.begin_u; u < window.end_u; ++u) found |= row.distance_sq(u, p) <= radius_sq ? 1 : 0;
    return found != 0;
  }

  const OrganizedCloud& view_;
  const Camera& camera_;
  double tolerance_m_;
};

void check_input(const OrganizedCloud& view, const Camera& camera, double tolerance_m) {
  check_positive("tolerance_m", tolerance_m);
  require(camera.is_valid() && camera.width == view.width() && camera.height == view.height(),
          "view_difference: the camera is not that of the view");
}

DepthTiles tiles_of_pixels(const OrganizedCloud& view, const Camera& camera, double radius_m,
                           std::span<const int> pixels) {
  DepthTiles tiles(camera, radius_m);
  for (const int i : pixels) tiles.add_pixel(i % camera.width, i / camera.width, view.z[static_cast<std::size_t>(i)]);
  tiles.close();
  return tiles;
}

DepthTiles tiles_of_view(const OrganizedCloud& view, const Camera& camera, double radius_m) {
  DepthTiles tiles(camera, radius_m);
  for (int v = 0; v < view.height(); ++v) {
    const float* z = view.z.row(v).data();
    for (int u = 0; u < view.width(); ++u)
      if (!std::isnan(z[u])) tiles.add_pixel(u, v, z[u]);
  }
  tiles.close();
  return tiles;
}

/// Positions at which `is_marked` is not 0.
std::vector<int> positions_of(const std::vector<std::uint8_t>& is_marked) {
  std::vector<int> positions;
  for (std::size_t i = 0; i < is_marked.size(); ++i)
    if (is_marked[i] != 0) positions.push_back(static_cast<int>(i));
  return positions;
}

template <typename Test>
std::vector<std::uint8_t> test_all(std::size_t count, int num_threads, Test&& test) {
  std::vector<std::uint8_t> result(count);
  parallel_for_blocks(count, kPixelsPerTask, num_threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) result[i] = test(i) ? 1 : 0;
  });
  return result;
}

Points select_near(std::span<const Eigen::Vector3f> points, const DepthTiles& tiles, int num_threads) {
  const auto may_be_near =
      test_all(points.size(), num_threads, [&](std::size_t i) { return tiles.may_be_near(points[i]); });
  Points selected;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (may_be_near[i] != 0) selected.push_back(points[i]);
  return selected;
}

}  // namespace

std::vector<std::uint8_t> find_explained_points(std::span<const Eigen::Vector3f> points_in_camera,
                                                const OrganizedCloud& view_in_camera, const Camera& camera,
                                                double tolerance_m, int num_threads,
                                                Image<std::uint8_t>* explained_pixels) {
  check_input(view_in_camera, camera, tolerance_m);
  require(explained_pixels == nullptr || explained_pixels->size() == view_in_camera.z.size(),
          "find_explained_points: explained_pixels does not have the size of the view");
  const DepthTiles tiles = tiles_of_view(view_in_camera, camera, tolerance_m);
  const PixelSearch search(view_in_camera, camera, tolerance_m);
  return test_all(points_in_camera.size(), num_threads,
                  [&](std::size_t i) { return search.is_explained(points_in_camera[i], tiles, explained_pixels); });
}

std::vector<int> find_unexplained_pixels(std::span<const Eigen::Vector3f> points_in_camera,
                                         const OrganizedCloud& view_in_camera, const Camera& camera, double tolerance_m,
                                         int num_threads, const Image<std::uint8_t>& explained_pixels) {
  check_input(view_in_camera, camera, tolerance_m);
  require(explained_pixels.empty() || explained_pixels.size() == view_in_camera.z.size(),
          "find_unexplained_pixels: explained_pixels does not have the size of the view");
  std::vector<int> open;
  Points queries;
  for (std::size_t i = 0; i < view_in_camera.z.size(); ++i) {
    if (!view_in_camera.has_point(i) || (!explained_pixels.empty() && explained_pixels[i] != 0)) continue;
    open.push_back(static_cast<int>(i));
    queries.push_back(view_in_camera.point(i));
  }
  const DepthTiles tiles = tiles_of_pixels(view_in_camera, camera, tolerance_m, open);
  const ProximityGrid grid(select_near(points_in_camera, tiles, num_threads), tolerance_m);
  const auto unexplained =
      test_all(queries.size(), num_threads, [&](std::size_t i) { return !grid.any_within(queries[i]); });
  std::vector<int> pixels = positions_of(unexplained);
  for (int& i : pixels) i = open[static_cast<std::size_t>(i)];
  return pixels;
}

std::vector<int> find_pixels_near(std::span<const Eigen::Vector3f> points_in_camera,
                                  const OrganizedCloud& view_in_camera, const Camera& camera, double distance_m,
                                  int num_threads) {
  check_input(view_in_camera, camera, distance_m);
  DepthTiles tiles(camera, distance_m);
  for (const Eigen::Vector3f& p : points_in_camera)
    if (p.allFinite()) tiles.add(p);
  tiles.close();
  const ProximityGrid grid(points_in_camera, distance_m);
  std::vector<std::uint8_t> is_near(view_in_camera.z.size());
  parallel_for_blocks(static_cast<std::size_t>(camera.height), kRowGrain, num_threads,
                      [&](std::size_t begin, std::size_t end) {
                        for (std::size_t v = begin; v < end; ++v) {
                          const float* z = view_in_camera.z.row(static_cast<int>(v)).data();
                          for (int u = 0; u < camera.width; ++u) {
                            if (!tiles.may_be_near(static_cast<float>(u), static_cast<float>(v), z[u]))
                              continue;  // nor is NaN
                            const std::size_t i = view_in_camera.z.index(u, static_cast<int>(v));
                            is_near[i] = grid.any_within(view_in_camera.point(i)) ? 1 : 0;
                          }
                        }
                      });
  return positions_of(is_near);
}

}  // namespace resight
