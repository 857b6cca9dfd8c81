// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <deque>
#include <optional>

#include "resight/core/options.hpp"
#include "resight/evidence/object_presence.hpp"
#include "resight/sensor/rgbd_frame.hpp"

namespace resight {

struct DepthHistoryOptions {
  int max_views = 64;
  void check() const { check_options("DepthHistoryOptions", *this); }
};

inline void declare(OptionVisitor& v, DepthHistoryOptions& o) {
  v.field("max_views", o.max_views, at_least(0), "Older views are forgotten.");
}

/// The downsampled depth of the last views: enough to decide whether a place was free, for longer than whole views can
/// be kept.
class DepthHistory {
 public:
  /// Every `step_px`-th row and column of a view is kept: with 4, 77 KB of 640 x 480.
  explicit DepthHistory(DepthHistoryOptions options = {}, int step_px = 4);

  void add(int view, const RgbdFrame& frame);
  /// Number of the last view that saw free space where the object would be.
  [[nodiscard]] std::optional<int> last_seen_free(const PointCloud& surface_in_object, const Rigid3& world_from_object,
                                                  const PresenceOptions& presence = {}) const;

  /// Whether `view`, or an older one, is still remembered.
  [[nodiscard]] bool reaches_back_to(int view) const { return !views_.empty() && views_.front().number <= view; }

 private:
  struct View {
    int number = 0;
    RgbdFrame frame;  // without colours
  };
  DepthHistoryOptions options_;
  int step_px_;
  std::deque<View> views_;
};

}  // namespace resight
