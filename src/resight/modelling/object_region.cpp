// SPDX-License-Identifier: Apache-2.0
#include "resight/modelling/object_region.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <vector>

#include "resight/core/check.hpp"
#include "resight/core/random.hpp"
#include "resight/sensor/pixel_components.hpp"

namespace resight {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr int kSampleStep_px = 4;  // Of the points in which planes are searched.
// Largest distance between the three points of a plane hypothesis, in rows and columns.
constexpr int kTripleRadius_px = 60;
constexpr double kHeightBin_m = 0.004;  // Bin size of the histogram of heights.
constexpr double kFootHeight_m = 0.03;  // Lower points belong to the foot of the object.
constexpr double kMarginReach_m = 0.03;
// Share of the points beside the foot that must be visible; the object occludes the others.
constexpr double kMinSeenShare = 0.15;
constexpr int kRefits = 4;

// A point of the view, with the area on a level surface that its pixel would cover.
struct Sample {
  Vector3d point;
  double weight = 0;
};

// Area-weighted least squares. The normal points towards the camera.
SupportPlane fit_plane(const std::vector<Sample>& samples, const std::vector<int>& inliers) {
  Vector3d mean = Vector3d::Zero();
  double weight = 0;
  for (const int i : inliers) {
    mean += samples[i].weight * samples[i].point;
    weight += samples[i].weight;
  }
  mean /= weight;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const int i : inliers) {
    const Vector3d d = samples[i].point - mean;
    covariance += samples[i].weight * d * d.transpose();
  }
  Vector3d normal = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance).eigenvectors().col(0);
  if (normal.dot(mean) > 0) normal = -normal;
  return {normal, normal.dot(mean)};
}

// The visible part of an object on one support.
struct Standing {
  ObjectRegion region;
  double image_distance_px = 0;
  double reach_m = 0;  // Radius as seen from above.
  // Visible area of the support around the object, within 3 cm of that radius.
  double margin_area_m2 = 0;
};

class RegionFinder {
 public:
  RegionFinder(const PreparedView& view, const ObjectRegionOptions& options, const ObjectRegion* previous)
      : view_(view), cloud_(view.cloud), options_(options), previous_(previous) {
    const Camera& camera = view.frame.camera;
    target_px_ = Vector2d(0.5 * camera.width, 0.5 * camera.height);
    if (previous != nullptr)
      target_px_ = camera.project(previous->foot + 0.5 * previous->height_m * previous->plane.normal);
    for (int v = 0; v < cloud_.height(); v += kSampleStep_px)
      for (int u = 0; u < cloud_.width(); u += kSampleStep_px) {
        const std::size_t i = cloud_.z.index(u, v);
        if (!cloud_.has_point(i) || cloud_.z[i] > options.max_depth_m) continue;
        samples_.push_back({cloud_.point(i).cast<double>(), 1});
        pixels_.push_back(static_cast<int>(i));
      }
  }

  std::optional<ObjectRegion> find() {
    const std::optional<SupportPlane> dominant = find_dominant_plane();
    if (!dominant) return std::nullopt;
    std::vector<Standing> found;
    for (const SupportPlane& support : find_level_planes(*dominant))
      if (std::optional<Standing> standing = find_standing(support)) found.push_back(*standing);
    return choose(found);
  }

 private:
  [[nodiscard]] double pixel_area_m2(const Vector3d& p, const Vector3d& normal) const {
    const double slant = std::max(0.1, std::abs(normal.dot(p.normalized())));
    const Camera& camera = view_.frame.camera;
    return kSampleStep_px * kSampleStep_px * p.squaredNorm() / (camera.fx * camera.fy * slant);
  }

  [[nodiscard]] bool looks_down_on(const Vector3d& normal) const {
    return -normal.y() > std::cos(options_.max_pitch_rad);  // y points down in the image.
  }

  // Considers the objects that are about as near to the expected position as the nearest. With a previous region, the
  // most similar one wins; otherwise the one on the lowest support, or on a turntable above it.
  [[nodiscard]] std::optional<ObjectRegion> choose(std::vector<Standing> found) const {
    if (found.empty()) return std::nullopt;
    const double nearest_px = std::ranges::min_element(found, {}, &Standing::image_distance_px)->image_distance_px;
    std::erase_if(found, [&](const Standing& s) { return s.image_distance_px > nearest_px + options_.same_place_px; });
    if (previous_ != nullptr) {
      const auto most_alike = std::ranges::min_element(found, {}, [&](const Standing& s) { return shift_m(s); });
      if (shift_m(*most_alike) > options_.max_support_shift_m) return std::nullopt;
      return most_alike->region;
    }
    const Standing* support = &found.front();
    for (const Standing& higher : found)
      if (is_turntable(higher, found.front())) support = &higher;
    return support->region;
  }

