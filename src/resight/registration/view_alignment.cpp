// SPDX-License-Identifier: Apache-2.0
#include "resight/registration/view_alignment.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include "resight/core/check.hpp"
#include "resight/core/parallel.hpp"
#include "resight/registration/point_to_plane.hpp"
#include "resight/registration/twist.hpp"

namespace resight {
namespace {

using Twistf = Eigen::Matrix<float, 6, 1>;

constexpr std::size_t kBlock = 512;      // Samples per partial sum.
constexpr double kConvergedStep = 1e-5;  // Radians and metres; smaller steps have converged.
// Directions whose information is below this share of the best-known direction count as unconstrained and stay
// unchanged.
constexpr double kMinEigenvalueRatio = 3e-4;
constexpr double kBrightnessGate = 4;  // In units of brightness_sigma.
// Largest point-to-point distance of a pair, in units of its largest point-to-plane distance.
constexpr float kMaxPairDistance = 3;

// Points of one level that are aligned.
struct Samples {
  std::vector<Eigen::Vector3f> points;
  std::vector<Eigen::Vector3f> normals;
  std::vector<float> sigma_m;
  std::vector<float> brightness;
};

Samples draw_samples(const AlignmentLevel& level, int max_samples) {
  const OrganizedCloud& cloud = level.cloud;
  std::size_t num_usable = 0;
  for (std::size_t i = 0; i < cloud.z.size(); ++i) num_usable += cloud.has_point(i) && cloud.has_normal(i);
  const int step = std::max(1, static_cast<int>(std::ceil(std::sqrt(static_cast<double>(num_usable) / max_samples))));
  Samples samples;
  for (int v = 0; v < cloud.height(); v += step)
    for (int u = 0; u < cloud.width(); u += step) {
      const std::size_t i = cloud.z.index(u, v);
      if (!cloud.has_point(i) || !cloud.has_normal(i)) continue;
      samples.points.push_back(cloud.point(i));
      samples.normals.push_back(cloud.normal(i));
      samples.sigma_m.push_back(level.sigma_m[i]);
      samples.brightness.push_back(level.brightness[i]);
    }
  return samples;
}

// Normal equations and counts. Partial sums are added in order, so that results do not depend on the number of threads.
struct Sums {
  NormalEquations equations;
  // Like its matrix, with the view's own normal in one of the two factors. Noise tilts every normal slightly, so that
  // the matrix claims information along a featureless floor. The noise of two independent normals cancels. Symmetric
  // only in the total.
  Matrix6 unbiased = Matrix6::Zero();
  double distance_m = 0;
  int num_pairs = 0;
  double brightness[5] = {};  // Sums of a, b, a^2, b^2 and a b over num_bright pairs.
  int num_bright = 0;
  int num_matched = 0;  // Samples with a pair in at least one target.
  int num_seen_through = 0;
  double cost = 0;
  int num_compared = 0;

  void add(const Twistf& j, const Twistf& other_j, double residual, double weight) {
    const Twist row = j.cast<double>();
    const Twist other_row = other_j.cast<double>();
    equations.add_row(row, residual, weight);
    for (int c = 0; c < 6; ++c) unbiased.col(c) += weight * row[c] * other_row;
  }
  void add_brightness(double a, double b) {
    const double terms[5] = {a, b, a * a, b * b, a * b};
    for (int k = 0; k < 5; ++k) brightness[k] += terms[k];
    ++num_bright;
  }
  [[nodiscard]] double brightness_correlation() const {
    const double n = num_bright;
    const double variances =
        (n * brightness[2] - brightness[0] * brightness[0]) * (n * brightness[3] - brightness[1] * brightness[1]);
    return (n * brightness[4] - brightness[0] * brightness[1]) / std::sqrt(variances);  // NaN without texture.
  }
  void add(const Sums& other) {
    equations += other.equations;
    unbiased += other.unbiased;
    distance_m += other.distance_m;
    num_pairs += other.num_pairs;
    for (int k = 0; k < 5; ++k) brightness[k] += other.brightness[k];
    num_bright += other.num_bright;
    num_matched += other.num_matched;
    num_seen_through += other.num_seen_through;
    cost += other.cost;
    num_compared += other.num_compared;
  }
};

// Bilinear value and gradient (per pixel) of an image; false at its border.
bool interpolate(const Image<float>& image, float u, float v, float& value, float& du, float& dv) {
  const int u0 = static_cast<int>(std::floor(u));
  const int v0 = static_cast<int>(std::floor(v));
  if (u0 < 0 || v0 < 0 || u0 + 1 >= image.width() || v0 + 1 >= image.height()) return false;
  const float a = u - static_cast<float>(u0);
  const float b = v - static_cast<float>(v0);
  const float* top = &image(u0, v0);
  const float* bottom = &image(u0, v0 + 1);
  const float du_top = top[1] - top[0];
  const float du_bottom = bottom[1] - bottom[0];
  const float at_top = top[0] + a * du_top;
  const float at_bottom = bottom[0] + a * du_bottom;
  value = at_top + b * (at_bottom - at_top);
  du = du_top + b * (du_bottom - du_top);
  dv = at_bottom - at_top;
  return true;
}

// One target at one level, as seen from the view.
class LevelTarget {
 public:
  LevelTarget(const AlignmentLevel& level, const Rigid3& target_from_view, const AlignViewOptions& options,
              double gate_m)
      : level_(level),
        pose_(target_from_view),
        options_(options),
        gate_m_(static_cast<float>(gate_m)),
        min_cosine_(static_cast<float>(std::cos(options.max_normal_angle_rad))) {}

