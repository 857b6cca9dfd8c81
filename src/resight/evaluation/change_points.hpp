// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <deque>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "resight/evaluation/change_truth.hpp"
#include "resight/geometry/kd_tree.hpp"
#include "resight/sensor/rgbd_frame.hpp"

namespace resight {

/// Points of changes, counted; sums of views add up.
struct ChangePointScore {
  long reported = 0;  ///< Points that the change detection names.
  long right = 0;     ///< Of them, those on the surface of an object that has left (removed) or come (novel).
  long expected = 0;  ///< Points of such surfaces that the views prove to have left or come.
  long found = 0;     ///< Of them, those with a reported point near by.

  [[nodiscard]] double precision() const;  ///< NaN where nothing was reported.
  [[nodiscard]] double recall() const;     ///< NaN where nothing was to be found.
  ChangePointScore& operator+=(const ChangePointScore& other);
  friend bool operator==(const ChangePointScore&, const ChangePointScore&) = default;
};

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

/// Scores the change detection against what really happened, view by view (in order).
///
/// Expected are, once per change and at the first view that proves it: of a thing that has left, its surface points
/// that one of the last `num_previous_views` views has measured and this view sees through; of a thing that has come,
/// those that this view measures and one of those views has seen through. What no view has proved is not expected.
/// Removed points are right on any place left so far, novel points on any place taken so far: N of Eq. (2) also holds
/// surfaces that are seen for the first time without having changed, and its precision is low for that reason.
class ChangePointScorer {
 public:
  /// `library` and `truth` must outlive the scorer; truth.changes must be there. Objects without a surface in either
  /// are not expected.
  ChangePointScorer(const ModelLibrary& library, const SequenceTruth& truth, int num_previous_views,
                    const ScoreChangePointsOptions& options = {});
  ~ChangePointScorer();

  /// The reported points in the world frame.
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
  std::deque<RgbdFrame> window_;  // views before the current one, without their colours
  int view_ = 0;
};

}  // namespace resight