  // Whether `higher` stands on a turntable: low, and its top covers a good part of what would be an object on the lower
  // support.
  [[nodiscard]] bool is_turntable(const Standing& higher, const Standing& lower) const {
    const double step_m = higher.region.plane.offset_m - lower.region.plane.offset_m;
    return step_m > 0 && step_m <= options_.turntable.max_height_m &&
           higher.margin_area_m2 >= options_.turntable.min_share * std::numbers::pi * lower.reach_m * lower.reach_m;
  }

  [[nodiscard]] double shift_m(const Standing& standing) const {
    return std::abs(standing.region.plane.height_m(previous_->foot));
  }

  [[nodiscard]] std::vector<int> find_inliers(const SupportPlane& plane) const {
    std::vector<int> inliers;
    for (std::size_t i = 0; i < samples_.size(); ++i)
      if (std::abs(plane.height_m(samples_[i].point)) <= options_.plane_distance_m)
        inliers.push_back(static_cast<int>(i));
    return inliers;
  }

  [[nodiscard]] std::optional<SupportPlane> draw_hypothesis(Rng& rng) const {
    const int first = pixels_[rng.below(static_cast<std::uint32_t>(pixels_.size()))];
    std::array<Vector3d, 3> corners;
    corners[0] = cloud_.point(first).cast<double>();
    for (int k = 1; k < 3; ++k) {
      const int u = first % cloud_.width() + static_cast<int>(rng.below(2 * kTripleRadius_px)) - kTripleRadius_px;
      const int v = first / cloud_.width() + static_cast<int>(rng.below(2 * kTripleRadius_px)) - kTripleRadius_px;
      if (!cloud_.z.contains(u, v) || !cloud_.has_point(cloud_.z.index(u, v))) return std::nullopt;
      corners[k] = cloud_.point(cloud_.z.index(u, v)).cast<double>();
    }
    Vector3d normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
    if (normal.norm() < 1e-8) return std::nullopt;
    normal.normalize();
    if (normal.dot(corners[0]) > 0) normal = -normal;
    if (!looks_down_on(normal)) return std::nullopt;
    return SupportPlane{normal, normal.dot(corners[0])};
  }

  // Plane with the largest area among those that the camera looks down on.
  std::optional<SupportPlane> find_dominant_plane() {
    if (samples_.size() < 100) return std::nullopt;
    Rng rng(options_.seed);
    std::optional<SupportPlane> best;
    double best_area = 0;
    for (int h = 0; h < options_.num_hypotheses; ++h) {
      const std::optional<SupportPlane> plane = draw_hypothesis(rng);
      if (!plane) continue;
      double area = 0;
      for (const Sample& s : samples_)
        if (std::abs(plane->height_m(s.point)) <= options_.plane_distance_m) area += s.point.squaredNorm();
      if (area > best_area) {
        best_area = area;
        best = plane;
      }
    }
    if (best) best = refit(*best);
    return best;
  }

  [[nodiscard]] SupportPlane refit(SupportPlane plane) {
    for (Sample& s : samples_) s.weight = pixel_area_m2(s.point, plane.normal);
    for (int i = 0; i < kRefits; ++i) {
      const std::vector<int> inliers = find_inliers(plane);
      if (inliers.size() < 10) break;
      plane = fit_plane(samples_, inliers);
    }
    return plane;
  }

  // Level surfaces of sufficient area, from bottom to top: peaks of the histogram of heights.
  std::vector<SupportPlane> find_level_planes(const SupportPlane& dominant) {
    const int below = static_cast<int>(options_.max_height_m / kHeightBin_m);
    std::vector<double> area(static_cast<std::size_t>(2 * below + 1), 0.0);
    for (const Sample& s : samples_) {
      const int bin = static_cast<int>(std::lround(dominant.height_m(s.point) / kHeightBin_m)) + below;
      if (bin >= 0 && bin < static_cast<int>(area.size())) area[bin] += s.weight;
    }
    std::vector<SupportPlane> planes;
    for (std::size_t bin = 1; bin + 1 < area.size(); ++bin) {
      if (area[bin] < area[bin - 1] || area[bin] <= area[bin + 1]) continue;
      if (area[bin - 1] + area[bin] + area[bin + 1] < options_.min_support_area_m2) continue;
      const SupportPlane level{dominant.normal, dominant.offset_m + (static_cast<int>(bin) - below) * kHeightBin_m};
      planes.push_back(refit_level(level, dominant));
    }
    return planes;
  }

