// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <map>
#include <span>
#include <string>
#include <vector>

#include "resight/evaluation/bop_errors.hpp"
#include "resight/evaluation/match_detections.hpp"
#include "resight/sensor/rgbd_frame.hpp"

namespace resight {

/// What the BOP errors need of an object. Metres.
struct BopObject {
  TriangleMesh mesh;
  std::vector<Rigid3> symmetries;  ///< From enumerate_symmetries().
  double diameter_m = 0;           ///< Largest distance between two vertices.
};

/// Average recalls of the BOP task "6D localization"; NaN without targets.
struct BopAverageRecall {
  double vsd = 0;   ///< Over tau and theta of 5, 10, ..., 50 %.
  double mssd = 0;  ///< Over thresholds of 5, 10, ..., 50 % of the diameter.
  double mspd = 0;  ///< Over thresholds of 5 r, 10 r, ..., 50 r px, with r = image width / 640.
  int num_targets = 0;
  [[nodiscard]] double mean() const { return (vsd + mssd + mspd) / 3; }  ///< AR, by which the benchmark ranks.
};

/// Counts recalls view by view, following the benchmark.
///
/// A target is an instance with a visible share of at least 10 % (unknown counts as visible). Of n targets of an object
/// in a view, the n estimates with the highest scores are evaluated. In order of descending score, each takes the
/// nearest remaining target below the threshold. Targets without an estimate are missed. Views without estimates must
/// be added too.
class BopRecallCounter {
 public:
  /// `objects` are keyed by name and must outlive the counter. Ground truth of other objects is ignored.
  explicit BopRecallCounter(const std::map<std::string, BopObject>& objects, const VsdOptions& vsd = {});

  void add_view(const RgbdFrame& frame, std::span<const GroundTruthObject> truth,
                std::span<const DetectedObject> estimates);
  [[nodiscard]] BopAverageRecall average_recall() const;

 private:
  void add_object(const RgbdFrame& frame, const BopObject& object, const std::vector<Rigid3>& targets,
                  const std::vector<Rigid3>& estimates);

  const std::map<std::string, BopObject>& objects_;
  VsdOptions vsd_options_;
  int num_targets_ = 0;
  std::vector<int> vsd_hits_;  // Per tau and theta.
  std::vector<int> mssd_hits_;
  std::vector<int> mspd_hits_;
};

}  // namespace resight
