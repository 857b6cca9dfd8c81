// SPDX-License-Identifier: Apache-2.0
#include "resight/verification/light_fit.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace resight {
namespace {

constexpr std::size_t kMinSamples = 10;
constexpr std::size_t kMaxSamples = 400;
constexpr int kIterations = 4;
constexpr float kDark = 0.01F;          // Added to both sides: the ratio of two dark colours is noise.
constexpr float kScale = 0.3F;          // Of the Cauchy weight, in log units: print that does not fit counts little.
constexpr double kShadingPrior = 0.05;  // Share of the total weight: normals that hardly differ say nothing on shading.

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

struct Sample {
  Eigen::Array3f log_ratio;
  Eigen::Vector3f normal;
};

std::vector<Sample> make_samples(std::span<const Eigen::Vector3f> model_linear,
                                 std::span<const Eigen::Vector3f> scene_linear,
                                 std::span<const Eigen::Vector3f> normals) {
  const std::size_t step = (model_linear.size() + kMaxSamples - 1) / kMaxSamples;
  std::vector<Sample> samples;
  for (std::size_t i = 0; i < model_linear.size(); i += step)
    samples.push_back({(scene_linear[i].array() + kDark).log() - (model_linear[i].array() + kDark).log(),
                       normals.empty() ? Eigen::Vector3f(Eigen::Vector3f::Zero()) : normals[i]});
  return samples;
}

Eigen::Array3f median_ratio(const std::vector<Sample>& samples) {
  Eigen::Array3f median;
  std::vector<float> values(samples.size());
  for (int c = 0; c < 3; ++c) {
    std::transform(samples.begin(), samples.end(), values.begin(), [c](const Sample& s) { return s.log_ratio[c]; });
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    median[c] = *middle;
  }
  return median;
}

// One weighted least-squares step for (log gain of r, g, b; shading).
LightFit refit(const std::vector<Sample>& samples, const LightFit& current) {
  Matrix6 normal_matrix = Matrix6::Zero();
  Vector6 right = Vector6::Zero();
  double total = 0;
  for (const Sample& s : samples) {
    const Eigen::Array3f residual = s.log_ratio - current.log_gain - current.shading.dot(s.normal);
    const double w = 1.0 / (1.0 + residual.square().sum() / (3 * kScale * kScale));
    total += w;
    const Eigen::Vector3d n = s.normal.cast<double>();
    for (int c = 0; c < 3; ++c) {
      normal_matrix(c, c) += w;
      normal_matrix.block<1, 3>(c, 3) += w * n.transpose();
      normal_matrix.block<3, 3>(3, 3) += w * n * n.transpose();
      right[c] += w * s.log_ratio[c];
      right.tail<3>() += w * s.log_ratio[c] * n;
    }
  }
  normal_matrix.block<3, 3>(3, 3).diagonal().array() += kShadingPrior * total;
  normal_matrix.block<3, 3>(0, 0).diagonal().array() += 1e-9;
  normal_matrix.block<3, 3>(3, 0) = normal_matrix.block<3, 3>(0, 3).transpose();
  const Vector6 x = normal_matrix.ldlt().solve(right);
  return {x.head<3>().cast<float>().array(), x.tail<3>().cast<float>()};
}

void limit(LightFit& fit, const LightLimits& limits) {
  const float exposure = std::clamp(fit.log_gain.mean(), -static_cast<float>(limits.max_log_exposure),
                                    static_cast<float>(limits.max_log_exposure));
  const float chroma = static_cast<float>(limits.max_log_chroma);
  fit.log_gain = exposure + (fit.log_gain - fit.log_gain.mean()).max(-chroma).min(chroma);
  const float length = fit.shading.norm();
  if (length > limits.max_log_shading) fit.shading *= static_cast<float>(limits.max_log_shading) / length;
}

}  // namespace

Eigen::Vector3f to_linear_light(Rgb8 color) {
  static const std::array<float, 256> table = [] {
    std::array<float, 256> linear{};
    for (int i = 0; i < 256; ++i) {
      const double s = i / 255.0;
      linear[static_cast<std::size_t>(i)] =
          static_cast<float>(s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4));
    }
    return linear;
  }();
  return {table[color.r], table[color.g], table[color.b]};
}

std::vector<Eigen::Vector3f> to_linear_light(std::span<const Rgb8> colors) {
  std::vector<Eigen::Vector3f> result;
  result.reserve(colors.size());
  for (const Rgb8 c : colors) result.push_back(to_linear_light(c));
  return result;
}

LightFit fit_light(std::span<const Eigen::Vector3f> model_linear, std::span<const Eigen::Vector3f> scene_linear,
                   std::span<const Eigen::Vector3f> normals, const LightLimits& limits) {
  if (model_linear.size() < kMinSamples) return {};
  const std::vector<Sample> samples = make_samples(model_linear, scene_linear, normals);
  LightFit fit{median_ratio(samples)};
  for (int i = 0; i < kIterations; ++i) fit = refit(samples, fit);
  limit(fit, limits);
  return fit;
}

}  // namespace resight
