// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "resight/core/result.hpp"
#include "resight/sensor/rgbd_frame.hpp"

namespace resight {

/// Where an object is in one view, by annotation or by simulation.
struct GroundTruthObject {
  std::string object;  ///< Name of the model.
  int bop_id = 0;      ///< obj_id; 0 = unknown.
  int instance = 0;    ///< Number among the objects of this name in this view.
  Rigid3 camera_from_object;
  double visible_share = 1.0;  ///< Of the object's silhouette (BOP visib_fract); NaN = unknown.
};

/// A recorded sequence of RGB-D views in time order, whatever its format on disk.
class Sequence {
 public:
  virtual ~Sequence() = default;
  [[nodiscard]] virtual std::string format() const = 0;  ///< "tuw", "bop", "tum", ..
  [[nodiscard]] virtual int num_views() const = 0;
  [[nodiscard]] virtual std::string view_name(int view) const = 0;  ///< File stem.
  [[nodiscard]] virtual int scene_id() const { return 0; }          ///< BOP scene; 0 elsewhere.
  [[nodiscard]] virtual int image_id(int view) const { return view; }
  /// The view, checked by check_frame().
  [[nodiscard]] virtual Result<RgbdFrame> read_view(int view) const = 0;
  /// False when the data hold no camera poses, so that world_from_camera is the identity for want of better.
  [[nodiscard]] virtual bool has_poses() const { return true; }
  [[nodiscard]] virtual bool has_ground_truth() const { return false; }
  /// Empty where there is none.
  [[nodiscard]] virtual Result<std::vector<GroundTruthObject>> read_ground_truth(int view) const;
};

}  // namespace resight
