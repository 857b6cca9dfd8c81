// SPDX-License-Identifier: Apache-2.0
#include "resight/verification/symmetry_resolution.hpp"

#include "resight/appearance/pattern_similarity.hpp"
#include "resight/verification/scene_preparation.hpp"

namespace resight {
namespace {

constexpr std::size_t kMaxComparedPoints = 150;  // Every n-th point is compared beyond, for speed.
constexpr std::size_t kMinComparedPoints = 20;   // Fewer colours do not determine a pattern.
constexpr double kMinSimilarityGain = 0.05;  // Of the likeness: noise alone does not rotate a pose that texture found.

// Textures whose mean chromaticities differ are not alike, however well their patterns agree.
double likeness(std::span<const LabColor> model, std::span<const LabColor> scene, double chroma_weight) {
  constexpr double kChromaticityWeight = 8;  // A difference of 0.08 (10 of a* or b*) costs as much as the least gain.
  double da = 0;
  double db = 0;
  for (std::size_t i = 0; i < model.size(); ++i) {
    da += model[i].a - scene[i].a;
    db += model[i].b - scene[i].b;
  }
  const auto n = static_cast<double>(model.size());
  return pattern_similarity(model, scene, chroma_weight) - kChromaticityWeight * (da * da + db * db) / (n * n);
}

}  // namespace

Rigid3 resolve_symmetry(const PreparedModel& model, std::span<const ExplainedPoint> points, double chroma_weight) {
  Rigid3 best = Rigid3::identity();
  if (model.symmetry_motions.size() < 2 || points.size() < kMinComparedPoints) return best;
  const std::size_t step = (points.size() + kMaxComparedPoints - 1) / kMaxComparedPoints;
  std::vector<LabColor> seen;
  for (std::size_t i = 0; i < points.size(); i += step) seen.push_back(points[i].color);
  std::vector<LabColor> expected(seen.size());
  double best_likeness = 0;
  for (const Rigid3& motion : model.symmetry_motions) {
    const Rigid3f rotated_from_object(motion.inverse());
    for (std::size_t k = 0; k < seen.size(); ++k) {
      const int nearest = model.nearest.nearest(rotated_from_object * points[k * step].p_in_object);
      expected[k] = nearest < 0 ? LabColor{} : model.lab[static_cast<std::size_t>(nearest)];
    }
    const double found = likeness(expected, seen, chroma_weight);
    const bool is_first = &motion == &model.symmetry_motions.front();
    if (!is_first && found <= best_likeness) continue;
    best_likeness = found + (is_first ? kMinSimilarityGain : 0);
    best = motion;
  }
  return best;
}

}  // namespace resight
