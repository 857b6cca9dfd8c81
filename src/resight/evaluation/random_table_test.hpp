// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "resight/core/random.hpp"
#include "resight/sensor/testing/ball_scene.hpp"
#include "resight/simulation/scene_script.hpp"

namespace resight {

/// Things on a table that come, go and move while a camera with a narrow image looks to and fro.
class RandomTable {
 public:
  static constexpr int kNumViews = 14;
  explicit RandomTable(std::uint64_t seed) : rng_(seed) {
    script_.name = "table";
    script_.camera = {96, 72, 105, 105, 47.5, 35.5};
    script_.furniture.push_back({"table", "table", {1.6, 0.9, 0.7}, {}});
    for (const char* model : {"mug", "plain_can", "plain_can", "tea_box", "soup_pea"}) {
      const std::string key = std::string(model) + std::to_string(script_.objects.size());
      script_.objects.push_back({key, model, {}, true, std::nullopt});
      if (rng_.below(5) > 0) script_.objects.back().start = place(key);
    }
    for (int v = 0; v < kNumViews; ++v) {
      if (v > 0) add_changes(v);
      const double x = 0.5 * std::sin(1.1 * v);
      script_.world_from_camera.push_back(test::look_at_point({0.6 * x, -1.0, 1.3}, {x, 0, 0.7}));
    }
  }
  [[nodiscard]] const SceneScript& script() const { return script_; }

 private:
  Placement place(const std::string& key) {
    Eigen::Vector2d at;
    do at = {rng_.uniform(-0.7, 0.7), rng_.uniform(-0.35, 0.35)};
    while (std::ranges::any_of(places_, [&](const auto& p) { return (p.second - at).norm() < 0.2; }));
    places_[key] = at;
    Placement placement;
    placement.support = "table";
    placement.x_m = at.x();
    placement.y_m = at.y();
    return placement;
  }
  // A removed object does not return: chains cannot tell this from a move out of the image.
  void add_changes(int view) {
    const std::string key = script_.objects[rng_.below(static_cast<std::uint32_t>(script_.objects.size()))].key;
    const bool is_there = places_.contains(key);
    const bool was_there = std::ranges::find(removed_, key) != removed_.end();
    if (was_there) return;
    if (!is_there) return script_.changes.push_back({view, ChangeKind::kAdded, key, place(key)});
    if (rng_.below(4) > 0) return script_.changes.push_back({view, ChangeKind::kMoved, key, place(key)});
    script_.changes.push_back({view, ChangeKind::kRemoved, key, {}});
    places_.erase(key);
    removed_.push_back(key);
  }
  Rng rng_;
  SceneScript script_;
  std::map<std::string, Eigen::Vector2d> places_;
  std::vector<std::string> removed_;
};

}  // namespace resight
