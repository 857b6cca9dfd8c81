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

/// What BOP's errors need of an object, metres.
struct BopObject {
  TriangleMesh mesh;
  std::vector<Rigid3> symmetries;  ///< enumerate_symmetries().
  double diameter_m = 0;           ///< Largest distance between two vertices (models_info.json).
};

/// Average recalls of the task "6D localization" of the BOP benchmark; NaN without targets.
struct BopAverageRecall {
  double vsd = 0;   ///< Over tau and theta of 5, 10, .., 50 %.
  double mssd = 0;  ///< Over 5, 10, .., 50 % of the diameter.
  double mspd = 0;  ///< Over 5 r, 10 r, .., 50 r px; r = image width / 640.
  int num_targets = 0;
  [[nodiscard]] double mean() const { return (vsd + mssd + mspd) / 3; }  ///< AR, the benchmark's rank.
};

/// Counts the recalls view by view.
///
/// As the benchmark does: a target is an instance that is at least 10 % visible (unknown counts as visible); of the n
/// targets of an object in a view, the n estimates of highest score are looked at, and each takes, from the highest on,
/// the nearest target below the threshold that is still free. Targets without an estimate are missed. A view without
/// estimates must be added, too.
class BopRecallCounter {
 public:
  /// `objects` by name; must outlive the counter. Truth of other objects is left out.
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
  std::vector<int> vsd_hits_;  // per tau and theta
  std::vector<int> mssd_hits_;
  std::vector<int> mspd_hits_;
};

}  // namespace resight
