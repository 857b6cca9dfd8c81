// SPDX-License-Identifier: Apache-2.0
#include "resight/registration/pose_estimation.hpp"

#include <Eigen/SVD>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "resight/core/check.hpp"
#include "resight/core/random.hpp"

namespace resight {
namespace {

constexpr float kNotInlier = std::numeric_limits<float>::infinity();
constexpr double kConfidence = 0.9999;    // Probability that at least one sample without outliers is drawn.
constexpr int kSamplesPerIteration = 50;  // At most this many samples are drawn per scored pose.
constexpr int kMaxRefinements = 50;       // Ends alternation between two sets of inliers.
// Metres and radians. A refinement that moves the pose by less has converged.
constexpr double kStill = 5e-5;
// Ratio of the two largest singular values of the cross-covariance below which the pairs count as collinear. It equals
// a spread across the line of 1e-4 of the spread along it, far above the rounding of single-precision coordinates.
constexpr double kLineRatio = 1e-8;
// In slimmer triangles, noise decides the rotation about the long side.
constexpr double kMinTriangleSine = 0.05;

// Squared distance if the correspondence agrees with the pose, otherwise infinite. The comparisons reject NaN points
// and accept NaN normals.
float residual_sq(const Correspondence& c, const Rigid3f& scene_from_model, float max_distance_sq, float min_cosine) {
  const float distance_sq = (scene_from_model * c.model_point - c.scene_point).squaredNorm();
  if (!(distance_sq <= max_distance_sq)) return kNotInlier;
  const float cosine = (scene_from_model.rotation * c.model_normal).dot(c.scene_normal);
  return cosine < min_cosine ? kNotInlier : distance_sq;
}

struct InlierTest {
  explicit InlierTest(const EstimatePoseOptions& options)
      : max_distance_sq(static_cast<float>(options.inlier_distance_m * options.inlier_distance_m)),
        min_cosine(static_cast<float>(std::cos(options.max_normal_angle_rad))) {}
  float max_distance_sq;
  float min_cosine;
  [[nodiscard]] float residual_sq(const Correspondence& c, const Rigid3f& pose) const {
    return resight::residual_sq(c, pose, max_distance_sq, min_cosine);
  }
};

struct Score {
  float value = 0;  // MSAC score: sum of 1 - d^2 / max^2 over the inliers.
  int num_inliers = 0;
};

Score score_pose(std::span<const Correspondence> correspondences, const Rigid3& pose, const InlierTest& test) {
  const Rigid3f pose_f(pose);
  Score score;
  for (const Correspondence& c : correspondences) {
    const float r = test.residual_sq(c, pose_f);
    if (r == kNotInlier) continue;
    score.value += 1.0F - r / test.max_distance_sq;
    ++score.num_inliers;
  }
  return score;
}

using Sample = std::array<const Correspondence*, 3>;

bool edges_agree(const Sample& sample, double max_difference_m) {
  for (int i = 0; i < 3; ++i) {
    const Correspondence& a = *sample[static_cast<std::size_t>(i)];
    const Correspondence& b = *sample[static_cast<std::size_t>((i + 1) % 3)];
    const float model_m = (a.model_point - b.model_point).norm();
    const float scene_m = (a.scene_point - b.scene_point).norm();
    if (!(std::abs(model_m - scene_m) <= static_cast<float>(max_difference_m))) return false;
  }
  return true;
}

// Unit normal of a triangle; none if the triangle is too slim to define a pose.
std::optional<Eigen::Vector3d> triangle_normal(const std::array<Eigen::Vector3d, 3>& p) {
  const Eigen::Vector3d a = p[1] - p[0];
  const Eigen::Vector3d b = p[2] - p[0];
  const Eigen::Vector3d cross = a.cross(b);
  const double longest_sq = std::max({a.squaredNorm(), b.squaredNorm(), (p[2] - p[1]).squaredNorm()});
  const double length = cross.norm();
  if (!(length > kMinTriangleSine * longest_sq)) return std::nullopt;
  return cross / length;
}

// Least-squares fit of three pairs in closed form. The planes of both triangles coincide; the in-plane rotation follows
// from the summed cross and dot products of the corners about their means. Ten times faster than an SVD.
std::optional<Rigid3> fit_triangle(const Sample& sample) {
  std::array<Eigen::Vector3d, 3> m;
  std::array<Eigen::Vector3d, 3> s;
  for (std::size_t i = 0; i < 3; ++i) {
    m[i] = sample[i]->model_point.cast<double>();
    s[i] = sample[i]->scene_point.cast<double>();
  }
  const auto model_normal = triangle_normal(m);
  const auto scene_normal = triangle_normal(s);
  if (!model_normal || !scene_normal) return std::nullopt;
  const Eigen::Vector3d model_mean = (m[0] + m[1] + m[2]) / 3.0;
  const Eigen::Vector3d scene_mean = (s[0] + s[1] + s[2]) / 3.0;
  const Eigen::Quaterniond tilt = Eigen::Quaterniond::FromTwoVectors(*model_normal, *scene_normal);
  double sine = 0;
  double cosine = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const Eigen::Vector3d from = tilt * (m[i] - model_mean);
    const Eigen::Vector3d to = s[i] - scene_mean;
    sine += from.cross(to).dot(*scene_normal);
    cosine += from.dot(to);
  }
  Rigid3 pose;
  pose.rotation =
      Eigen::AngleAxisd(std::atan2(sine, cosine), *scene_normal).toRotationMatrix() * tilt.toRotationMatrix();
  pose.translation = scene_mean - pose.rotation * model_mean;
  return pose;
}

bool draw_sample(std::span<const Correspondence> correspondences, Rng& rng, Sample& sample) {
  const auto n = static_cast<std::uint32_t>(correspondences.size());
  const std::uint32_t a = rng.below(n);
  const std::uint32_t b = rng.below(n);
  const std::uint32_t c = rng.below(n);
  sample = {&correspondences[a], &correspondences[b], &correspondences[c]};
  return a != b && b != c && a != c;
}

// Number of samples needed to draw one without outliers, with probability kConfidence.
double num_samples_needed(int num_inliers, std::size_t num_correspondences) {
  const auto n = static_cast<double>(num_correspondences);
  const double k = num_inliers;
  // Probability of a sample of inliers only, drawn with repetition as in draw_sample.
  const double hit = (k / n) * ((k - 1) / n) * ((k - 2) / n);
  if (hit <= 0) return std::numeric_limits<double>::infinity();
  return std::log(1.0 - kConfidence) / std::log1p(-std::min(hit, 1.0 - 1e-12));
}

// Keeps the best of the poses proposed by samples.
class PoseSearch {
 public:
  PoseSearch(std::span<const Correspondence> correspondences, const EstimatePoseOptions& options)
      : correspondences_(correspondences), options_(options), test_(options) {}

