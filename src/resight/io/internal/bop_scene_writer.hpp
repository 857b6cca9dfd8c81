// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "resight/io/internal/files.hpp"
#include "resight/sensor/sequence.hpp"

namespace resight::io {

/// Size in metres of the unit that fits all depths of an image: 0.1 mm up to 6.5 m, 1 mm beyond.
[[nodiscard]] double choose_depth_unit_m(const Image<float>& depth_m);

/// Fills a BOP scene directory view by view. Images are written at once, JSON files by finish().
class BopSceneWriter {
 public:
  /// `ids` contains the obj_ids of known names. A new name gets the next free id.
  BopSceneWriter(fs::path directory, std::map<std::string, int> ids)
      : directory_(std::move(directory)), ids_(std::move(ids)) {}
  /// Returns the image id: the number at the end of the frame's name if these numbers ascend, else the next number.
  Result<int> write_view(const RgbdFrame& frame, const std::vector<GroundTruthObject>& ground_truth,
                         bool with_camera_pose);
  /// Writes the mask of the `index`-th object of the view.
  [[nodiscard]] Result<void> write_object_mask(int image_id, int index, const Image<std::uint8_t>& mask) const;
  /// Writes the JSON files.
  [[nodiscard]] Result<void> finish(bool with_ground_truth = true) const;
  [[nodiscard]] int num_views() const { return num_views_; }

 private:
  Result<int> find_id(const GroundTruthObject& object);
  fs::path directory_;
  std::map<std::string, int> ids_;
  nlohmann::json cameras_ = nlohmann::json::object();
  nlohmann::json truth_ = nlohmann::json::object();
  nlohmann::json info_ = nlohmann::json::object();
  bool knows_visibility_ = false;  ///< Of some object. Otherwise there is no scene_gt_info.json.
  int last_image_id_ = -1;
  int num_views_ = 0;
};

}  // namespace resight::io