  // A small surface determines its height better than its tilt, so the tilt is that of the dominant plane.
  [[nodiscard]] SupportPlane refit_level(SupportPlane level, const SupportPlane& dominant) const {
    for (int k = 0; k < kRefits; ++k) {
      double sum = 0;
      double weight = 0;
      for (const int i : find_inliers(level)) {
        sum += samples_[i].weight * level.height_m(samples_[i].point);
        weight += samples_[i].weight;
      }
      if (weight <= 0) break;
      level.offset_m += sum / weight;
    }
    level.normal = dominant.normal;
    return level;
  }

  [[nodiscard]] Image<std::uint8_t> mask_above(const SupportPlane& plane) const {
    Image<std::uint8_t> above(cloud_.width(), cloud_.height(), 0);
    for (std::size_t i = 0; i < above.size(); ++i) {
      if (!cloud_.has_point(i) || cloud_.z[i] > options_.max_depth_m) continue;
      const double height_m = plane.height_m(cloud_.point(i).cast<double>());
      above[i] = height_m >= options_.min_height_m && height_m <= options_.max_height_m ? 255 : 0;
    }
    return above;
  }

  // The component nearest to the expected position of the object.
  [[nodiscard]] std::optional<Standing> find_standing(const SupportPlane& plane) const {
    std::optional<Standing> best;
    for (const std::vector<int>& component : find_pixel_components(cloud_, mask_above(plane), 2, options_.max_jump_m)) {
      if (static_cast<int>(component.size()) < options_.min_pixels) continue;
      const std::optional<Standing> standing = describe_standing(plane, component);
      if (standing && (!best || standing->image_distance_px < best->image_distance_px)) best = standing;
    }
    return best;
  }

  [[nodiscard]] std::optional<Standing> describe_standing(const SupportPlane& plane,
                                                          const std::vector<int>& component) const {
    const Vector3d axis_u = plane.normal.unitOrthogonal();
    const Vector3d axis_v = plane.normal.cross(axis_u);
    Vector2d low = Vector2d::Constant(std::numeric_limits<double>::infinity());
    Vector2d high = -low;
    Vector2d pixel = Vector2d::Zero();
    double top_m = 0;
    for (const int i : component) {
      const Vector3d p = cloud_.point(static_cast<std::size_t>(i)).cast<double>();
      const Vector2d uv(axis_u.dot(p), axis_v.dot(p));
      const double height_m = plane.height_m(p);
      low = low.cwiseMin(uv);
      high = high.cwiseMax(uv);
      top_m = std::max(top_m, height_m);
      pixel += Vector2d(i % cloud_.width(), i / cloud_.width()) / static_cast<double>(component.size());
    }
    const auto on_plane = [&](const Vector2d& uv) -> Vector3d {
      return uv.x() * axis_u + uv.y() * axis_v + plane.offset_m * plane.normal;
    };
    if (top_m < options_.min_object_height_m || !is_founded(plane, component)) return std::nullopt;
    Standing standing;
    standing.region.plane = plane;
    standing.region.foot = on_plane(0.5 * (low + high));
    standing.region.radius_m = 0.5 * (high - low).norm() * 1.3 + 0.03;
    standing.region.height_m = 1.2 * top_m + 0.02;
    standing.reach_m = 0.5 * (high - low).maxCoeff();
    standing.margin_area_m2 = margin_area(plane, standing.region.foot, standing.reach_m + kMarginReach_m);
    standing.image_distance_px = (pixel - target_px_).norm();
    return standing;
  }

  [[nodiscard]] double margin_area(const SupportPlane& plane, const Vector3d& middle, double radius_m) const {
    double area_m2 = 0;
    for (const int i : find_inliers(plane))
      if ((samples_[i].point - middle).norm() <= radius_m) area_m2 += pixel_area_m2(samples_[i].point, plane.normal);
    return area_m2;
  }