  // Scores the pose of the sample, unless the triangles differ or the pose does not fit even the sample.
  void consider(const Sample& sample) {
    // Each of two inliers may be off by the inlier distance, in opposite directions.
    if (!edges_agree(sample, 2 * options_.inlier_distance_m)) return;
    const auto pose = fit_triangle(sample);
    if (!pose) return;
    const Rigid3f pose_f(*pose);
    if (std::any_of(sample.begin(), sample.end(),
                    [&](const Correspondence* c) { return test_.residual_sq(*c, pose_f) == kNotInlier; }))
      return;
    ++num_scored_;
    const Score score = score_pose(correspondences_, *pose, test_);
    if (score.value <= best_score_.value) return;
    best_ = *pose;
    best_score_ = score;
  }

  [[nodiscard]] int num_scored() const { return num_scored_; }
  [[nodiscard]] int num_inliers() const { return best_score_.num_inliers; }
  [[nodiscard]] std::optional<Rigid3> best() const {
    if (best_score_.num_inliers < options_.min_inliers) return std::nullopt;
    return best_;
  }

 private:
  std::span<const Correspondence> correspondences_;
  const EstimatePoseOptions& options_;
  InlierTest test_;
  Rigid3 best_;
  Score best_score_;
  int num_scored_ = 0;
};

bool few_triples(std::size_t n, int max_triples) {
  return n < 100 && n * (n - 1) * (n - 2) / 6 <= static_cast<std::size_t>(max_triples);
}

void try_all_triples(std::span<const Correspondence> correspondences, PoseSearch& search) {
  const std::size_t n = correspondences.size();
  for (std::size_t a = 0; a < n; ++a)
    for (std::size_t b = a + 1; b < n; ++b)
      for (std::size_t c = b + 1; c < n; ++c)
        search.consider({&correspondences[a], &correspondences[b], &correspondences[c]});
}

void try_random_triples(std::span<const Correspondence> correspondences, const EstimatePoseOptions& options,
                        PoseSearch& search) {
  Rng rng(options.seed);
  double needed = std::numeric_limits<double>::infinity();
  const double max_samples = static_cast<double>(kSamplesPerIteration) * options.max_iterations;
  int num_inliers = 0;
  Sample sample{};
  for (double drawn = 0; drawn < std::min(needed, max_samples); ++drawn) {
    if (search.num_scored() >= options.max_iterations) return;
    if (!draw_sample(correspondences, rng, sample)) continue;
    search.consider(sample);
    if (search.num_inliers() == num_inliers) continue;
    num_inliers = search.num_inliers();
    needed = num_samples_needed(num_inliers, correspondences.size());
  }
}

std::optional<Rigid3> sample_pose(std::span<const Correspondence> correspondences, const EstimatePoseOptions& options) {
  PoseSearch search(correspondences, options);
  if (few_triples(correspondences.size(), options.max_iterations))
    try_all_triples(correspondences, search);
  else
    try_random_triples(correspondences, options, search);
  return search.best();
}

std::vector<int> inlier_indices(const std::vector<float>& residuals_sq) {
  std::vector<int> inliers;
  for (std::size_t i = 0; i < residuals_sq.size(); ++i)
    if (residuals_sq[i] != kNotInlier) inliers.push_back(static_cast<int>(i));
  return inliers;
}

// One step of iteratively re-weighted least squares. Like Tukey's biweight, the weight 1 - d^2 / max^2 reaches zero at
// the inlier distance, but it falls more slowly, so that small groups keep more of their few points.
std::optional<Rigid3> fit_inliers(std::span<const Correspondence> correspondences, const std::vector<int>& inliers,
                                  const std::vector<float>& residuals_sq, double max_distance_sq) {
  std::vector<Eigen::Vector3f> model;
  std::vector<Eigen::Vector3f> scene;
  std::vector<double> weights;
  for (const int i : inliers) {
    const Correspondence& c = correspondences[static_cast<std::size_t>(i)];
    const double u = 1.0 - static_cast<double>(residuals_sq[static_cast<std::size_t>(i)]) / max_distance_sq;
    model.push_back(c.model_point);
    scene.push_back(c.scene_point);
    // Not zero, so that an inlier at the very limit still counts as a pair.
    weights.push_back(std::max(u, 1e-6));
  }
  return fit_rigid(model, scene, weights);
}

double rms_of(const std::vector<int>& inliers, const std::vector<float>& residuals_sq) {
  double sum = 0;
  for (const int i : inliers) sum += static_cast<double>(residuals_sq[static_cast<std::size_t>(i)]);
  return inliers.empty() ? 0.0 : std::sqrt(sum / static_cast<double>(inliers.size()));
}

struct WeightedMeans {
  Eigen::Vector3d model = Eigen::Vector3d::Zero();
  Eigen::Vector3d scene = Eigen::Vector3d::Zero();
  double weight = 0;
  int count = 0;
};

}  // namespace

