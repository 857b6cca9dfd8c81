// SPDX-License-Identifier: Apache-2.0
#include "resight/shape_search/shape_search.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "resight/core/check.hpp"
#include "resight/core/parallel.hpp"
#include "resight/core/random.hpp"
#include "resight/geometry/kd_tree.hpp"
#include "resight/geometry/symmetry.hpp"
#include "resight/shape_search/dipole_table.hpp"

namespace resight {
namespace {

constexpr double kMinDistanceShare = 0.25;  // Of an object's diameter: shorter dipoles turn poses too freely...
constexpr double kMaxDistanceShare = 0.8;   // ...and longer ones are seldom seen whole.
constexpr double kSpacingShare = 0.05;
constexpr double kMinSpacing_m = 0.005;
constexpr double kSamePlace_m = 0.03;
constexpr int kMaxPerPlace = 2;
constexpr float kMinFacingDot = -0.3F;  // Normals that point apart more are not seen together.

struct Candidate {
  int object = -1;
  float score = 0;
  Rigid3f pose{Rigid3{}};
};

float coarse_score(const ProbeCounts& c) {
  return static_cast<float>(c.confirmed - c.off_color - c.through) /
         (static_cast<float>(c.confirmed + c.through) + 0.4F * static_cast<float>(c.hidden) + 3.0F);
}

float chroma_difference_sq(const LabColor& a, const LabColor& b) {
  return (a.a - b.a) * (a.a - b.a) + (a.b - b.b) * (a.b - b.b);
}

Rigid3 to_double(const Rigid3f& motion) {
  return {nearest_rotation(motion.rotation.cast<double>()), motion.translation.cast<double>()};
}

}  // namespace

struct ShapeSearch::Impl {
  Impl(const ModelLibrary& models, const ShapeSearchOptions& settings) : library(models), options(settings) {
    objects.resize(library.objects.size());
    parallel_for(objects.size(), options.num_threads, [&](std::size_t o) { objects[o] = prepare(library.objects[o]); });
    std::vector<DipoleTable::Samples> samples;
    for (std::size_t o = 0; o < objects.size(); ++o)
      samples.push_back({objects[o].points, objects[o].normals,
                         kMinDistanceShare * static_cast<double>(library.objects[o].diameter_m),
                         kMaxDistanceShare * static_cast<double>(library.objects[o].diameter_m)});
    table = DipoleTable(samples);
  }

  [[nodiscard]] ProbeModel prepare(const ObjectModel& model) const {
    const double spacing_m = std::max(kMinSpacing_m, kSpacingShare * static_cast<double>(model.diameter_m));
    PointCloud samples = sample_surface(model.surface, spacing_m, options.max_model_samples);
    ProbeModel result;
    if (samples.has_colors()) {
      result.linear_light = to_linear_light(samples.colors);
      result.lab = to_lab(result.linear_light);
    }
    result.points = std::move(samples.points);
    result.normals = std::move(samples.normals);
    result.center = model.center;
    return result;
  }

  [[nodiscard]] std::vector<ShapeCandidate> search(const PreparedView& view) const {
    const PointCloud scene = sample_scene(view, options.scene);
    if (!scene.has_normals() || table.size() == 0) return {};
    const PoseProbe probe(view, options.scene.max_depth_m, options.num_threads);
    const KdTree tree(scene.points);
    std::vector<int> seeds(scene.size());
    for (std::size_t i = 0; i < seeds.size(); ++i) seeds[i] = static_cast<int>(i);
    Rng(options.seed).shuffle(seeds);
    seeds.resize(std::min(seeds.size(), static_cast<std::size_t>(options.max_seeds)));
    std::vector<std::vector<Candidate>> found(seeds.size());
    parallel_for(seeds.size(), options.num_threads,
                 [&](std::size_t s) { found[s] = from_seed(seeds[s], scene, tree, probe); });
    std::vector<std::vector<Candidate>> of_object(objects.size());
    for (const auto& list : found)
      for (const Candidate& c : list) of_object[static_cast<std::size_t>(c.object)].push_back(c);
    std::vector<std::vector<ShapeCandidate>> judged(objects.size());
    parallel_for(objects.size(), options.num_threads, [&](std::size_t o) { judged[o] = judge(of_object[o], probe); });
    std::vector<ShapeCandidate> result;
    for (const auto& list : judged) result.insert(result.end(), list.begin(), list.end());
    return result;
  }

