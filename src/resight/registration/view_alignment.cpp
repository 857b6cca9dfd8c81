// SPDX-License-Identifier: Apache-2.0
#include "resight/registration/view_alignment.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "resight/core/check.hpp"
#include "resight/core/parallel.hpp"
#include "resight/registration/point_to_plane.hpp"
#include "resight/registration/twist.hpp"

namespace resight {
namespace {

constexpr std::size_t kBlock = 512;  // Samples per partial sum.
// Radians and metres; smaller steps have converged. Twice as large at each coarser level, as the pixels are.
constexpr double kConvergedStep = 4e-5;
// Directions whose information is below this share of the best-known direction count as unconstrained and stay
// unchanged.
constexpr double kMinEigenvalueRatio = 3e-4;
// Noisy normals alone seem to give information. Directions with less than so many standard deviations of that count as
// unconstrained, too.
constexpr double kMinNoiseSigmas = 3;
constexpr float kBrightnessGate = 4;  // In units of brightness_sigma.
// Parts of the image whose brightness is compared.
constexpr int kBlocksAlongRow = 8;
constexpr int kBlocksAlongColumn = 6;
constexpr int kMinBlockPairs = 20;
// Largest point-to-point distance of a pair, in units of its largest point-to-plane distance.
constexpr float kMaxPairDistance = 3;

// Points of one level that are aligned.
std::vector<AlignmentPoint> draw_samples(const AlignmentLevel& level, int max_samples) {
  const auto num_usable = static_cast<double>(std::ranges::count_if(level.points.data(), &AlignmentPoint::has_normal));
  const int step = std::max(1, static_cast<int>(std::ceil(std::sqrt(num_usable / max_samples))));
  std::vector<AlignmentPoint> samples;
  for (int v = 0; v < level.points.height(); v += step)
    for (int u = 0; u < level.points.width(); u += step)
      if (level.points(u, v).has_normal()) samples.push_back(level.points(u, v));
  return samples;
}

// Products of the rows of pairs, in single precision.
struct RowProducts {
  // Derivatives with respect to a twist of the view, the residual, and 0.
  using Row = Eigen::Matrix<float, 8, 1>;
  using Products = Eigen::Matrix<float, 8, 6>;
  Products own = Products::Zero();
  Products own_outside = Products::Zero();  // Of pairs whose normals differ by more than the gate.
  Products with_other = Products::Zero();
  Products of_brightness = Products::Zero();

  static Row row(const Eigen::Vector3f& arm, const Eigen::Vector3f& direction, float residual) {
    Row row;
    row << arm.cross(direction), direction, residual, 0.0F;
    return row;
  }
  void add_distance(const Row& row, const Row& other, float weight, bool is_pair) {
    Products& of_row = is_pair ? own : own_outside;
    const Eigen::Matrix<float, 6, 1> weighted = weight * row.head<6>();
    for (int c = 0; c < 6; ++c) {
      of_row.col(c) += weighted[c] * row;
      with_other.col(c) += weighted[c] * other;
    }
  }
  void add_brightness(const Row& row, float weight) {
    for (int c = 0; c < 6; ++c) of_brightness.col(c) += weight * row[c] * row;
  }
};

// Normal equations and counts. Partial sums are added in order, so that results do not depend on the number of threads.
struct Sums {
  NormalEquations equations;
  // Like its matrix, with the view's own normal in one of the two factors. Noise tilts every normal slightly, so that
  // the matrix claims information along a featureless floor. The noise of two independent normals cancels. Symmetric
  // only in the total.
  Matrix6 unbiased = Matrix6::Zero();
  Matrix6 noise = Matrix6::Zero();  // What noise adds to the matrix: the difference of the two.
  double distance_m = 0;
  int num_pairs = 0;
  double brightness[5] = {};  // Sums of a, b, a^2, b^2 and a b over num_bright pairs.
  int num_bright = 0;
  int num_matched = 0;  // Samples with a pair in at least one target.
  int num_seen_through = 0;
  double cost = 0;
  int num_compared = 0;