std::optional<Rigid3> fit_rigid(std::span<const Eigen::Vector3f> model, std::span<const Eigen::Vector3f> scene,
                                std::span<const double> weights) {
  require(model.size() == scene.size(), "fit_rigid: model and scene differ in length");
  require(weights.empty() || weights.size() == model.size(), "fit_rigid: weights and points differ in length");
  const auto weight_of = [&](std::size_t i) {
    require(weights.empty() || weights[i] >= 0, "fit_rigid: a weight is negative or NaN");
    return model[i].allFinite() && scene[i].allFinite() ? (weights.empty() ? 1.0 : weights[i]) : 0.0;
  };
  WeightedMeans means;
  for (std::size_t i = 0; i < model.size(); ++i) {
    const double w = weight_of(i);
    if (w == 0) continue;
    means.model += w * model[i].cast<double>();
    means.scene += w * scene[i].cast<double>();
    means.weight += w;
    ++means.count;
  }
  if (means.count < 3) return std::nullopt;
  means.model /= means.weight;
  means.scene /= means.weight;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < model.size(); ++i) {
    const double w = weight_of(i);
    if (w == 0) continue;
    covariance += w * (scene[i].cast<double>() - means.scene) * (model[i].cast<double>() - means.model).transpose();
  }
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Vector3d& singular = svd.singularValues();
  if (!(singular[1] > kLineRatio * singular[0])) return std::nullopt;
  Eigen::Matrix3d u = svd.matrixU();
  // Enforces a rotation instead of a reflection.
  if ((u * svd.matrixV().transpose()).determinant() < 0) u.col(2) = -u.col(2);
  Rigid3 scene_from_model;
  scene_from_model.rotation = u * svd.matrixV().transpose();
  scene_from_model.translation = means.scene - scene_from_model.rotation * means.model;
  return scene_from_model;
}

