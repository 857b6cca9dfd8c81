// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <deque>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "resight/evaluation/change_truth.hpp"
#include "resight/sensor/rgbd_frame.hpp"

namespace resight {

/// Counts of changed points; counts of views add up.
struct ChangePointScore {
  long reported = 0;  ///< Points reported by the change detection.
  long right = 0;     ///< Reported points on the surface of an object that has left (removed) or arrived (novel).
  long expected = 0;  ///< Points of such surfaces whose change the views prove.
  long found = 0;     ///< Expected points with a reported point nearby.

  [[nodiscard]] double precision() const;  ///< NaN if no point was reported.
  [[nodiscard]] double recall() const;     ///< NaN if no point was expected.
  ChangePointScore& operator+=(const ChangePointScore& other);
  friend bool operator==(const ChangePointScore&, const ChangePointScore&) = default;
};

/// Scores of the removed and of the novel points.
struct ChangePointScores {
  ChangePointScore removed;
  ChangePointScore novel;
};

struct ScoreChangePointsOptions {
  double near_m = 0.02;          ///< A reported point this near to a surface lies on it (epsilon of Eq. 2).
  double consistent_m = 0.01;    ///< A surface point this near to the measured depth has been measured.
  double seen_through_m = 0.04;  ///< A view measures so much behind a point: it is not there. More than epsilon, which
                                 ///< hides the zone of contact with what is behind.
  double sample_m = 0.01;        ///< Spacing of the expected points.
  int min_points = 50;           ///< Fewer expected points of one change do not count: a sliver proves nothing.
  void check() const;
};

/// Scores the change detection against the true changes, view by view (in order).
///
/// Each change is expected once, at the first view that proves it. For an object that has left, the expected points are
/// those of its surface that one of the last `num_previous_views` views measured and this view sees through. For an
/// object that has arrived, they are those that this view measures and one of those views saw through. Unproven changes
/// are not expected. Removed points are right at any place left so far, novel points at any place taken so far. The
/// precision of novel points is low, because N of Eq. (2) also contains unchanged surfaces that are observed for the
/// first time.
class ChangePointScorer {
 public:
  /// `library` and `truth` must outlive the scorer. Throws std::invalid_argument without truth.changes. Objects without
  /// a surface in either are not expected.
  ChangePointScorer(const ModelLibrary& library, const SequenceTruth& truth, int num_previous_views,
                    const ScoreChangePointsOptions& options = {});
  ~ChangePointScorer();

  /// The reported points are in the world frame.
  [[nodiscard]] ChangePointScores add_view(const RgbdFrame& frame, const PointCloud& removed_in_world,
                                           const PointCloud& novel_in_world);

 private:
  struct Surface;
  struct Place;
  void add_place(const TrueChange& change, const Rigid3& world_from_object, const PointCloud& surface, bool has_left);
  void score_reported(const PointCloud& reported_in_world, bool has_left, ChangePointScore& score) const;
  void score_expected(const RgbdFrame& frame, const PointCloud& reported_in_world, bool has_left,
                      ChangePointScore& score);

  int num_previous_views_;
  ScoreChangePointsOptions options_;
  std::map<std::string, std::unique_ptr<Surface>> surfaces_;
  std::vector<Place> places_;
  std::deque<RgbdFrame> window_;  // Views before the current one, without colours.
  int view_ = 0;
};

}  // namespace resight
