// SPDX-License-Identifier: Apache-2.0
#include "resight/io/sequence.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "resight/core/unfinished_folder.hpp"
#include "resight/io/internal/adjusted_sequence.hpp"
#include "resight/io/internal/files.hpp"
#include "resight/io/internal/listed_sequence.hpp"
#include "resight/io/internal/sequences.hpp"
#include "resight/io/tuw_models.hpp"
#include "resight/recordings/recording.hpp"
#include "resight/sensor/disparity_error.hpp"

namespace resight {
namespace {

using io::fs::path;

struct FormatEntry {
  bool (*matches)(const path& directory);
  io::SequenceResult (*open)(const path& directory, const OpenSequenceOptions& options);
};

/// For formats that say everything themselves.
template <io::SequenceResult (*kOpen)(const path&)>
io::SequenceResult open_without_options(const path& directory, const OpenSequenceOptions& /*options*/) {
  return kOpen(directory);
}

/// In the order in which they are tried, most specific first.
constexpr std::array<FormatEntry, 8> kFormats = {
    {{io::is_bop_scene, open_without_options<io::open_bop_scene>},
     {io::is_tum_sequence, io::open_tum_sequence},
     {io::is_npy_sequence, io::open_npy_sequence},
     {io::is_fixed_camera_sequence, io::open_fixed_camera_sequence},
     {io::is_camera_info_sequence, open_without_options<io::open_camera_info_sequence>},
     {io::is_numbered_cameras_sequence, open_without_options<io::open_numbered_cameras_sequence>},
     {io::is_tuw_sequence, open_without_options<io::open_tuw_sequence>},
     {io::is_image_folder, io::open_image_folder}}};

const FormatEntry* find_format(const path& directory) {
  const auto it = std::ranges::find_if(kFormats, [&](const FormatEntry& entry) { return entry.matches(directory); });
  return it == kFormats.end() ? nullptr : &*it;
}

bool is_sequence(const path& directory) { return find_format(directory) != nullptr || is_recording(directory); }

/// The folder, or one in it, whose files cannot be listed, with the reason. Empty if there is none.
std::string describe_locked_folder(const path& directory) {
  std::vector<path> folders{directory};
  for (const std::string& name : io::list_directories(directory)) folders.push_back(directory / name);
  for (const path& folder : folders) {
    std::error_code error;
    const io::fs::directory_iterator files(folder, error);
    if (error) return fmt::format("{} cannot be read ({})", folder.string(), error.message());
  }
  return "";
}

constexpr std::string_view kExpectedSequences =
    "expected a BOP scene (scene_camera.json), a TUM recording (rgb, depth, associations.txt or rgb.txt and "
    "depth.txt), organised *.pcd views (TUW), or colour and depth images with their camera as described in "
    "docs/formats.md";

/// What is missing where no sequence was found.
Error no_sequence_error(const path& directory) {
  if (io::is_file(directory))
    return io::file_error(directory, "is neither a folder nor a recording (ROS 1 bag 2.0, MCAP, ROS 2 bag)");
  const std::string images = io::describe_image_folder(directory);
  return io::file_error(directory, images.empty() ? fmt::format("no sequence found; {}", kExpectedSequences)
                                                  : fmt::format("no sequence found: {} (docs/your-camera.md)", images));
}

}  // namespace

std::vector<path> find_sequence_folders(const path& directory) {
  if (is_sequence(directory)) return {directory};
  const auto is_of_model = [](const path& folder, const std::string& name) {
    return name.starts_with("models") || (name == "views" && is_tuw_model(folder));
  };
  std::vector<path> found;
  std::vector<path> training;
  for (const std::string& name : io::list_directories(directory)) {
    if (is_of_model(directory, name)) continue;
    const path below = directory / name;
    if (is_sequence(below)) {
      found.push_back(below);
      continue;
    }
    for (const std::string& scene : io::list_directories(below))
      if (!is_of_model(below, scene) && (io::is_bop_scene(below / scene) || io::is_tuw_sequence(below / scene)))
        (name.starts_with("train") ? training : found).push_back(below / scene);
  }
  return found.empty() ? training : found;
}

Result<std::optional<path>> find_sequence_folder(const path& directory) {
  if (io::is_file(directory)) return is_recording(directory) ? std::optional(directory) : std::nullopt;
  if (!io::is_folder(directory)) return io::file_error(directory, "no such directory");
  const std::vector<path> found = find_sequence_folders(directory);
  if (found.size() == 1) return std::optional(found.front());
  if (found.size() > 1)
    return io::file_error(directory, fmt::format("holds {} sequences; name one of them, such as {}", found.size(),
                                                 found.front().string()));
  if (const std::string locked = describe_locked_folder(directory); !locked.empty()) return Error{locked};
  return std::optional<path>();
}

namespace {

io::SequenceResult open_as_recorded(const path& directory, const OpenSequenceOptions& options) {
  if (io::is_file(directory) && io::extension_of(directory) == "pcd") {
    auto single = io::open_single_pcd(directory);
    if (!single) return single;
    if (const auto done = io::apply_options(**single, options); !done)
      return io::file_error(directory, done.error().message);
    return single;
  }
  if (const auto finished = check_finished(directory); !finished) return finished.error();
  const auto folder = find_sequence_folder(directory);
  if (!folder) return folder.error();
  if (!*folder) return no_sequence_error(directory);
  if (const auto finished = check_finished(**folder); !finished) return finished.error();  // It may lie below.
  const FormatEntry* format = find_format(**folder);
  if (format == nullptr) return io::open_recording_sequence(**folder, options);
  auto sequence = format->open(**folder, options);
  if (!sequence) return sequence;
  if (const auto done = io::apply_options(**sequence, options); !done)
    return io::file_error(**folder, done.error().message);
  return sequence;
}

}  // namespace

Result<std::unique_ptr<Sequence>> open_sequence(const path& directory, const OpenSequenceOptions& options) {
  const double bias_per_m = options.depth_bias_per_m;
  if (!(std::abs(bias_per_m) <= kMaxDepthBias_per_m))
    return Error{fmt::format("--depth-bias {:g}: is not between -{} and {}", bias_per_m, kMaxDepthBias_per_m,
                             kMaxDepthBias_per_m)};
  auto sequence = open_as_recorded(directory, options);
  if (sequence.ok() && bias_per_m != 0)
    sequence = io::with_adjusted_frames(
        std::move(sequence).value(), [=](RgbdFrame& frame) { remove_disparity_error(bias_per_m, frame); },
        fmt::format("depth is corrected by {:+.1f} mm at 1 m (--depth-bias)", 1e3 * bias_per_m));
  if (!sequence || options.sensor == nullptr) return sequence;
  return io::with_sensor(std::move(sequence).value(), *options.sensor, "--sensor");
}

Result<std::unique_ptr<Sequence>> open_posed_sequence(const path& directory, const OpenSequenceOptions& options) {
  auto sequence = open_sequence(directory, options);
  if (sequence.ok() && !(*sequence)->has_poses() && (*sequence)->num_views() > 1)
    return io::file_error(
        directory,
        "holds no camera poses (cam_R_w2c of each view in BOP, groundtruth.txt in TUM); several views "
        "need them: resight track estimates them, --poses fixed or FILE gives them");
  return sequence;
}

Result<std::unique_ptr<SequenceWriter>> create_sequence(const path& directory, DatasetFormat format,
                                                        const SequenceContent& content) {
  return format == DatasetFormat::kBop ? io::create_bop_scene(directory, content) : io::create_tuw_sequence(directory);
}

}  // namespace resight
