// SPDX-License-Identifier: Apache-2.0
#include "resight/evaluation/bop_average_recall.hpp"

#include <algorithm>
#include <functional>
#include <limits>
#include <numeric>

namespace resight {
namespace {

constexpr double kMinVisibleShare = 0.1;
constexpr int kNumThresholds = 10;
constexpr double kReferenceWidth_px = 640;

double threshold(int i) { return 0.05 * (i + 1); }

// Errors of each estimate (rows, by descending score) against each target (columns).
using Errors = std::vector<std::vector<double>>;

int count_hits(const Errors& errors, std::size_t num_targets, double below) {
  std::vector<char> taken(num_targets, 0);
  int hits = 0;
  for (const auto& of_estimate : errors) {
    int best = -1;
    double least = below;
    for (std::size_t t = 0; t < num_targets; ++t) {
      if (taken[t] || !(of_estimate[t] < least)) continue;
      least = of_estimate[t];
      best = static_cast<int>(t);
    }
    if (best < 0) continue;
    taken[static_cast<std::size_t>(best)] = 1;
    ++hits;
  }
  return hits;
}

double mean_share(const std::vector<int>& hits, int num_targets) {
  if (num_targets == 0) return std::numeric_limits<double>::quiet_NaN();
  return std::accumulate(hits.begin(), hits.end(), 0.0) / (static_cast<double>(hits.size()) * num_targets);
}

}  // namespace

BopRecallCounter::BopRecallCounter(const std::map<std::string, BopObject>& objects, const VsdOptions& vsd)
    : objects_(objects),
      vsd_options_(vsd),
      vsd_hits_(kNumThresholds * vsd.misalignment_shares.size(), 0),
      mssd_hits_(kNumThresholds, 0),
      mspd_hits_(kNumThresholds, 0) {
  vsd_options_.check();
}

void BopRecallCounter::add_view(const RgbdFrame& frame, std::span<const GroundTruthObject> truth,
                                std::span<const DetectedObject> estimates) {
  for (const auto& [name, object] : objects_) {
    std::vector<Rigid3> targets;
    for (const GroundTruthObject& t : truth)
      if (t.object == name && !(t.visible_share < kMinVisibleShare)) targets.push_back(t.camera_from_object);
    if (targets.empty()) continue;
    std::vector<const DetectedObject*> best;
    for (const DetectedObject& e : estimates)
      if (e.object == name) best.push_back(&e);
    std::ranges::stable_sort(best, std::greater{}, &DetectedObject::score);
    if (best.size() > targets.size()) best.resize(targets.size());
    std::vector<Rigid3> poses;
    for (const DetectedObject* e : best) poses.push_back(e->camera_from_object);
    add_object(frame, object, targets, poses);
  }
}

void BopRecallCounter::add_object(const RgbdFrame& frame, const BopObject& object, const std::vector<Rigid3>& targets,
                                  const std::vector<Rigid3>& estimates) {
  const std::size_t num_taus = vsd_options_.misalignment_shares.size();
  num_targets_ += static_cast<int>(targets.size());
  if (estimates.empty()) return;
  const std::vector<double> no_errors(targets.size());
  Errors mssd(estimates.size(), no_errors);
  Errors mspd(estimates.size(), no_errors);
  std::vector<Errors> vsd(num_taus, Errors(estimates.size(), no_errors));
  std::vector<Image<float>> target_depths_m;
  for (const Rigid3& target : targets)
    target_depths_m.push_back(render_object_depth(object.mesh, frame.camera, target));
  for (std::size_t e = 0; e < estimates.size(); ++e) {
    const Image<float> depth_m = render_object_depth(object.mesh, frame.camera, estimates[e]);
    for (std::size_t t = 0; t < targets.size(); ++t) {
      mssd[e][t] = mssd_m(estimates[e], targets[t], object.mesh.vertices, object.symmetries) / object.diameter_m;
      mspd[e][t] = mspd_px(estimates[e], targets[t], object.mesh.vertices, object.symmetries, frame.camera);
      const std::vector<double> errors =
          vsd_errors(depth_m, target_depths_m[t], frame.depth_m, frame.camera, object.diameter_m, vsd_options_);
      for (std::size_t tau = 0; tau < num_taus; ++tau) vsd[tau][e][t] = errors[tau];
    }
  }
  for (int i = 0; i < kNumThresholds; ++i) {
    const auto slot = static_cast<std::size_t>(i);
    mssd_hits_[slot] += count_hits(mssd, targets.size(), threshold(i));
    mspd_hits_[slot] += count_hits(mspd, targets.size(), 100 * threshold(i) * frame.camera.width / kReferenceWidth_px);
    for (std::size_t tau = 0; tau < num_taus; ++tau)
      vsd_hits_[tau * kNumThresholds + slot] += count_hits(vsd[tau], targets.size(), threshold(i));
  }
}

BopAverageRecall BopRecallCounter::average_recall() const {
  return {mean_share(vsd_hits_, num_targets_), mean_share(mssd_hits_, num_targets_),
          mean_share(mspd_hits_, num_targets_), num_targets_};
}

}  // namespace resight
