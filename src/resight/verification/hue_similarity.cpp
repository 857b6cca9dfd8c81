// SPDX-License-Identifier: Apache-2.0
#include "resight/verification/hue_similarity.hpp"

#include <cmath>
#include <vector>

#include "resight/core/check.hpp"
#include "resight/verification/surface_cells.hpp"

namespace resight {

double hue_similarity(std::span<const Eigen::Vector3f> points, std::span<const LabColor> expected,
                      std::span<const LabColor> seen, const AppearanceOptions& options) {
  require(expected.size() == points.size() && seen.size() == points.size(), "hue_similarity: not one colour per point");
  if (!options.pattern_radius_m || points.empty()) return 1;
  const SurfaceCells cells(points, *options.pattern_radius_m);
  const std::vector<LabColor> known = cells.means(expected);
  const std::vector<LabColor> found = cells.means(seen);
  const double without_hue = options.sigma_ab * options.sigma_ab * static_cast<double>(points.size());
  double agreement = without_hue;
  double chroma = without_hue;
  for (std::size_t c = 0; c < known.size(); ++c) {
    const double n = cells.num_points(c);
    agreement += n * (known[c].a * found[c].a + known[c].b * found[c].b);
    chroma += n * std::hypot(known[c].a, known[c].b) * std::hypot(found[c].a, found[c].b);
  }
  return agreement / chroma;
}

}  // namespace resight
