// SPDX-License-Identifier: Apache-2.0
#include "resight/changes/depth_changes.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "resight/core/parallel.hpp"
#include "resight/geometry/rigid3.hpp"
#include "resight/sensor/pixel_components.hpp"

namespace resight {
namespace {

constexpr int kMinRadius_px = 2;
constexpr int kMinToClear = 2;    // Views that see through a surface before it has left: one may err.
constexpr int kMaxGap_px = 2;     // Within a region: the pixels of one view do not cover all of another's.
constexpr int kMinAroundGap = 6;  // Of 25 pixels: a quarter. So many are met if the camera comes twice as near.

/// Calls `visit` with each pixel that is at most kMaxGap_px rows and columns away.
template <typename Visit>
void visit_neighbours(const Image<std::uint8_t>& image, std::size_t pixel, const Visit& visit) {
  const int row = static_cast<int>(pixel) / image.width();
  const int column = static_cast<int>(pixel) % image.width();
  for (int v = std::max(row - kMaxGap_px, 0); v <= std::min(row + kMaxGap_px, image.height() - 1); ++v)
    for (int u = std::max(column - kMaxGap_px, 0); u <= std::min(column + kMaxGap_px, image.width() - 1); ++u)
      visit(image.index(u, v));
}

/// What a view and an earlier one say about each other.
struct PairEvidence {
  ViewComparison of_view;     ///< What the earlier view says about the surfaces of the view.
  ViewComparison of_earlier;  ///< The reverse.
  double noise_scale = 1;
};

/// After a move, a measurement beside a surface may explain it, because poses are never exact. A still camera sees a
/// surface at the same pixel; only contours waver, as in stereo.
PairEvidence compare_both_ways(const PreparedView& view, const PreparedView& earlier, const DepthTestOptions& options,
                               int num_threads) {
  PairEvidence pair;
  pair.noise_scale = estimate_noise_scale(view, earlier);
  const int contours_px = std::max(estimate_misregistration_px(view, earlier, pair.noise_scale, options.sigmas),
                                   estimate_misregistration_px(earlier, view, pair.noise_scale, options.sigmas));
  const bool is_still = is_same_pose(view.frame.world_from_camera, earlier.frame.world_from_camera);
  const CompareViewsOptions compare{.sigmas = options.sigmas,
                                    .recolored_sigmas = options.recolored_sigmas,
                                    .window_radius_px = is_still ? 0 : std::max(kMinRadius_px, contours_px),
                                    .contour_radius_px = contours_px,
                                    .num_threads = num_threads};
  pair.of_view = compare_views(view, earlier, pair.noise_scale, compare);
  pair.of_earlier = compare_views(earlier, view, pair.noise_scale, compare);
  return pair;
}

/// From the newest earlier view to the oldest: a surface of before that kMinToClear newer views saw through had left,
/// so that it explains nothing.
Image<std::uint8_t> find_novel(const PreparedView& view, std::span<const PairEvidence> pairs,
                               std::size_t& num_explained) {
  Image<std::uint8_t> num_seen_through(view.cloud.width(), view.cloud.height());
  Image<std::uint8_t> explained(num_seen_through);
  for (std::size_t e = pairs.size(); e-- > 0;)
    for (std::size_t i = 0; i < explained.size(); ++i) {
      if (explained[i] != 0 || num_seen_through[i] >= kMinToClear) continue;
      const Evidence evidence = pairs[e].of_view.evidence[i];
      if (evidence == Evidence::kPresent) explained[i] = 1;
      if (evidence == Evidence::kSeenThrough) ++num_seen_through[i];
    }
  Image<std::uint8_t> novel(num_seen_through);
  for (std::size_t i = 0; i < novel.size(); ++i) {
    num_explained += explained[i];
    novel[i] = explained[i] == 0 && num_seen_through[i] > 0 ? 1 : 0;
  }
  return novel;
}

/// Whether two pixels show one surface: each lies in the tangent plane of the other, within the noise.
bool is_continued(const PreparedView& view, std::size_t a, std::size_t b, double max_sigmas) {
  if (!view.cloud.has_normal(a) || !view.cloud.has_normal(b)) return false;
  const Eigen::Vector3f step = view.cloud.point(b) - view.cloud.point(a);
  const float distance_m = std::max(std::abs(view.cloud.normal(a).dot(step)), std::abs(view.cloud.normal(b).dot(step)));
  return distance_m <= static_cast<float>(max_sigmas) * std::hypot(view.noise.normal_m[a], view.noise.normal_m[b]);
}

/// Whether a novel region fills a hole: the newest earlier view measured nothing at most of its pixels, and most of
/// its border goes on into surface that this view has seen as it is now.
bool fills_hole(const PreparedView& view, const PreparedView& newest, const PairEvidence& pair, double sigmas,
                const Image<std::uint8_t>& novel, std::span<const int> region) {
  std::size_t num_in_holes = 0;
  for (const int i : region) {
    const int seen_at = pair.of_view.pixels[static_cast<std::size_t>(i)];
    num_in_holes += seen_at >= 0 && std::isnan(newest.frame.depth_m[static_cast<std::size_t>(seen_at)]) ? 1U : 0U;
  }
  if (2 * num_in_holes <= region.size()) return false;
  int num_bordering = 0;
  int num_continued = 0;
  for (const int i : region) {
    visit_neighbours(novel, static_cast<std::size_t>(i), [&](std::size_t j) {
      if (novel[j] != 0 || !view.cloud.has_point(j)) return;
      ++num_bordering;
      if (pair.of_view.evidence[j] != Evidence::kPresent) return;
      num_continued += is_continued(view, static_cast<std::size_t>(i), j, sigmas * pair.noise_scale) ? 1 : 0;
    });
  }
  return 2 * num_continued > num_bordering;
}

void drop_filled_holes(const PreparedView& view, const PreparedView& newest, const PairEvidence& pair, double sigmas,
                       Image<std::uint8_t>& novel) {
  const Image<std::uint8_t> all = novel;
  for (const std::vector<int>& region : find_pixel_components(all, kMaxGap_px))
    if (fills_hole(view, newest, pair, sigmas, all, region))
      for (const int i : region) novel[static_cast<std::size_t>(i)] = 0;
}

/// Mean contradiction by the earlier views that see through a novel surface; 0 at other pixels.
Image<float> measure_novel(std::span<const PairEvidence> pairs, const Image<std::uint8_t>& novel) {
  Image<float> sum(novel.width(), novel.height());
  Image<std::uint16_t> num(novel.width(), novel.height());
  for (const PairEvidence& pair : pairs)
    for (std::size_t i = 0; i < novel.size(); ++i) {
      if (novel[i] == 0 || pair.of_view.evidence[i] != Evidence::kSeenThrough) continue;
      sum[i] += pair.of_view.contradiction[i];
      ++num[i];
    }
  for (std::size_t i = 0; i < sum.size(); ++i)
    if (num[i] > 0) sum[i] /= static_cast<float>(num[i]);
  return sum;
}

/// Neighbouring errors of depth are alike. A region of noise may therefore have many pixels that are off by little, but
/// not many that are off by much. In images of more than 640 x 480, noise and things have more pixels.
void drop_weak_regions(const Image<float>& contradictions, int min_region_px, Image<std::uint8_t>& mask) {
  constexpr double kPixels = 640.0 * 480.0;
  const double min_mass = min_region_px * std::max(1.0, static_cast<double>(mask.size()) / kPixels);
  for (const std::vector<int>& region : find_pixel_components(mask, kMaxGap_px)) {
    double mass = 0;
    for (const int i : region) mass += contradictions[static_cast<std::size_t>(i)];
    if (mass < min_mass)
      for (const int i : region) mask[static_cast<std::size_t>(i)] = 0;
  }
}

/// Pixels of an earlier view that the view sees through, and where in the view they are.
struct GonePixels {
  std::vector<int> in_earlier;
  std::vector<int> in_view;
};

/// Collects the removed surface of one earlier view after another, from the newest to the oldest. The newest one that
/// saw a place decides: had the surface of an older one left before, it would have been cleared then.
class RemovedSurface {
 public:
  RemovedSurface(const PreparedView& view, std::span<const PreparedView* const> earlier_views)
      : earlier_views_(earlier_views),
        met_(view.cloud.width(), view.cloud.height()),
        decided_(met_),
        removed_(decided_),
        contradictions_(view.cloud.width(), view.cloud.height()) {}

