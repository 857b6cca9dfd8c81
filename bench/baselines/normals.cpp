// SPDX-License-Identifier: Apache-2.0
// Normals of a view.
#include <fmt/format.h>

#include <algorithm>
#include <numbers>

#include "contest.hpp"
#include "plain_points.hpp"
#include "stages.hpp"

namespace resight::bench {
namespace {

using Normals = std::vector<Eigen::Vector3f>;
using pcl_peers::IntegralImageMethod;
using pcl_peers::NeighborSearch;

constexpr float kRadius_m = 0.02F;
constexpr float kMaxDepthChange = 0.02F;  // Same value as ours.
constexpr float kWindow_px = 10.0F;       // Value of the PCL tutorial.

struct NormalsContest {
  const StageInput& input;
  std::vector<Eigen::Vector3f> pixels;
  std::vector<std::string> names;
  std::vector<std::function<double(Normals&)>> methods;
  std::vector<Normals> results;

  [[nodiscard]] pcl_peers::OrganizedPoints view() const {
    return {to_plain(pixels), input.view.cloud.width(), input.view.cloud.height()};
  }
};

void add_ours(NormalsContest& contest, int radius_px) {
  contest.names.push_back(fmt::format("resight, {0} x {0} px", 2 * radius_px + 1));
  contest.methods.emplace_back([&contest, radius_px](Normals& normals) {
    OrganizedCloud cloud = contest.input.view.cloud;
    const double cpu_s = cpu_time_s([&] { compute_normals(cloud, {.window_radius_px = radius_px}); });
    normals.clear();
    for (std::size_t i = 0; i < cloud.z.size(); ++i) normals.push_back(cloud.normal(i));
    return cpu_s;
  });
}

void add_radius(NormalsContest& contest, const std::string& name, NeighborSearch search) {
  contest.names.push_back(name);
  contest.methods.emplace_back([&contest, search](Normals& normals) {
    const auto result = pcl_peers::normals_by_radius(contest.view(), kRadius_m, search);
    normals = from_plain(result.value);
    return result.cpu_s;
  });
}

void add_integral_image(NormalsContest& contest, const std::string& name, IntegralImageMethod method) {
  contest.names.push_back(name);
  contest.methods.emplace_back([&contest, method](Normals& normals) {
    const auto result = pcl_peers::normals_by_integral_image(contest.view(), method, kMaxDepthChange, kWindow_px);
    normals = from_plain(result.value);
    return result.cpu_s;
  });
}

// Without ground truth, the normals within 2 cm serve as reference: the result with index `reference`.
Normals reference_normals(const NormalsContest& contest, std::size_t reference) {
  const auto truth = contest.input.truth.normals_in_camera.data();
  return truth.empty() ? contest.results[reference] : Normals(truth.begin(), truth.end());
}

std::string quantiles(std::vector<double> errors_deg) {
  if (errors_deg.empty()) return "none";
  std::sort(errors_deg.begin(), errors_deg.end());
  return fmt::format("{:.1f} / {:.1f}", errors_deg[errors_deg.size() / 2], errors_deg[errors_deg.size() * 9 / 10]);
}

std::string rate(const NormalsContest& contest, std::size_t method, const Normals& reference) {
  std::vector<double> all_deg, things_deg;
  std::size_t num_points = 0, num_normals = 0;
  for (std::size_t i = 0; i < contest.pixels.size(); ++i) {
    if (!contest.input.view.cloud.has_point(i)) continue;
    ++num_points;
    num_normals += contest.results[method][i].allFinite() ? 1 : 0;
    const bool all_have = std::ranges::all_of(contest.results, [i](const Normals& n) { return n[i].allFinite(); });
    if (!all_have || !reference[i].allFinite()) continue;
    const double cosine = std::clamp(static_cast<double>(contest.results[method][i].dot(reference[i])), -1.0, 1.0);
    all_deg.push_back(std::acos(cosine) * 180 / std::numbers::pi);
    if (!contest.input.truth.is_thing.empty() && contest.input.truth.is_thing[i] != 0)
      things_deg.push_back(all_deg.back());
  }
  const std::string things = things_deg.empty() ? "" : ", on things " + quantiles(things_deg);
  return fmt::format("off by {}{} deg; {:.1f} % of the points", quantiles(all_deg), things,
                     100.0 * static_cast<double>(num_normals) / static_cast<double>(num_points));
}

}  // namespace

void compare_normals(const StageInput& input) {
  NormalsContest contest{
      .input = input, .pixels = points_of_pixels(input.view.cloud), .names = {}, .methods = {}, .results = {}};
  add_ours(contest, input.config.prepare.normals.window_radius_px);
  add_ours(contest, 4);
  add_ours(contest, 8);
  const std::size_t reference = contest.methods.size();
  add_radius(contest, "PCL NormalEstimationOMP, 2 cm, k-d tree", NeighborSearch::kKdTree);
  add_radius(contest, "PCL NormalEstimationOMP, 2 cm, in the image", NeighborSearch::kOrganized);
  add_integral_image(contest, "PCL IntegralImage, covariance", IntegralImageMethod::kCovariance);
  add_integral_image(contest, "PCL IntegralImage, average gradient", IntegralImageMethod::kAverageGradient);
  contest.results.resize(contest.methods.size());
  std::vector<Contestant> contestants;
  for (std::size_t w = 0; w < contest.methods.size(); ++w)
    contestants.push_back(
        {contest.names[w], [&contest, w] { return contest.methods[w](contest.results[w]); },
         [&contest, w, reference] { return rate(contest, w, reference_normals(contest, reference)); }});
  compare("normals", contestants);
}

}  // namespace resight::bench
