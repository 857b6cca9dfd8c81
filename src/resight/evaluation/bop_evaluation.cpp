// SPDX-License-Identifier: Apache-2.0
#include "resight/evaluation/bop_evaluation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>

#include "resight/evaluation/change_truth.hpp"
#include "resight/geometry/symmetry.hpp"
#include "resight/io/model_source.hpp"

namespace resight {
namespace {

// Quadratic, but over extreme vertices in sampled directions only; accurate to about 1 %.
double diameter_of(const TriangleMesh& mesh) {
  constexpr double kStep_rad = std::numbers::pi / 32;
  std::vector<Eigen::Vector3f> extremes;
  for (int i = 0; i < 64; ++i)
    for (int k = 0; k < 32; ++k) {
      const double azimuth = i * kStep_rad;
      const double elevation = (k + 0.5) * kStep_rad - std::numbers::pi / 2;
      const Eigen::Vector3f direction = Eigen::Vector3d(std::cos(elevation) * std::cos(azimuth),
                                                        std::cos(elevation) * std::sin(azimuth), std::sin(elevation))
                                            .cast<float>();
      const auto farthest =
          std::ranges::max_element(mesh.vertices, {}, [&](const auto& v) { return v.dot(direction); });
      extremes.push_back(*farthest);
    }
  double diameter = 0;
  for (const auto& a : extremes)
    for (const auto& b : extremes) diameter = std::max(diameter, static_cast<double>((a - b).norm()));
  return diameter;
}

// The benchmark turns about an axis in 315 steps, so that no point of the surface moves by more than 1 % of the
// diameter.
std::vector<Rigid3> bop_symmetries(const ObjectSymmetries& symmetries) {
  constexpr double kStep_rad = 2 * std::numbers::pi / 315;
  return enumerate_symmetries(symmetries, symmetries.continuous.size() == 1 ? kStep_rad : kSymmetryStep_rad);
}

std::vector<DetectedObject> detections_of(const EvaluatedRun& run, int view) {
  std::vector<DetectedObject> detections;
  if (view >= static_cast<int>(run.views.size())) return detections;
  for (const EvaluatedDetection& d : run.views[static_cast<std::size_t>(view)].detections)
    detections.push_back({d.object, d.camera_from_object, d.score});
  return detections;
}

}  // namespace

Result<std::map<std::string, BopObject>> read_bop_objects(const std::filesystem::path& path,
                                                          const ModelLibrary& library) {
  const auto locations = find_models({path});
  if (!locations) return locations.error();
  std::map<std::string, BopObject> objects;
  std::map<std::string, BopObject> by_id;
  for (const ModelLocation& location : *locations) {
    auto source = read_model(location);
    if (!source) return source.error();
    if (!source->mesh || source->mesh->vertices.empty()) continue;
    const double diameter_m = diameter_of(*source->mesh);
    BopObject object{std::move(*source->mesh), bop_symmetries(source->symmetries), diameter_m};
    const auto known = std::ranges::find(library.objects, source->bop_id, &ObjectModel::bop_id);
    if (source->bop_id > 0 && known != library.objects.end() && known->name != source->name)
      by_id[known->name] = object;
    objects[source->name] = std::move(object);
  }
  objects.merge(by_id);
  return objects;
}

Result<std::vector<BopConfiguration>> evaluate_bop(
    std::span<const EvaluatedRun> runs, const std::map<std::string, BopObject>& objects, const ModelLibrary& library,
    const std::function<Result<std::unique_ptr<Sequence>>(const std::string&)>& open) {
  std::vector<BopConfiguration> configurations;
  std::vector<BopRecallCounter> counters;
  const auto slot_of = [&](const EvaluatedRun& run) {
    const auto key = [](const auto& x) { return std::tie(x.preset, x.num_previous_views, x.is_clustered); };
    const auto known = std::ranges::find_if(configurations, [&](const auto& c) { return key(c) == key(run); });
    if (known != configurations.end()) return static_cast<std::size_t>(known - configurations.begin());
    configurations.push_back({run.preset, run.num_previous_views, run.is_clustered, {}});
    counters.emplace_back(objects);
    return counters.size() - 1;
  };
  // Groups runs by sequence, so that each view is read only once.
  std::map<std::string, std::vector<const EvaluatedRun*>> by_sequence;
  for (const EvaluatedRun& run : runs) {
    (void)slot_of(run);
    by_sequence[run.sequence].push_back(&run);
  }
  for (const auto& [name, of_sequence] : by_sequence) {
    const auto sequence = open(name);
    if (!sequence) return sequence.error();
    const auto truth = read_sequence_truth(**sequence, library);
    if (!truth) return truth.error();
    for (int v = 0; v < (*sequence)->num_views(); ++v) {
      const auto frame = (*sequence)->read_view(v);
      if (!frame) return frame.error();
      for (const EvaluatedRun* run : of_sequence)
        counters[slot_of(*run)].add_view(*frame, truth->views[static_cast<std::size_t>(v)].objects,
                                         detections_of(*run, v));
    }
  }
  for (std::size_t i = 0; i < counters.size(); ++i) configurations[i].recall = counters[i].average_recall();
  return configurations;
}

std::string format_bop_table(std::span<const BopConfiguration> configurations) {
  std::string text =
      "# BOP average recall\n\nLocalization task: targets are at least 10 % visible; thresholds as in the "
      "benchmark.\n\n"
      "| preset | K | AR | AR VSD | AR MSSD | AR MSPD | targets |\n|---|---|---|---|---|---|---|\n";
  const auto share = [](double recall) { return std::isnan(recall) ? "-" : fmt::format("{:.3f}", recall); };
  for (const BopConfiguration& c : configurations)
    text += fmt::format("| `{}`{} | {} | {} | {} | {} | {} | {} |\n", c.preset,
                        c.is_clustered ? "" : " without clustering", c.num_previous_views, share(c.recall.mean()),
                        share(c.recall.vsd), share(c.recall.mssd), share(c.recall.mspd), c.recall.num_targets);
  return text;
}

}  // namespace resight