  enum class Outcome { kNothing, kPair, kOccluded, kSeenThrough };

  /// Truncated squared distance of a sample to the target's surface, in [0, 1]; none where it measured nothing.
  [[nodiscard]] std::optional<float> cost(const Samples& samples, std::size_t s) const {
    const Eigen::Vector3f q = pose_ * samples.points[s];
    const std::optional<Pixel> pixel = level_.camera.pixel_of(q.cast<double>());
    if (!pixel) return std::nullopt;
    const std::size_t i = level_.cloud.z.index(pixel->u, pixel->v);
    if (!level_.cloud.has_point(i)) return std::nullopt;
    const Eigen::Vector3f normal = pose_.rotation * samples.normals[s];
    const float distance = normal.dot(q - level_.cloud.point(i));
    const float sigma_sq = samples.sigma_m[s] * samples.sigma_m[s] + level_.sigma_m[i] * level_.sigma_m[i];
    const auto limit = static_cast<float>(options_.max_noise_sigmas);
    return std::min(1.0F, distance * distance / (sigma_sq * limit * limit));
  }

  Outcome add(const Samples& samples, std::size_t s, Sums& sums) const {
    const Eigen::Vector3f p = samples.points[s];
    const Eigen::Vector3f q = pose_ * p;
    if (!(q.z() > 0.05F)) return Outcome::kNothing;
    const Camera& camera = level_.camera;
    const auto u = static_cast<float>(camera.fx * q.x() / q.z() + camera.cx);
    const auto v = static_cast<float>(camera.fy * q.y() / q.z() + camera.cy);
    if (!(u > -0.5F && v > -0.5F && u < static_cast<float>(camera.width) - 0.5F &&
          v < static_cast<float>(camera.height) - 0.5F))
      return Outcome::kNothing;
    const std::size_t i = level_.cloud.z.index(static_cast<int>(u + 0.5F), static_cast<int>(v + 0.5F));
    if (!level_.cloud.has_point(i)) return Outcome::kNothing;
    const float sigma_sq = samples.sigma_m[s] * samples.sigma_m[s] + level_.sigma_m[i] * level_.sigma_m[i];
    const float gate = std::max(gate_m_, static_cast<float>(options_.max_noise_sigmas) * std::sqrt(sigma_sq));
    const Eigen::Vector3f offset = q - level_.cloud.point(i);
    if (level_.cloud.has_normal(i) && offset.squaredNorm() < kMaxPairDistance * gate * kMaxPairDistance * gate) {
      const Eigen::Vector3f normal = level_.cloud.normal(i);
      const float distance = normal.dot(offset);
      if (std::abs(distance) < gate && normal.dot(pose_.rotation * samples.normals[s]) > min_cosine_) {
        add_pair(samples, s, q, {u, v}, normal, distance, gate, sigma_sq, sums);
        return Outcome::kPair;
      }
    }
    if (offset.z() > kMaxPairDistance * gate) return Outcome::kOccluded;
    return offset.z() < -kMaxPairDistance * gate ? Outcome::kSeenThrough : Outcome::kNothing;
  }

