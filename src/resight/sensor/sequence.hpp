// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "resight/core/result.hpp"
#include "resight/sensor/rgbd_frame.hpp"

namespace resight {

/// Pose of an object in one view, from annotation or simulation.
struct GroundTruthObject {
  std::string object;  ///< Name of the model.
  int bop_id = 0;      ///< obj_id of BOP; 0 if unknown.
  int instance = 0;    ///< Index among the objects of this name in this view.
  Rigid3 camera_from_object;
  double visible_share = 1.0;  ///< Visible share of the silhouette (visib_fract of BOP); NaN if unknown.
};

/// A recorded sequence of RGB-D views in time order, independent of its format on disk.
class Sequence {
 public:
  virtual ~Sequence() = default;
  [[nodiscard]] virtual std::string format() const = 0;  ///< "tuw", "bop", "tum", ...
  [[nodiscard]] virtual int num_views() const = 0;
  [[nodiscard]] virtual std::string view_name(int view) const = 0;  ///< File stem.
  [[nodiscard]] virtual int scene_id() const { return 0; }          ///< BOP scene; 0 for other formats.
  [[nodiscard]] virtual int image_id(int view) const { return view; }
  /// Reads a view and checks it by check_frame().
  [[nodiscard]] virtual Result<RgbdFrame> read_view(int view) const = 0;
  /// World from camera: the pose of read_view(), without reading its images where the format allows it.
  [[nodiscard]] virtual Result<Rigid3> read_pose(int view) const;
  /// False if the data contain no camera poses; world_from_camera is then the identity.
  [[nodiscard]] virtual bool has_poses() const { return true; }
  /// What was assumed or left out, one line each, for the user.
  [[nodiscard]] virtual std::vector<std::string> notes() const { return {}; }
  [[nodiscard]] virtual bool has_ground_truth() const { return false; }
  /// Returns an empty list if there is no ground truth.
  [[nodiscard]] virtual Result<std::vector<GroundTruthObject>> read_ground_truth(int view) const;
};

/// The names of all views, in order.
[[nodiscard]] std::vector<std::string> view_names(const Sequence& sequence);

}  // namespace resight
