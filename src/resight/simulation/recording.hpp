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

/// How an object is recorded to make a model of it.
enum class RecordingKind : std::uint8_t {
  kTurntable,  ///< It turns on a disc before a camera that stands still, and so does all behind it.
  kWalk,       ///< It stands still, and the camera is carried around it.
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
  std::uint64_t seed = 1;  ///< Of room, sensor noise, and how the object was put down.
  int num_threads = 1;     ///< Same bytes for any value >= 1.
  void check() const;
};

/// A view of a recording and the truth about it.
struct RecordedView {
  RgbdFrame frame;  ///< Its pose is the identity: nobody has told the sensor where it is.
  Rigid3 camera_from_object;
  Image<std::uint8_t> mask;  ///< Non-zero = the object is what the pixel's centre sees.
};

/// Records an object (metres, +z up) on a table in a room with printed walls and things on the table: what does not
/// turn with the object has more print than the object. The turntable itself has next to none.
[[nodiscard]] std::vector<RecordedView> simulate_recording(const TriangleMesh& mesh,
                                                           const RecordingOptions& options = {});

/// Records both sides of an object (the second with `upside_down`, put down anew) as two sequences and writes
/// `directory`/side_1/ and side_2/, each with camera_from_object as the ground truth of its format, and
/// truth/<name>.ply, the mesh in the object frame. The folder must not exist or be empty; it appears when it is
/// complete. `progress` is called after each side.
[[nodiscard]] Result<void> write_recordings(const ProceduralObject& object, const std::filesystem::path& directory,
                                            DatasetFormat format, RecordingOptions options = {},
                                            const std::function<void(const std::string&)>& progress = {});

}  // namespace resight