 private:
  void add_pair(const Samples& samples, std::size_t s, const Eigen::Vector3f& q, const Eigen::Vector2f& pixel,
                const Eigen::Vector3f& normal, float distance, float gate, float sigma_sq, Sums& sums) const {
    const Eigen::Vector3f p = samples.points[s];
    const double weight = tukey(distance / gate);
    // Derivatives of the motion of the point along a direction, in the view's frame, with respect to a twist of the
    // view.
    const Eigen::Vector3f normal_in_view = pose_.rotation.transpose() * normal;
    sums.add(point_to_plane_row(p, normal_in_view), point_to_plane_row(p, samples.normals[s]), distance,
             weight / sigma_sq);
    sums.distance_m += std::abs(distance);
    ++sums.num_pairs;
    if (options_.brightness_sigma <= 0) return;
    float value = 0, du = 0, dv = 0;
    if (!interpolate(level_.brightness, pixel.x(), pixel.y(), value, du, dv)) return;
    sums.add_brightness(value, samples.brightness[s]);
    const double residual = value - samples.brightness[s];
    const double sigma = options_.brightness_sigma;
    const double brightness_weight = weight * tukey(residual / (kBrightnessGate * sigma));
    if (brightness_weight == 0) return;
    const auto gu = static_cast<float>(du * level_.camera.fx) / q.z();
    const auto gv = static_cast<float>(dv * level_.camera.fy) / q.z();
    const Eigen::Vector3f gradient(gu, gv, -(gu * q.x() + gv * q.y()) / q.z());  // Brightness per metre.
    const Eigen::Vector3f gradient_in_view = pose_.rotation.transpose() * gradient;
    const Twistf j = point_to_plane_row(p, gradient_in_view);
    sums.add(j, j, residual, brightness_weight / (sigma * sigma));
  }