  void add(const RowProducts& products) {
    const Eigen::Matrix<double, 8, 6> own = products.own.cast<double>();
    const Eigen::Matrix<double, 8, 6> of_brightness = products.of_brightness.cast<double>();
    equations.matrix += (own + of_brightness).topRows<6>();
    equations.right += (own + of_brightness).row(6).transpose();
    const Matrix6 with_other = products.with_other.cast<double>().topRows<6>();
    unbiased += with_other + of_brightness.topRows<6>();
    noise += (own + products.own_outside.cast<double>()).topRows<6>() - with_other;
  }
  void add_brightness(double a, double b) {
    const double terms[5] = {a, b, a * a, b * b, a * b};
    for (int k = 0; k < 5; ++k) brightness[k] += terms[k];
    ++num_bright;
  }
  // NaN without texture: noise would lower the correlation of the same texture to 2/3 or less.
  [[nodiscard]] double brightness_correlation(double noise_of_a, double noise_of_b) const {
    constexpr double kMinVariances = 3;  // Of the noise.
    const double n = num_bright;
    const double of_a = n * brightness[2] - brightness[0] * brightness[0];
    const double of_b = n * brightness[3] - brightness[1] * brightness[1];
    if (of_a < n * n * kMinVariances * noise_of_a * noise_of_a ||
        of_b < n * n * kMinVariances * noise_of_b * noise_of_b)
      return std::numeric_limits<double>::quiet_NaN();
    return (n * brightness[4] - brightness[0] * brightness[1]) / std::sqrt(of_a * of_b);
  }
  void add(const Sums& other) {
    equations += other.equations;
    unbiased += other.unbiased;
    noise += other.noise;
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

// Bilinear value and gradient (per pixel) of the brightness; false at the image border.
bool interpolate(const Image<AlignmentPoint>& image, float u, float v, float& value, float& du, float& dv) {
  const int u0 = static_cast<int>(std::floor(u));
  const int v0 = static_cast<int>(std::floor(v));
  if (u0 < 0 || v0 < 0 || u0 + 1 >= image.width() || v0 + 1 >= image.height()) return false;
  const float a = u - static_cast<float>(u0);
  const float b = v - static_cast<float>(v0);
  const AlignmentPoint* top = &image(u0, v0);
  const AlignmentPoint* bottom = &image(u0, v0 + 1);
  const float du_top = top[1].brightness - top[0].brightness;
  const float du_bottom = bottom[1].brightness - bottom[0].brightness;
  const float at_top = top[0].brightness + a * du_top;
  const float at_bottom = bottom[0].brightness + a * du_bottom;
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
        view_from_target_rotation_(pose_.rotation.transpose()),
        focal_(static_cast<float>(level.camera.fx), static_cast<float>(level.camera.fy)),
        center_(static_cast<float>(level.camera.cx), static_cast<float>(level.camera.cy)),
        end_(static_cast<float>(level.camera.width) - 0.5F, static_cast<float>(level.camera.height) - 0.5F),
        gate_m_(static_cast<float>(gate_m)),
        min_cosine_(static_cast<float>(std::cos(options.max_normal_angle_rad))),
        max_noise_sigmas_(static_cast<float>(options.max_noise_sigmas)),
        brightness_sigma_(static_cast<float>(options.brightness_sigma)) {}

  enum class Outcome { kNothing, kPair, kOccluded, kSeenThrough };

  /// Truncated squared distance of a sample to the target's surface, in [0, 1]; none where it measured nothing.
  [[nodiscard]] std::optional<float> cost(const AlignmentPoint& sample) const {
    const Eigen::Vector3f q = pose_ * sample.position;
    const std::optional<Pixel> pixel = level_.camera.pixel_of(q.cast<double>());
    if (!pixel) return std::nullopt;
    const AlignmentPoint& at = level_.points(pixel->u, pixel->v);
    if (!at.is_measured()) return std::nullopt;
    const float distance = (pose_.rotation * sample.normal).dot(q - at.position);
    const float sigma_sq = sample.sigma_m * sample.sigma_m + at.sigma_m * at.sigma_m;
    return std::min(1.0F, distance * distance / (sigma_sq * max_noise_sigmas_ * max_noise_sigmas_));
  }

  Outcome add(const AlignmentPoint& sample, RowProducts& products, Sums& sums) const {
    const Eigen::Vector3f q = pose_ * sample.position;
    if (!(q.z() > 0.05F)) return Outcome::kNothing;
    const Eigen::Vector2f pixel = focal_.cwiseProduct(q.head<2>()) / q.z() + center_;
    if (!(pixel.x() > -0.5F && pixel.y() > -0.5F && pixel.x() < end_.x() && pixel.y() < end_.y()))
      return Outcome::kNothing;
    const AlignmentPoint& at = level_.points(static_cast<int>(pixel.x() + 0.5F), static_cast<int>(pixel.y() + 0.5F));
    if (!at.is_measured()) return Outcome::kNothing;
    const float sigma_sq = sample.sigma_m * sample.sigma_m + at.sigma_m * at.sigma_m;
    const float gate = std::max(gate_m_, max_noise_sigmas_ * std::sqrt(sigma_sq));
    const Eigen::Vector3f offset = q - at.position;
    if (at.has_normal() && offset.squaredNorm() < kMaxPairDistance * gate * kMaxPairDistance * gate) {
      const float distance = at.normal.dot(offset);
      const Eigen::Vector3f normal_in_view = view_from_target_rotation_ * at.normal;
      const float cosine = normal_in_view.dot(sample.normal);
      const auto weight = static_cast<float>(std::abs(distance) < gate ? tukey(distance / gate) : 0);
      // Derivatives of the motion of the point along a direction, in the view's frame, with respect to a twist of the
      // view.
      if (weight > 0)
        products.add_distance(RowProducts::row(sample.position, normal_in_view, distance),
                              RowProducts::row(sample.position, sample.normal, 0), weight / sigma_sq,
                              cosine > min_cosine_);
      if (std::abs(distance) < gate && cosine > min_cosine_) {
        sums.distance_m += std::abs(distance);
        ++sums.num_pairs;
        if (brightness_sigma_ > 0) add_brightness(sample, q, pixel, weight, products, sums);
        return Outcome::kPair;
      }
    }
    if (offset.z() > kMaxPairDistance * gate) return Outcome::kOccluded;
    return offset.z() < -kMaxPairDistance * gate ? Outcome::kSeenThrough : Outcome::kNothing;
  }

 private:
  void add_brightness(const AlignmentPoint& sample, const Eigen::Vector3f& q, const Eigen::Vector2f& pixel,
                      float weight, RowProducts& products, Sums& sums) const {
    float value = 0, du = 0, dv = 0;
    if (!interpolate(level_.points, pixel.x(), pixel.y(), value, du, dv)) return;
    sums.add_brightness(value, sample.brightness);
    const float residual = value - sample.brightness;
    weight *= static_cast<float>(tukey(residual / (kBrightnessGate * brightness_sigma_)));
    if (weight == 0) return;
    const float gu = du * focal_.x() / q.z();
    const float gv = dv * focal_.y() / q.z();
    const Eigen::Vector3f gradient(gu, gv, -(gu * q.x() + gv * q.y()) / q.z());  // Brightness per metre.
    products.add_brightness(RowProducts::row(sample.position, view_from_target_rotation_ * gradient, residual),
                            weight / (brightness_sigma_ * brightness_sigma_));
  }

  const AlignmentLevel& level_;
  Rigid3f pose_;
  Eigen::Matrix3f view_from_target_rotation_;
  Eigen::Vector2f focal_;
  Eigen::Vector2f center_;
  Eigen::Vector2f end_;
  float gate_m_;
  float min_cosine_;
  float max_noise_sigmas_;
  float brightness_sigma_;
};

enum class CostOfPairs : std::uint8_t { kSkipped, kComputed };

Sums sum_pairs(std::span<const AlignmentPoint> samples, std::span<const AlignmentTarget> targets, std::size_t level,
               const Rigid3& world_from_camera, double gate_m, const AlignViewOptions& options,
               CostOfPairs cost_of_pairs = CostOfPairs::kSkipped) {
  std::vector<LevelTarget> seen;
  for (const AlignmentTarget& target : targets)
    seen.emplace_back(target.view->levels[level], target.world_from_camera.inverse() * world_from_camera, options,
                      gate_m);
  std::vector<Sums> partial((samples.size() + kBlock - 1) / kBlock);
  parallel_for_blocks(samples.size(), kBlock, options.num_threads, [&](std::size_t begin, std::size_t end) {
    Sums& sums = partial[begin / kBlock];
    RowProducts products;
    for (const AlignmentPoint& sample : samples.subspan(begin, end - begin)) {
      bool pair = false, hidden = false, in_front = false;
      for (const LevelTarget& target : seen) {
        const LevelTarget::Outcome outcome = target.add(sample, products, sums);
        pair |= outcome == LevelTarget::Outcome::kPair;
        hidden |= outcome == LevelTarget::Outcome::kOccluded;
        in_front |= outcome == LevelTarget::Outcome::kSeenThrough;
      }
      sums.num_matched += pair;
      sums.num_seen_through += in_front && !pair && !hidden;
      if (cost_of_pairs == CostOfPairs::kSkipped) continue;
      std::optional<float> least;
      for (const LevelTarget& target : seen)
        if (const std::optional<float> cost = target.cost(sample)) least = least ? std::min(*least, *cost) : cost;
      sums.cost += least.value_or(0);
      sums.num_compared += least.has_value();
    }
    sums.add(products);
  });
  Sums all;
  for (const Sums& sums : partial) all.add(sums);
  all.equations.matrix = Matrix6(all.equations.matrix.selfadjointView<Eigen::Upper>());  // To the last bit.
  all.unbiased = 0.5 * Matrix6(all.unbiased + all.unbiased.transpose());
  all.noise = 0.5 * Matrix6(all.noise + all.noise.transpose());
  return all;
}

// What the pairs tell of a motion.
struct Knowledge {
  Matrix6 information;  // Without what noise adds.
  Matrix6 noise;        // Standard deviation of the information along a motion that they do not constrain.

  Knowledge(const Sums& sums, double information_per_pair)
      : information(information_per_pair * sums.unbiased),
        noise(information_per_pair * sums.noise / std::sqrt(std::max(1.0, information_per_pair * sums.num_pairs))) {}

  // Projection onto the motions that the information constrains.
  [[nodiscard]] Matrix6 onto_known_motions() const {
    const Eigen::SelfAdjointEigenSolver<Matrix6> solver(information);
    Matrix6 projection = Matrix6::Zero();
    for (int i = 0; i < 6; ++i) {
      const Twist motion = solver.eigenvectors().col(i);
      const double by_chance = kMinNoiseSigmas * motion.dot(noise * motion);
      if (solver.eigenvalues()[i] > std::max(kMinEigenvalueRatio * solver.eigenvalues()[5], by_chance))
        projection += motion * motion.transpose();
    }
    return projection;
  }
  [[nodiscard]] Matrix6 known_information() const {
    const Matrix6 known = onto_known_motions();
    return known * information * known;
  }
};

Twist prior_information(const AlignViewOptions& options) {
  const auto inverse_sq = [](double sigma) { return sigma > 0 ? 1 / (sigma * sigma) : 0.0; };
  Twist information;
  information << Eigen::Vector3d::Constant(inverse_sq(options.prior_sigma_rad)),
      Eigen::Vector3d::Constant(inverse_sq(options.prior_sigma_m));
  return information;
}

// Least-squares step. What the pairs do not constrain is left to the prior, and stays unchanged without one.
Twist solve_step(const Sums& sums, const Rigid3& given, const Rigid3& pose, const AlignViewOptions& options) {
  const double weight = options.information_per_pair;
  const Matrix6 known = Knowledge(sums, weight).onto_known_motions();
  const Twist prior = prior_information(options);
  Matrix6 matrix = known * (weight * sums.equations.matrix) * known + (Matrix6::Identity() - known);
  matrix.diagonal() += prior;
  const Twist right = known * (weight * sums.equations.right) + prior.cwiseProduct(to_twist(given.inverse() * pose));
  return -Twist(matrix.ldlt().solve(right));
}

Rigid3 align_level(std::span<const AlignmentPoint> samples, std::span<const AlignmentTarget> targets, std::size_t level,
                   const Rigid3& given, Rigid3 pose, double gate_m, const AlignViewOptions& options) {
  const double converged_step = std::ldexp(kConvergedStep, static_cast<int>(level));
  for (int i = 0; i < options.max_iterations; ++i) {
    const Sums sums = sum_pairs(samples, targets, level, pose, gate_m, options);
    if (sums.num_pairs == 0) break;
    const Twist step = solve_step(sums, given, pose, options);
    pose = pose * from_twist(step);
    if (step.cwiseAbs().maxCoeff() < converged_step) break;
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
  const std::vector<AlignmentPoint> samples = draw_samples(view.levels[0], options.max_samples);
  const Sums sums =
      sum_pairs(samples, targets, 0, world_from_camera, options.min_distance_m, options, CostOfPairs::kComputed);
  AlignedView aligned;
  aligned.world_from_camera = world_from_camera;
  aligned.information = Knowledge(sums, options.information_per_pair).known_information();
  const double num_samples = std::max<double>(1, static_cast<double>(samples.size()));
  aligned.overlap = sums.num_matched / num_samples;
  aligned.seen_through = sums.num_seen_through / num_samples;
  aligned.mean_distance_m = sums.num_pairs > 0 ? sums.distance_m / sums.num_pairs : 0;
  double noise_of_targets = 0;
  for (const AlignmentTarget& target : targets)
    noise_of_targets = std::max(noise_of_targets, target.view->brightness_noise);
  aligned.brightness_correlation = sums.brightness_correlation(noise_of_targets, view.brightness_noise);
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
    const std::vector<AlignmentPoint> samples = draw_samples(view.levels[l], options.max_samples);
    pose = align_level(samples, targets, l, world_from_camera, pose, gate_m, options);
  }
  return evaluate_alignment(view, targets, pose, options);
}

Image<BlockSimilarity> compare_blocks(const AlignmentView& view, const AlignmentTarget& target,
                                      const Rigid3& world_from_camera, const AlignViewOptions& options) {
  options.check();
  check_levels(view, std::span(&target, 1), 1);
  const AlignmentLevel& level = view.levels[0];
  const LevelTarget seen(target.view->levels[0], target.world_from_camera.inverse() * world_from_camera, options,
                         options.min_distance_m);
  Image<Sums> sums(kBlocksAlongRow, kBlocksAlongColumn);
  RowProducts unused;
  for (const AlignmentPoint& sample : draw_samples(level, options.max_samples))
    if (const std::optional<Pixel> pixel = level.camera.pixel_of(sample.position.cast<double>()))
      seen.add(
          sample, unused,
          sums(pixel->u * kBlocksAlongRow / level.camera.width, pixel->v * kBlocksAlongColumn / level.camera.height));
  Image<BlockSimilarity> blocks(kBlocksAlongRow, kBlocksAlongColumn, BlockSimilarity::kUnknown);
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    const double correlation = sums[i].brightness_correlation(target.view->brightness_noise, view.brightness_noise);
    if (sums[i].num_bright >= kMinBlockPairs && !std::isnan(correlation))
      blocks[i] = correlation > 0 ? BlockSimilarity::kSimilar : BlockSimilarity::kDissimilar;
  }
  return blocks;
}

}  // namespace resight
