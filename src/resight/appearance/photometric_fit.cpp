// SPDX-License-Identifier: Apache-2.0
#include "resight/appearance/photometric_fit.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace resight {
namespace {

constexpr std::size_t kMinPairs = 10;  // Fewer do not determine gain, offset and shading.
constexpr int kMaxPairs = 400;         // Beyond, every n-th pair is used: the size of arrays on the stack.
constexpr int kIterations = 5;         // Of reweighted least squares.
// Scale of the Cauchy weight, in square roots of light. It reduces the influence of texture that does not fit.
constexpr float kScale = 0.15F;
constexpr float kDark = 0.05F;  // Dark pairs weigh more, as in perception; this value limits their weight.
// Share of the total weight. Without it, nearly equal normals would determine the shading.
constexpr float kShadingPrior = 0.05F;
// Weight of a line without offset, relative to the total weight of the squared light. Without it, the noise of a plain
// colour would determine the offset: less than a tenth of contrast says little of it.
constexpr float kProportionalPrior = 0.01F;
constexpr float kMinGain = 0.05F;     // Keeps the logarithm of the gain finite for black pairs.
constexpr double kVotesForNone = 20;  // Votes for a neutral white balance: a few correspondences alone do not shift it.
constexpr float kLeastLight = 1e-3F;  // Of black models, whose channels then count alike.
constexpr float kDim =
    0.1F;  // The vote of a fit with so little light in a channel counts a quarter; see trust_in_chroma().

template <int kColumns>
using Columns = Eigen::Array<float, Eigen::Dynamic, kColumns, Eigen::ColMajor, kMaxPairs, kColumns>;
using Column = Columns<1>;

// Stored by columns, for vector code.
struct Pairs {
  Columns<3> model;
  Columns<3> scene;
  Columns<3> scene_root;
  Columns<4> normals;         // After a column of ones.
  Columns<3> channel_weight;  // Of each pair in each channel.
  Column trust;               // Of each pair, in (0, 1]: small for texture that does not fit.
  Column shade;               // Brightness factor of each pair from the shading.
};

Pairs make_pairs(std::span<const Eigen::Vector3f> model_linear, std::span<const Eigen::Vector3f> scene_linear,
                 std::span<const Eigen::Vector3f> normals) {
  const std::size_t step = (model_linear.size() + kMaxPairs - 1) / kMaxPairs;
  const auto count = static_cast<Eigen::Index>((model_linear.size() + step - 1) / step);
  Pairs pairs;
  pairs.model.resize(count, 3);
  pairs.scene.resize(count, 3);
  pairs.normals = Columns<4>::Zero(count, 4);
  pairs.normals.col(0) = 1;
  for (Eigen::Index row = 0; row < count; ++row) {
    const std::size_t i = static_cast<std::size_t>(row) * step;
    pairs.model.row(row) = model_linear[i].transpose();
    pairs.scene.row(row) = scene_linear[i].transpose();
    if (!normals.empty()) pairs.normals.row(row).tail<3>() = normals[i].transpose();
  }
  pairs.scene_root = pairs.scene.sqrt();
  pairs.channel_weight = 1 / (kDark + pairs.model);
  pairs.trust = Column::Ones(count);
  pairs.shade = Column::Ones(count);
  return pairs;
}

// Gain and offset of one channel: a weighted line through (model, scene) with its offset within [0, max_offset].
std::pair<float, float> fit_channel(const Pairs& pairs, int c, float max_offset) {
  const Column w = pairs.trust * pairs.channel_weight.col(c);
  const Column x = pairs.model.col(c) * pairs.shade;
  const auto y = pairs.scene.col(c);
  const float total = w.sum();
  const float mean_x = (w * x).sum() / total;
  const float mean_y = (w * y).sum() / total;
  const float variance = (w * (x - mean_x).square()).sum();
  const float xx = (w * x.square()).sum();
  const float ratio = xx > 0 ? (w * x * y).sum() / xx : 1;
  const float prior = kProportionalPrior * xx;
  const float slope = ((w * (x - mean_x) * y).sum() + prior * ratio) / (variance + prior);
  const float offset = xx > 0 ? std::clamp(mean_y - slope * mean_x, 0.0F, max_offset) : 0;
  const float gain = xx > 0 ? (w * x * (y - offset)).sum() / xx : 1;
  return {std::max(gain, kMinGain), offset};
}

// Shading from the remaining brightness as a function of the normal. The gains account for the constant part.
Eigen::Vector3f fit_shading(const Pairs& pairs, const PhotometricFit& fit) {
  const Column expected = (pairs.model.matrix() * fit.log_gain.exp().matrix()).array();
  const Column seen = (pairs.scene.rowwise() - fit.offset.transpose()).max(0.0F).rowwise().sum();
  const Column log_ratio = ((seen + kDark) / (expected + kDark)).log().max(-1.0F).min(1.0F);
  const Column weight = pairs.trust / (kDark + pairs.model.rowwise().mean());
  const Columns<4> weighted = pairs.normals.colwise() * weight;
  Eigen::Matrix4f normal_matrix = weighted.matrix().transpose() * pairs.normals.matrix();
  const Eigen::Vector4f right = weighted.matrix().transpose() * log_ratio.matrix();
  normal_matrix.diagonal().tail<3>().array() += kShadingPrior * weight.sum();
  normal_matrix(0, 0) += 1e-6F;
  return normal_matrix.ldlt().solve(right).tail<3>();
}

// Mean over the channels by their light: the gain of a dim channel is uncertain, and a camera that saturates colours
// takes nearly all of its light away.
float mean_by_light(const Eigen::Array3f& log_gain, const PhotometricFit& fit) {
  return (fit.model_light * log_gain).sum() / fit.model_light.sum();
}

void limit_exposure(PhotometricFit& fit, const PhotometricLimits& limits) {
  const float mean = mean_by_light(fit.log_gain, fit);
  fit.log_gain +=
      std::clamp(mean, -static_cast<float>(limits.max_log_darkening), static_cast<float>(limits.max_log_exposure)) -
      mean;
  const float length = fit.shading.norm();
  if (length > limits.max_log_shading) fit.shading *= static_cast<float>(limits.max_log_shading) / length;
}

void reweigh(Pairs& pairs, const PhotometricFit& fit) {
  pairs.shade = (pairs.normals.rightCols<3>().matrix() * fit.shading).array().exp();
  Column error = Column::Zero(pairs.trust.size());
  for (int c = 0; c < 3; ++c) {
    const float gain = std::exp(fit.log_gain[c]);
    const auto expected = (pairs.model.col(c) * pairs.shade * gain + fit.offset[c]).max(0.0F).min(1.0F);
    error += (expected.sqrt() - pairs.scene_root.col(c)).square();
  }
  pairs.trust = 1 / (1 + error / (3 * kScale * kScale));
}

double trust_in_chroma(const PhotometricFit& fit) {
  const double dimmest = fit.model_light.minCoeff();
  const double share = dimmest / (dimmest + kDim);
  return share * share;
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

PhotometricFit fit_photometry(std::span<const Eigen::Vector3f> model_linear,
                              std::span<const Eigen::Vector3f> scene_linear, std::span<const Eigen::Vector3f> normals,
                              const PhotometricLimits& limits) {
  if (model_linear.size() < kMinPairs) return {};
  Pairs pairs = make_pairs(model_linear, scene_linear, normals);
  PhotometricFit fit;
  fit.num_pairs = static_cast<int>(model_linear.size());
  fit.model_light = pairs.model.colwise().mean().transpose() + kLeastLight;
  for (int i = 0; i < kIterations; ++i) {
    for (int c = 0; c < 3; ++c) {
      const auto [gain, offset] = fit_channel(pairs, c, static_cast<float>(limits.max_offset));
      fit.log_gain[c] = std::log(gain);
      fit.offset[c] = offset;
    }
    if (!normals.empty()) fit.shading = fit_shading(pairs, fit);
    limit_exposure(fit, limits);
    reweigh(pairs, fit);
  }
  return fit;
}

Eigen::Array3f find_white_balance(std::span<const PhotometricFit> fits, std::span<const float> votes) {
  Eigen::Array3f balance = Eigen::Array3f::Zero();
  for (int c = 0; c < 3; ++c) {
    std::vector<std::pair<float, double>> values{{0.0F, kVotesForNone}};
    for (std::size_t i = 0; i < fits.size(); ++i)
      if (fits[i].num_pairs > 0) values.emplace_back(fits[i].chroma()[c], votes[i] * trust_in_chroma(fits[i]));
    balance[c] = weighted_median(std::move(values));
  }
  const float most = static_cast<float>(kMaxLogWhiteBalance);
  return balance.max(-most).min(most);
}

PhotometricFit limit_chromaticity(PhotometricFit fit, const Eigen::Array3f& white_balance) {
  if (fit.num_pairs == 0) return fit;
  const float most = static_cast<float>(kMaxLogChroma);
  const Eigen::Array3f balanced = fit.log_gain - white_balance;
  const float mean = mean_by_light(balanced, fit);
  fit.log_gain = mean + white_balance + (balanced - mean).max(-most).min(most);
  return fit;
}

}  // namespace resight