  const AlignmentLevel& level_;
  Rigid3f pose_;
  const AlignViewOptions& options_;
  float gate_m_;
  float min_cosine_;
};

enum class CostOfPairs : std::uint8_t { kSkipped, kComputed };

Sums sum_pairs(const Samples& samples, std::span<const AlignmentTarget> targets, std::size_t level,
               const Rigid3& world_from_camera, double gate_m, const AlignViewOptions& options,
               CostOfPairs cost_of_pairs = CostOfPairs::kSkipped) {
  std::vector<LevelTarget> seen;
  for (const AlignmentTarget& target : targets)
    seen.emplace_back(target.view->levels[level], target.world_from_camera.inverse() * world_from_camera, options,
                      gate_m);
  std::vector<Sums> partial((samples.points.size() + kBlock - 1) / kBlock);
  parallel_for_blocks(samples.points.size(), kBlock, options.num_threads, [&](std::size_t begin, std::size_t end) {
    Sums& sums = partial[begin / kBlock];
    for (std::size_t s = begin; s < end; ++s) {
      bool pair = false, hidden = false, in_front = false;
      for (const LevelTarget& target : seen) {
        const LevelTarget::Outcome outcome = target.add(samples, s, sums);
        pair |= outcome == LevelTarget::Outcome::kPair;
        hidden |= outcome == LevelTarget::Outcome::kOccluded;
        in_front |= outcome == LevelTarget::Outcome::kSeenThrough;
      }
      sums.num_matched += pair;
      sums.num_seen_through += in_front && !pair && !hidden;
      if (cost_of_pairs == CostOfPairs::kSkipped) continue;
      std::optional<float> least;
      for (const LevelTarget& target : seen)
        if (const std::optional<float> cost = target.cost(samples, s)) least = least ? std::min(*least, *cost) : cost;
      sums.cost += least.value_or(0);
      sums.num_compared += least.has_value();
    }
  });
  Sums all;
  for (const Sums& sums : partial) all.add(sums);
  all.equations.matrix = Matrix6(all.equations.matrix.selfadjointView<Eigen::Upper>());  // To the last bit.
  all.unbiased = 0.5 * Matrix6(all.unbiased + all.unbiased.transpose());
  return all;
}

// Projection onto the motions that the information constrains.
Matrix6 onto_known_motions(const Matrix6& information) {
  const Eigen::SelfAdjointEigenSolver<Matrix6> solver(information);
  Matrix6 projection = Matrix6::Zero();
  for (int i = 0; i < 6; ++i) {
    const Twist motion = solver.eigenvectors().col(i);
    if (solver.eigenvalues()[i] > kMinEigenvalueRatio * solver.eigenvalues()[5])
      projection += motion * motion.transpose();
  }
  return projection;
}

// Least-squares step. Directions that neither data nor prior constrain stay unchanged.
Twist solve_step(const Matrix6& h, const Matrix6& unbiased, const Twist& g) {
  const Matrix6 known = onto_known_motions(unbiased);
  const Matrix6 regular = known * h * known + (Matrix6::Identity() - known);
  return -known * Twist(regular.ldlt().solve(known * g));
}

Matrix6 known_information(const Matrix6& unbiased) {
  const Matrix6 known = onto_known_motions(unbiased);
  return known * unbiased * known;
}

Twist prior_information(const AlignViewOptions& options) {
  const auto inverse_sq = [](double sigma) { return sigma > 0 ? 1 / (sigma * sigma) : 0.0; };
  Twist information;
  information << Eigen::Vector3d::Constant(inverse_sq(options.prior_sigma_rad)),
      Eigen::Vector3d::Constant(inverse_sq(options.prior_sigma_m));
  return information;
}

Rigid3 align_level(const Samples& samples, std::span<const AlignmentTarget> targets, std::size_t level,
                   const Rigid3& given, Rigid3 pose, double gate_m, const AlignViewOptions& options) {
  const Twist prior = prior_information(options);
  for (int i = 0; i < options.max_iterations; ++i) {
    const Sums sums = sum_pairs(samples, targets, level, pose, gate_m, options);
    if (sums.num_pairs == 0) break;
    Matrix6 h = options.information_per_pair * sums.equations.matrix;
    Matrix6 unbiased = options.information_per_pair * sums.unbiased;
    h.diagonal() += prior;
    unbiased.diagonal() += prior;
    const Twist g =
        options.information_per_pair * sums.equations.right + prior.cwiseProduct(to_twist(given.inverse() * pose));
    const Twist step = solve_step(h, unbiased, g);
    pose = pose * from_twist(step);
    if (step.cwiseAbs().maxCoeff() < kConvergedStep) break;
  }
  pose.rotation = nearest_rotation(pose.rotation);
  return pose;
}

/// The levels that are used must be there in both.
void check_levels(const AlignmentView& view, std::span<const AlignmentTarget> targets, std::size_t num_levels) {
  require(!view.levels.empty(), "view: must have at least one level");
  for (const AlignmentTarget& target : targets)
    require(target.view != nullptr && target.view->levels.size() >= num_levels,
            "targets: must have at least as many levels as the view");
}

}  // namespace

void AlignViewOptions::check() const {
  check_positive("max_distance_m", max_distance_m);
  check_positive("min_distance_m", min_distance_m);
  check_positive("max_normal_angle_rad", max_normal_angle_rad);
  check_positive("max_noise_sigmas", max_noise_sigmas);
  check_not_negative("brightness_sigma", brightness_sigma);
  check_positive("num_levels", num_levels);
  check_positive("max_iterations", max_iterations);
  check_positive("max_samples", max_samples);
  check_not_negative("prior_sigma_m", prior_sigma_m);
  check_not_negative("prior_sigma_rad", prior_sigma_rad);
  check_positive("information_per_pair", information_per_pair);
  check_positive("num_threads", num_threads);
}

AlignedView evaluate_alignment(const AlignmentView& view, std::span<const AlignmentTarget> targets,
                               const Rigid3& world_from_camera, const AlignViewOptions& options) {
  options.check();
  check_levels(view, targets, 1);
  const Samples samples = draw_samples(view.levels[0], options.max_samples);
  const Sums sums =
      sum_pairs(samples, targets, 0, world_from_camera, options.min_distance_m, options, CostOfPairs::kComputed);
  AlignedView aligned;
  aligned.world_from_camera = world_from_camera;
  aligned.information = options.information_per_pair * known_information(sums.unbiased);
  const double num_samples = std::max<double>(1, static_cast<double>(samples.points.size()));
  aligned.overlap = sums.num_matched / num_samples;
  aligned.seen_through = sums.num_seen_through / num_samples;
  aligned.mean_distance_m = sums.num_pairs > 0 ? sums.distance_m / sums.num_pairs : 0;
  aligned.brightness_correlation = sums.brightness_correlation();
  aligned.num_pairs = sums.num_pairs;
  aligned.cost = sums.num_compared > 0 ? sums.cost / sums.num_compared : 0;
  return aligned;
}

AlignedView align_view(const AlignmentView& view, std::span<const AlignmentTarget> targets,
                       const Rigid3& world_from_camera, const AlignViewOptions& options) {
  options.check();
  check_levels(view, targets, view.levels.size());
  Rigid3 pose = world_from_camera;
  const std::size_t num_levels = std::min(view.levels.size(), static_cast<std::size_t>(options.num_levels));
  const double min_m = std::min(options.min_distance_m, options.max_distance_m);
  for (std::size_t l = num_levels; l-- > 0;) {
    const double coarseness = num_levels > 1 ? static_cast<double>(l) / static_cast<double>(num_levels - 1) : 0;
    const double gate_m = min_m * std::pow(options.max_distance_m / min_m, coarseness);
    const Samples samples = draw_samples(view.levels[l], options.max_samples);
    pose = align_level(samples, targets, l, world_from_camera, pose, gate_m, options);
  }
  return evaluate_alignment(view, targets, pose, options);
}

}  // namespace resight
