// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <deque>
#include <optional>

#include "resight/evidence/object_presence.hpp"

namespace resight {

struct DepthHistoryOptions {
  int max_views = 64;  ///< Older ones are forgotten.
  int step_px = 4;     ///< Of a view, each pixel of each such row and column is kept: 77 KB of 640 x 480.
  void check() const;
};

/// What the last views have measured, thinned: enough to tell whether a place was free, for longer than whole views
/// can be kept.
class DepthHistory {
 public:
  explicit DepthHistory(DepthHistoryOptions options = {});

  void add(int view, const RgbdFrame& frame);
  /// The last view that saw free space where the object would be; its number as it was added.
  [[nodiscard]] std::optional<int> last_seen_free(const PointCloud& surface_in_object, const Rigid3& world_from_object,
                                                  const PresenceOptions& presence = {}) const;

  /// Whether that view, or an older one, is still remembered.
  [[nodiscard]] bool reaches_back_to(int view) const { return !views_.empty() && views_.front().number <= view; }

 private:
  struct View {
    int number = 0;
    RgbdFrame frame;  // without colours
  };
  DepthHistoryOptions options_;
  std::deque<View> views_;
};

}  // namespace resight