  [[nodiscard]] GonePixels add(const PairEvidence& pair, std::size_t earlier) {
    const Image<Evidence>& evidence = pair.of_earlier.evidence;
    GonePixels gone;
    std::vector<std::size_t> present;
    newer_from_earlier_.clear();
    for (const PreparedView* view : earlier_views_)
      newer_from_earlier_.emplace_back(view->frame.world_from_camera.inverse() *
                                       earlier_views_[earlier]->frame.world_from_camera);
    for (std::size_t i = 0; i < evidence.size(); ++i) {
      if (pair.of_earlier.pixels[i] < 0) continue;
      const auto at = static_cast<std::size_t>(pair.of_earlier.pixels[i]);
      met_[at] = 1;
      if (!is_observed(evidence[i])) continue;
      if (evidence[i] == Evidence::kPresent) present.push_back(at);
      if (evidence[i] == Evidence::kPresent || (decided_[at] != 0 && was_seen_later(earlier, i))) continue;
      removed_[at] = 1;
      contradictions_[at] = std::max(contradictions_[at], pair.of_earlier.contradiction[i]);
      gone.in_earlier.push_back(static_cast<int>(i));
      gone.in_view.push_back(static_cast<int>(at));
    }
    for (const std::size_t at : present) decided_[at] = 1;
    return gone;
  }
  Image<std::uint8_t>& mask() { return removed_; }
  /// A pixel that no earlier view projects to is removed if most of those around it are.
  void fill_gaps();
  /// Largest contradiction per removed pixel.
  [[nodiscard]] const Image<float>& contradictions() const { return contradictions_; }

