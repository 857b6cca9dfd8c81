// SPDX-License-Identifier: Apache-2.0
#include "resight/verification/light_fit.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace resight {
namespace {

constexpr std::size_t kMinPairs = 10;
constexpr std::size_t kMaxPairs = 400;
constexpr int kIterations = 5;
constexpr float kScale =
    0.15F;  // Of the Cauchy weight, in square roots of light: print that does not fit counts little.
constexpr float kDark = 0.05F;          // Dark pairs weigh more, as they do to the eye, down to this.
constexpr float kShadingPrior = 0.05F;  // Share of the total weight: normals that hardly differ tell no shading.
constexpr float kMinGain = 0.05F;
constexpr double kVotesForNone = 400;

struct Pair {
  Eigen::Array3f model;
  Eigen::Array3f scene;
  Eigen::Vector3f normal;
  float base_weight = 1;
  float weight = 1;
};

std::vector<Pair> make_pairs(std::span<const Eigen::Vector3f> model_linear,
                             std::span<const Eigen::Vector3f> scene_linear, std::span<const Eigen::Vector3f> normals) {
  const std::size_t step = (model_linear.size() + kMaxPairs - 1) / kMaxPairs;
  std::vector<Pair> pairs;
  for (std::size_t i = 0; i < model_linear.size(); i += step) {
    Pair pair{model_linear[i].array(), scene_linear[i].array(),
              normals.empty() ? Eigen::Vector3f(Eigen::Vector3f::Zero()) : normals[i]};
    pair.base_weight = pair.weight = 1 / (kDark + pair.model.mean());
    pairs.push_back(pair);
  }
  return pairs;
}

// Gain and veil of one channel: a weighted line through (model, scene), its offset within [0, max_veil].
std::pair<float, float> fit_channel(const std::vector<Pair>& pairs, const LightFit& fit, int c, float max_veil) {
  double w = 0, x = 0, y = 0, xx = 0, xy = 0;
  for (const Pair& p : pairs) {
    const double m = p.model[c] * std::exp(fit.shading.dot(p.normal));
    const double s = p.scene[c];
    w += p.weight;
    x += p.weight * m;
    y += p.weight * s;
    xx += p.weight * m * m;
    xy += p.weight * m * s;
  }
  const double determinant = w * xx - x * x;
  double veil = determinant > 1e-9 * w * xx ? (xx * y - x * xy) / determinant : 0;
  veil = std::clamp<double>(veil, 0, max_veil);
  const double gain = xx > 0 ? (xy - veil * x) / xx : 1;
  return {std::max(static_cast<float>(gain), kMinGain), static_cast<float>(veil)};
}

// Brightness that is left, as a function of the normal. The constant part is left to the gains.
Eigen::Vector3f fit_shading(const std::vector<Pair>& pairs, const LightFit& fit) {
  Eigen::Matrix4f normal_matrix = Eigen::Matrix4f::Zero();
  Eigen::Vector4f right = Eigen::Vector4f::Zero();
  float total = 0;
  for (const Pair& p : pairs) {
    const float expected = (p.model * fit.log_gain.exp()).sum();
    const float seen = (p.scene - fit.veil).max(0.0F).sum();
    const float log_ratio = std::clamp(std::log((seen + kDark) / (expected + kDark)), -1.0F, 1.0F);
    const Eigen::Vector4f row(1, p.normal.x(), p.normal.y(), p.normal.z());
    normal_matrix += p.weight * row * row.transpose();
    right += p.weight * log_ratio * row;
    total += p.weight;
  }
  normal_matrix.diagonal().tail<3>().array() += kShadingPrior * total;
  normal_matrix(0, 0) += 1e-6F;
  return normal_matrix.ldlt().solve(right).tail<3>();
}

void limit_exposure(LightFit& fit, const LightLimits& limits) {
  const float mean = fit.log_gain.mean();
  fit.log_gain +=
      std::clamp(mean, -static_cast<float>(limits.max_log_darkening), static_cast<float>(limits.max_log_exposure)) -
      mean;
  const float length = fit.shading.norm();
  if (length > limits.max_log_shading) fit.shading *= static_cast<float>(limits.max_log_shading) / length;
}

void reweigh(std::vector<Pair>& pairs, const LightFit& fit) {
  for (Pair& p : pairs) {
    const Eigen::Array3f expected = fit(p.model.matrix(), p.normal).array();
    const float error = (expected.max(0.0F).sqrt() - p.scene.sqrt()).square().sum();
    p.weight = p.base_weight / (1 + error / (3 * kScale * kScale));
  }
}

float weighted_median(std::vector<std::pair<float, double>> values) {
  std::sort(values.begin(), values.end());
  double total = 0;
  for (const auto& [value, weight] : values) total += weight;
  double below = 0;
  for (const auto& [value, weight] : values) {
    below += weight;
    if (2 * below >= total) return value;
  }
  return 0;
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
  if (model_linear.size() < kMinPairs) return {};
  std::vector<Pair> pairs = make_pairs(model_linear, scene_linear, normals);
  LightFit fit;
  fit.num_pairs = static_cast<int>(model_linear.size());
  for (int i = 0; i < kIterations; ++i) {
    for (int c = 0; c < 3; ++c) {
      const auto [gain, veil] = fit_channel(pairs, fit, c, static_cast<float>(limits.max_veil));
      fit.log_gain[c] = std::log(gain);
      fit.veil[c] = veil;
    }
    if (!normals.empty()) fit.shading = fit_shading(pairs, fit);
    limit_exposure(fit, limits);
    reweigh(pairs, fit);
  }
  return fit;
}

Eigen::Array3f find_white_balance(std::span<const LightFit> fits, std::span<const float> votes,
                                  const LightLimits& limits) {
  Eigen::Array3f balance = Eigen::Array3f::Zero();
  for (int c = 0; c < 3; ++c) {
    std::vector<std::pair<float, double>> values{{0.0F, kVotesForNone}};
    for (std::size_t i = 0; i < fits.size(); ++i)
      if (fits[i].num_pairs > 0) values.emplace_back(fits[i].chroma()[c], votes[i]);
    balance[c] = weighted_median(std::move(values));
  }
  const float most = static_cast<float>(limits.max_log_white_balance);
  return balance.max(-most).min(most);
}

LightFit limit_chroma(LightFit fit, const Eigen::Array3f& white_balance, const LightLimits& limits) {
  if (fit.num_pairs == 0) return fit;
  const float most = static_cast<float>(limits.max_log_chroma);
  fit.log_gain = fit.log_gain.mean() + white_balance + (fit.chroma() - white_balance).max(-most).min(most);
  return fit;
}

}  // namespace resight
