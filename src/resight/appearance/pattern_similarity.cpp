// SPDX-License-Identifier: Apache-2.0
#include "resight/appearance/pattern_similarity.hpp"

#include <Eigen/Core>
#include <algorithm>

#include "resight/core/check.hpp"

namespace resight {
namespace {

// Variance that lighting, gloss and registration leave between equal patterns.
constexpr double kNoiseVariance = 0.25 * 0.25;

Eigen::Vector3d weighted(const LabColor& color, double chroma_weight) {
  return {color.l, chroma_weight * color.a, chroma_weight * color.b};
}

}  // namespace

PatternMatch match_patterns(std::span<const LabColor> a, std::span<const LabColor> b, double chroma_weight) {
  require(a.size() == b.size(), "match_patterns: the patterns differ in size");
  if (a.empty()) return {};
  Eigen::Vector3d mean_a = Eigen::Vector3d::Zero();
  Eigen::Vector3d mean_b = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < a.size(); ++i) {
    mean_a += weighted(a[i], chroma_weight);
    mean_b += weighted(b[i], chroma_weight);
  }
  const double n = static_cast<double>(a.size());
  mean_a /= n;
  mean_b /= n;
  double variances = 0;
  double covariance = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const Eigen::Vector3d x = weighted(a[i], chroma_weight) - mean_a;
    const Eigen::Vector3d y = weighted(b[i], chroma_weight) - mean_b;
    variances += x.squaredNorm() + y.squaredNorm();
    covariance += x.dot(y);
  }
  return {(2 * covariance / n + kNoiseVariance) / (variances / n + kNoiseVariance),
          std::max(0.0, covariance / n / kNoiseVariance)};
}

double pattern_similarity(std::span<const LabColor> a, std::span<const LabColor> b, double chroma_weight) {
  return match_patterns(a, b, chroma_weight).similarity;
}

}  // namespace resight