 private:
  /// Whether a newer earlier view saw the place of a pixel. One that has met the same pixel of the view may have seen
  /// what is behind that place only.
  [[nodiscard]] bool was_seen_later(std::size_t earlier, std::size_t pixel) const;

  std::span<const PreparedView* const> earlier_views_;  // Oldest first.
  std::vector<Rigid3f> newer_from_earlier_;             // From the camera of the view that is added, by earlier view.
  Image<std::uint8_t> met_;                             // Pixels to which an earlier view projects.
  Image<std::uint8_t> decided_;
  Image<std::uint8_t> removed_;
  Image<float> contradictions_;
};

bool RemovedSurface::was_seen_later(std::size_t earlier, std::size_t pixel) const {
  const Eigen::Vector3f point = earlier_views_[earlier]->cloud.point(pixel);
  for (std::size_t newer = earlier + 1; newer < earlier_views_.size(); ++newer) {
    const RgbdFrame& frame = earlier_views_[newer]->frame;
    const Eigen::Vector3f p_in_camera = newer_from_earlier_[newer] * point;
    if (is_observed(classify_point(p_in_camera, {frame.camera, frame.depth_m}, DepthMargin{}))) return true;
  }
  return false;
}

void RemovedSurface::fill_gaps() {
  Image<std::uint8_t> is_tested(removed_);
  std::vector<std::size_t> gaps;
  const auto test = [&](std::size_t i) {
    if (is_tested[i] != 0 || met_[i] != 0) return;
    is_tested[i] = 1;
    int num_removed = 0;
    int num_present = 0;
    visit_neighbours(removed_, i, [&](std::size_t j) {
      num_removed += removed_[j];
      num_present += decided_[j] != 0 && removed_[j] == 0 ? 1 : 0;
    });
    if (num_removed >= kMinAroundGap && num_removed > num_present) gaps.push_back(i);
  };
  for (std::size_t i = 0; i < removed_.size(); ++i)
    if (removed_[i] != 0) visit_neighbours(removed_, i, test);
  for (const std::size_t i : gaps) removed_[i] = 1;
}

}  // namespace

DepthChanges find_depth_changes(const PreparedView& view, std::span<const PreparedView* const> earlier_views,
                                const DepthTestOptions& options, int num_threads) {
  DepthChanges changes;
  std::vector<PairEvidence> pairs(earlier_views.size());
  parallel_for(pairs.size(), num_threads,
               [&](std::size_t e) { pairs[e] = compare_both_ways(view, *earlier_views[e], options, num_threads); });
  changes.novel = find_novel(view, pairs, changes.num_explained);
  if (!pairs.empty()) drop_filled_holes(view, *earlier_views.back(), pairs.back(), options.sigmas, changes.novel);
  drop_weak_regions(measure_novel(pairs, changes.novel), options.min_region_px, changes.novel);

  RemovedSurface removed(view, earlier_views);
  std::vector<GonePixels> gone(pairs.size());
  for (std::size_t e = pairs.size(); e-- > 0;) {
    for (const Evidence evidence : pairs[e].of_earlier.evidence.data())
      ++changes.evidence_count[static_cast<std::size_t>(evidence)];
    gone[e] = removed.add(pairs[e], e);
  }
  drop_weak_regions(removed.contradictions(), options.min_region_px, removed.mask());
  for (const GonePixels& pixels : gone) {
    std::vector<int>& kept = changes.gone_pixels.emplace_back();
    for (std::size_t i = 0; i < pixels.in_view.size(); ++i)
      if (removed.mask()[static_cast<std::size_t>(pixels.in_view[i])] != 0) kept.push_back(pixels.in_earlier[i]);
  }
  removed.fill_gaps();
  changes.removed = std::move(removed.mask());
  return changes;
}

}  // namespace resight