  // Whether the plane continues beside the foot of the object, as far as visible. The lid of an object, which may carry
  // something too, rarely does. The foot is the lowest point of each image column.
  [[nodiscard]] bool is_founded(const SupportPlane& plane, const std::vector<int>& component) const {
    std::vector<int> lowest(static_cast<std::size_t>(cloud_.width()), -1);
    for (const int i : component)
      if (plane.height_m(cloud_.point(static_cast<std::size_t>(i)).cast<double>()) <= kFootHeight_m)
        lowest[i % cloud_.width()] = std::max(lowest[i % cloud_.width()], i);
    const Vector3d ahead = (-plane.normal.cross(Vector3d::UnitZ()).cross(plane.normal)).normalized();
    const Vector3d aside = ahead.cross(plane.normal);
    int seen = 0;
    int missing = 0;
    int asked = 0;
    for (const int i : lowest) {
      if (i < 0) continue;
      const Vector3d p = cloud_.point(static_cast<std::size_t>(i)).cast<double>();
      const Vector3d foot = p - plane.height_m(p) * plane.normal;
      for (int k = -2; k <= 2; ++k) {  // Towards the camera and to both sides.
        const double angle_rad = k * std::numbers::pi / 4;
        const int found = look_for(
            plane, foot + options_.margin.width_m * (std::cos(angle_rad) * ahead + std::sin(angle_rad) * aside));
        seen += found > 0;
        missing += found < 0;
        ++asked;
      }
    }
    return seen >= options_.margin.min_share * (seen + missing) && seen >= kMinSeenShare * asked && seen > 0;
  }

  // 1 if the plane is visible at a point of it, -1 if it is missing there, 0 if the place is occluded or unknown.
  [[nodiscard]] int look_for(const SupportPlane& plane, const Vector3d& point) const {
    const std::optional<Pixel> pixel = view_.frame.camera.pixel_of(point);
    if (!pixel) return 0;
    const std::size_t i = cloud_.z.index(pixel->u, pixel->v);
    if (!cloud_.has_point(i)) return 0;
    const double height_m = plane.height_m(cloud_.point(i).cast<double>());
    if (std::abs(height_m) <= options_.plane_distance_m) return 1;
    return height_m < 0 ? -1 : 0;
  }

  const PreparedView& view_;
  const OrganizedCloud& cloud_;
  const ObjectRegionOptions& options_;
  const ObjectRegion* previous_;
  Vector2d target_px_;
  std::vector<Sample> samples_;
  std::vector<int> pixels_;
};

}  // namespace

ObjectRegion transform(const Rigid3& a_from_b, const ObjectRegion& region_in_b) {
  ObjectRegion region = region_in_b;
  region.plane.normal = a_from_b.rotation * region_in_b.plane.normal;
  region.plane.offset_m = region_in_b.plane.offset_m + region.plane.normal.dot(a_from_b.translation);
  region.foot = a_from_b * region_in_b.foot;
  return region;
}

void ObjectRegionOptions::check() const {
  check_positive("ObjectRegionOptions.max_depth_m", max_depth_m);
  check_positive("ObjectRegionOptions.plane_distance_m", plane_distance_m);
  check_in_range("ObjectRegionOptions.max_pitch_rad", max_pitch_rad, 0.05, 1.55);
  check_positive("ObjectRegionOptions.min_support_area_m2", min_support_area_m2);
  check_positive("ObjectRegionOptions.min_height_m", min_height_m);
  check_positive("ObjectRegionOptions.max_height_m", max_height_m);
  check_positive("ObjectRegionOptions.max_jump_m", max_jump_m);
  check_positive("ObjectRegionOptions.min_pixels", min_pixels);
  check_positive("ObjectRegionOptions.min_object_height_m", min_object_height_m);
  check_not_negative("ObjectRegionOptions.turntable.max_height_m", turntable.max_height_m);
  check_in_range("ObjectRegionOptions.turntable.min_share", turntable.min_share, 0, 1);
  check_positive("ObjectRegionOptions.margin.width_m", margin.width_m);
  check_in_range("ObjectRegionOptions.margin.min_share", margin.min_share, 0, 1);
  check_positive("ObjectRegionOptions.same_place_px", same_place_px);
  check_positive("ObjectRegionOptions.max_support_shift_m", max_support_shift_m);
  check_in_range("ObjectRegionOptions.num_hypotheses", num_hypotheses, 1, 1000000);
}

std::optional<ObjectRegion> find_object_region(const PreparedView& view, const ObjectRegionOptions& options,
                                               const ObjectRegion* previous) {
  options.check();
  return RegionFinder(view, options, previous).find();
}

}  // namespace resight