  // Dipoles from one scene point to others around it, and the poses they stand for that pass the coarse test.
  [[nodiscard]] std::vector<Candidate> from_seed(int seed, const PointCloud& scene, const KdTree& tree,
                                                 const PoseProbe& probe) const {
    Rng rng = Rng::stream(options.seed, static_cast<std::uint64_t>(seed));
    std::vector<Candidate> found;
    std::vector<PointNeighbor> neighbors;
    const Eigen::Vector3f& p = scene.points[static_cast<std::size_t>(seed)];
    double radius_m = table.max_distance_m();
    constexpr int kRings = 4;  // Half as wide each, so that small objects have their share.
    for (int ring = 0; ring < kRings; ++ring, radius_m /= 1.6) {
      tree.within(p, radius_m, neighbors);
      for (int i = 0; i < options.pairs_per_seed / kRings && !neighbors.empty(); ++i) {
        const int other = neighbors[rng.below(static_cast<std::uint32_t>(neighbors.size()))].index;
        if (other != seed) try_dipole(seed, other, scene, probe, rng, found);
      }
    }
    return found;
  }

  void try_dipole(int first, int second, const PointCloud& scene, const PoseProbe& probe, Rng& rng,
                  std::vector<Candidate>& found) const {
    const Dipole seen{scene.points[static_cast<std::size_t>(first)], scene.normals[static_cast<std::size_t>(first)],
                      scene.points[static_cast<std::size_t>(second)], scene.normals[static_cast<std::size_t>(second)]};
    const int first_pixel = probe.pixel_of(seen.p1);
    const int second_pixel = probe.pixel_of(seen.p2);
    if (first_pixel < 0 || second_pixel < 0) return;
    const float max_chroma_sq = static_cast<float>(options.coarse.max_chroma_difference * options.coarse.max_chroma_difference);
    const auto bin = dipole_bin(seen, table.max_distance_m());
    if (!bin) return;
    const std::span<const DipoleEntry> entries = table.find(*bin);
    for (std::size_t begin = 0; begin < entries.size();) {
      std::size_t end = begin;
      while (end < entries.size() && entries[end].object == entries[begin].object) ++end;
      const auto count = static_cast<std::uint32_t>(end - begin);
      const auto tries = std::min(count, static_cast<std::uint32_t>(options.max_entries));
      for (std::uint32_t t = 0; t < tries; ++t) {
        const DipoleEntry entry = entries[begin + (tries == count ? t : rng.below(count))];
        const ProbeModel& model = objects[entry.object];
        if (!model.lab.empty() && (chroma_difference_sq(model.lab[entry.first], probe.lab(first_pixel)) > max_chroma_sq ||
                                   chroma_difference_sq(model.lab[entry.second], probe.lab(second_pixel)) > max_chroma_sq))
          continue;
        const auto pose = align({model.points[entry.first], model.normals[entry.first], model.points[entry.second],
                                 model.normals[entry.second]},
                                seen);
        if (!pose) continue;
        const ProbeCounts counts =
            probe.count(model, *pose, options.coarse_samples, options.max_coarse_wrong, options.coarse);
        if (counts.through + counts.off_color > options.max_coarse_wrong + counts.facing / 4) continue;
        const float score = coarse_score(counts);
        if (score >= static_cast<float>(options.min_coarse_score)) found.push_back({entry.object, score, *pose});
      }
      begin = end;
    }
  }

  [[nodiscard]] bool is_same(int object, const Rigid3& a, const Rigid3& b, bool symmetric) const {
    const ObjectModel& model = library.objects[static_cast<std::size_t>(object)];
    const Eigen::Vector3d center = model.center.cast<double>();
    if ((a * center - b * center).norm() >= options.same_place_m) return false;
    const Rigid3 nearest = symmetric ? nearest_symmetric_pose(a, b, model.symmetries) : a;
    return rotation_angle_rad(nearest.rotation, b.rotation) < options.same_rotation_rad;
  }

