// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "resight/geometry/triangle_mesh.hpp"
#include "resight/io/sequence.hpp"
#include "resight/rendering/sensor_model.hpp"
#include "resight/sensor/rgbd_frame.hpp"
#include "resight/simulation/procedural_objects.hpp"

namespace resight {

/// How an object is recorded for modelling.
enum class RecordingKind : std::uint8_t {
  kTurntable,  ///< The object turns on a disc in front of a static camera and background.
  kWalk,       ///< The object is static, and the camera is carried around it.
};

struct RecordingOptions {
  RecordingKind kind = RecordingKind::kTurntable;
  double step_deg = 10;         ///< Between neighbouring views; once around.
  double elevation_deg = 35;    ///< Of the camera above the object's middle.
  double distance_m = 0;        ///< Camera to object; 0 = the object fills about half of the image height, >= 0.6 m.
  bool upside_down = false;     ///< The other side: turned over about a horizontal axis, it stands on its top.
  double disc_height_m = 0.02;  ///< Of the turntable above the table.
  double off_axis_m = 0.01;     ///< The object's middle from the axis: nobody centres it exactly.
  SensorOptions sensor{.min_depth_m = 0.4};
  Lighting lighting;
  SurfaceMaterial material = {};  ///< Of the object.
  std::uint64_t seed = 1;         ///< Of room, sensor noise, and how the object was put down.
  int num_threads = 1;            ///< Same bytes for any value >= 1.
  void check() const;
};

/// A view of a recording with its ground truth.
struct RecordedView {
  RgbdFrame frame;  ///< Its pose is the identity, because the sensor does not know its pose.
  Rigid3 camera_from_object;
  Image<std::uint8_t> mask;  ///< Non-zero where the centre of the pixel shows the object.
};

/// Records an object (metres, +z up) on a table, in a room with textured walls and other objects on the table. Things
/// that do not turn with the object have more texture than the object, and the turntable has almost none.
[[nodiscard]] std::vector<RecordedView> simulate_recording(const TriangleMesh& mesh,
                                                           const RecordingOptions& options = {});

/// Records both sides of an object (the second with `upside_down`, placed anew) as two sequences. Writes
/// `directory`/side_1/ and side_2/, each with camera_from_object as ground truth in its format, and truth/<name>.ply,
/// the mesh in the object frame. The folder must be missing or empty, and appears when it is complete. `progress` is
/// called after each side.
[[nodiscard]] Result<void> write_recordings(const ProceduralObject& object, const std::filesystem::path& directory,
                                            DatasetFormat format, RecordingOptions options = {},
                                            const std::function<void(const std::string&)>& progress = {});

}  // namespace resight