std::vector<float> inlier_residuals_sq(std::span<const Correspondence> correspondences, const Rigid3& scene_from_model,
                                       const EstimatePoseOptions& options) {
  options.check();
  const InlierTest test(options);
  const Rigid3f pose(scene_from_model);
  std::vector<float> residuals(correspondences.size());
  for (std::size_t i = 0; i < correspondences.size(); ++i) residuals[i] = test.residual_sq(correspondences[i], pose);
  return residuals;
}

std::optional<PoseEstimate> refine_pose(std::span<const Correspondence> correspondences, const Rigid3& scene_from_model,
                                        const EstimatePoseOptions& options) {
  options.check();
  PoseEstimate estimate;
  estimate.scene_from_model = scene_from_model;
  std::vector<float> residuals = inlier_residuals_sq(correspondences, scene_from_model, options);
  estimate.inliers = inlier_indices(residuals);
  for (int i = 0; i < kMaxRefinements; ++i) {
    if (static_cast<int>(estimate.inliers.size()) < options.min_inliers) return std::nullopt;
    const auto fit = fit_inliers(correspondences, estimate.inliers, residuals,
                                 options.inlier_distance_m * options.inlier_distance_m);
    if (!fit) return std::nullopt;
    const bool moved = ((*fit).matrix() - estimate.scene_from_model.matrix()).cwiseAbs().maxCoeff() > kStill;
    estimate.scene_from_model = *fit;
    residuals = inlier_residuals_sq(correspondences, *fit, options);
    std::vector<int> inliers = inlier_indices(residuals);
    const bool changed = inliers != estimate.inliers;
    estimate.inliers = std::move(inliers);
    // The weights change with the pose even if the set of inliers does not.
    if (!changed && !moved) break;
  }
  if (static_cast<int>(estimate.inliers.size()) < options.min_inliers) return std::nullopt;
  estimate.rms_m = rms_of(estimate.inliers, residuals);
  return estimate;
}

std::optional<PoseEstimate> estimate_pose(std::span<const Correspondence> correspondences,
                                          const EstimatePoseOptions& options) {
  options.check();
  if (static_cast<int>(correspondences.size()) < options.min_inliers) return std::nullopt;
  const auto start = sample_pose(correspondences, options);
  if (!start) return std::nullopt;
  return refine_pose(correspondences, *start, options);
}

}  // namespace resight