  [[nodiscard]] std::vector<ShapeCandidate> judge(std::vector<Candidate>& candidates, const PoseProbe& probe) const {
    std::stable_sort(candidates.begin(), candidates.end(),
                     [](const Candidate& a, const Candidate& b) { return a.score > b.score; });
    std::vector<Rigid3> tried;
    std::vector<ShapeCandidate> judged;
    for (const Candidate& c : candidates) {
      if (static_cast<int>(tried.size()) == options.max_refined) break;
      const Rigid3 start = to_double(c.pose);
      if (std::any_of(tried.begin(), tried.end(),
                      [&](const Rigid3& other) { return is_same(c.object, start, other, true); }))
        continue;
      tried.push_back(start);
      const ProbeModel& model = objects[static_cast<std::size_t>(c.object)];
      const Rigid3 pose = probe.refine(model, start, options.refine_iterations, options.refine_distance_m);
      const PoseProbe::Fit fit = probe.judge(model, Rigid3f(pose), options.tolerance_m, options.color_sigma_l,
                                             options.color_sigma_ab, options.light);
      if (fit.num_explained < 0.1 * static_cast<double>(model.points.size()) || fit.explained_share < options.min_explained_share || fit.visible_share < options.min_visible_share ||
          fit.pattern_similarity < options.min_pattern_similarity)
        continue;
      judged.push_back({c.object, pose,
                        fit.explained_share * std::sqrt(fit.visible_share * std::max(0.0, fit.pattern_similarity)),
                        fit.num_explained});
    }
    std::stable_sort(judged.begin(), judged.end(),
                     [](const ShapeCandidate& a, const ShapeCandidate& b) { return a.quality > b.quality; });
    std::vector<ShapeCandidate> kept;
    for (const ShapeCandidate& c : judged) {
      if (static_cast<int>(kept.size()) == options.max_hypotheses) break;
      const Eigen::Vector3d center = library.objects[static_cast<std::size_t>(c.object)].center.cast<double>();
      int num_here = 0;
      bool repeated = false;
      for (const ShapeCandidate& other : kept) {
        repeated = repeated || is_same(c.object, c.camera_from_object, other.camera_from_object, true);
        num_here += (c.camera_from_object * center - other.camera_from_object * center).norm() < kSamePlace_m ? 1 : 0;
      }
      if (!repeated && num_here < kMaxPerPlace) kept.push_back(c);
    }
    return kept;
  }

  const ModelLibrary& library;
  ShapeSearchOptions options;
  std::vector<ProbeModel> objects;
  DipoleTable table;
};

void ShapeSearchOptions::check() const {
  scene.check();
  check_positive("ShapeSearchOptions.max_model_samples", max_model_samples);
  check_positive("ShapeSearchOptions.max_seeds", max_seeds);
  check_positive("ShapeSearchOptions.num_threads", num_threads);
}

ShapeSearch::ShapeSearch(const ModelLibrary& library, const ShapeSearchOptions& options)
    : impl_(std::make_unique<Impl>(library, options)) {}
ShapeSearch::~ShapeSearch() = default;
ShapeSearch::ShapeSearch(ShapeSearch&&) noexcept = default;

ShapeSearch::Trial ShapeSearch::try_pose(const PreparedView& view, int object, const Rigid3& camera_from_object) const {
  const ShapeSearchOptions& o = impl_->options;
  const PoseProbe probe(view, o.scene.max_depth_m, o.num_threads);
  const ProbeModel& model = impl_->objects[static_cast<std::size_t>(object)];
  const Rigid3 pose = probe.refine(model, camera_from_object, o.refine_iterations, o.refine_distance_m);
  return {probe.count(model, Rigid3f(camera_from_object), o.coarse_samples, 1000, o.coarse),
          probe.judge(model, Rigid3f(pose), o.tolerance_m, o.color_sigma_l, o.color_sigma_ab, o.light)};
}

std::vector<ShapeCandidate> ShapeSearch::search(const PreparedView& view) const { return impl_->search(view); }

}  // namespace resight
