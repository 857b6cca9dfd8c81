// SPDX-License-Identifier: Apache-2.0
#include "resight/reconstruction/dynamic_scene.hpp"

#include <utility>

#include "resight/core/check.hpp"

namespace resight {

void DynamicSceneOptions::check() const {
  check_not_negative("DynamicSceneOptions.num_previous_views", num_previous_views);
  check_positive("DynamicSceneOptions.clear_tolerance_m", clear_tolerance_m);
  prepare.check();
  changes.check();
  integrate.check();
}

DynamicScene::DynamicScene(DynamicSceneOptions options) : options_(std::move(options)) { options_.check(); }

ChangeResult DynamicScene::add_view(PreparedView view) {
  ChangeResult changes;
  // Psi_{k-1} is what the last K views made of the scene; with K = 0 there is no past to compare with.
  if (options_.detect_changes && options_.num_previous_views > 0 && !window_.empty()) {
    std::vector<const PreparedView*> earlier_views;
    for (const View& earlier : window_) earlier_views.push_back(&earlier.cleared);
    changes = detect_changes(reconstruction_.cloud_in_world, view, options_.changes, earlier_views);
  }
  while (static_cast<int>(window_.size()) > options_.num_previous_views) window_.pop_front();
  if (!changes.removed_in_world.empty())
    for (View& earlier : window_)
      earlier.cleared = clear_removed_points(std::move(earlier.cleared), changes.removed_in_world,
                                             options_.clear_tolerance_m, options_.prepare);
  RgbdFrame raw = view.frame;
  window_.push_back({num_views_++, std::move(raw), std::move(view), changes.removed_in_world, changes.novel_in_world});

  std::vector<const PreparedView*> views;
  for (const View& v : window_) views.push_back(&v.cleared);
  reconstruction_ = integrate_views(views, options_.integrate);
  return changes;
}

}  // namespace resight
