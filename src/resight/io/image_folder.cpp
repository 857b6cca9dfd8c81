// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "resight/core/check.hpp"
#include "resight/io/internal/depth_arrays.hpp"
#include "resight/io/internal/depth_check.hpp"
#include "resight/io/internal/files.hpp"
#include "resight/io/internal/image_series.hpp"
#include "resight/io/internal/json_poses.hpp"
#include "resight/io/internal/listed_sequence.hpp"
#include "resight/io/internal/sequences.hpp"
#include "resight/io/internal/text.hpp"
#include "resight/io/internal/trajectory_file.hpp"
#include "resight/io/pose_text.hpp"

/// Folders of colour and depth images that follow no published layout.
namespace resight::io {
namespace {

constexpr double kMillimetre_m = 1e-3;

struct FolderCamera {
  Calibration calibration;  ///< Of the first view.
  std::string source;
  std::map<std::string, Calibration> of_views;  ///< By name, if they may differ.
};

/// Calibrations of single views by their names, as of cameras whose focus changes. Empty unless every view has one.
Result<std::map<std::string, Calibration>> find_view_calibrations(const fs::path& folder,
                                                                  const std::vector<FileSeries>& all,
                                                                  const std::vector<ImagePair>& pairs) {
  std::map<std::string, Calibration> found;
  for (const FileSeries& series : all) {
    if (series.kind != SeriesKind::kPose || extension_of(series.pattern) != "json") continue;
    // Of other JSON files per view, such as labels, even damaged ones do not matter.
    const auto first = read_view_camera(series.files.begin()->second.file);
    if (!first || !first->calibration) continue;
    for (const ImagePair& pair : pairs) {
      const auto it = series.files.find(pair.key);
      if (it == series.files.end()) continue;
      const auto camera = read_view_camera(it->second.file);
      if (!camera) return camera.error();
      if (camera->calibration) found.emplace(pair.color.name, *camera->calibration);
    }
  }
  if (const fs::path list = folder / "transforms.json"; found.empty() && is_file(list)) {
    auto of_frames = read_frame_calibrations(list);
    if (!of_frames) return of_frames;
    found = std::move(*of_frames);
  }
  const bool is_complete = std::ranges::all_of(pairs, [&](const ImagePair& p) { return found.contains(p.color.name); });
  if (!is_complete) found.clear();
  return found;
}

Result<FolderCamera> find_folder_camera(const fs::path& folder, const OpenSequenceOptions& options,
                                        const std::vector<FileSeries>& all, const PairedSeries& series) {
  if (!options.intrinsics.empty()) {
    const auto given = parse_calibration(options.intrinsics);
    if (!given) return given.error();
    return FolderCamera{*given, "--intrinsics", {}};
  }
  auto of_views = find_view_calibrations(folder, all, series.pairs);
  if (!of_views) return of_views.error();
  if (!of_views->empty()) {
    const Calibration first = of_views->at(series.pairs.front().color.name);
    return FolderCamera{first, "each view", std::move(*of_views)};
  }
  fs::path source;
  const auto found = find_calibration(folder, source);
  if (!found) return found.error();
  if (*found) return FolderCamera{**found, source.filename().string(), {}};
  return file_error(folder, fmt::format("found {} colour and {} depth images, no intrinsics: give --intrinsics "
                                        "fx,fy,cx,cy or FILE",
                                        series.color.files.size(), series.depth.files.size()));
}

/// Sixteen or twelve numbers (a matrix), or seven (tx ty tz qx qy qz qw), or JSON. None if the pose is NaN: not
/// tracked.
Result<std::optional<Rigid3>> read_view_pose(const fs::path& file) {
  if (extension_of(file) == "json") {
    const auto camera = read_view_camera(file);
    if (!camera) return camera.error();
    return camera->world_from_camera;
  }
  auto text = read_file(file, 1U << 16);
  if (!text) return text.error();
  std::ranges::replace(*text, ',', ' ');
  const auto numbers = parse_numbers(*text);
  if (numbers && !std::ranges::all_of(*numbers, [](double n) { return std::isfinite(n); }))
    return std::optional<Rigid3>();
  if (numbers && numbers->size() == 7) {
    const std::vector<double>& n = *numbers;
    const auto pose = rigid_from_quaternion({n[6], n[3], n[4], n[5]}, {n[0], n[1], n[2]}, file.string());
    if (!pose) return pose.error();
    return std::optional(*pose);
  }
  const auto pose = parse_pose(*text, file.string());
  if (!pose) return pose.error();
  return std::optional(*pose);
}

void note_poses(SequenceTable& table, const std::string& source) {
  table.notes.push_back(fmt::format(
      "poses: {}{}", source, table.poses_tell_convention ? "" : ", taken as camera to world (--pose-convention)"));
}

/// Reads one file of poses per view. Views whose file is missing or says NaN are left out.
Result<void> read_poses_per_view(SequenceTable& table, const FileSeries& series, const std::vector<std::string>& keys) {
  std::vector<ListedView> kept;
  for (std::size_t i = 0; i < table.views.size(); ++i) {
    const auto it = series.files.find(keys[i]);
    if (it == series.files.end()) continue;
    const auto pose = read_view_pose(it->second.file);
    if (!pose) return pose.error();
    if (!*pose) continue;
    kept.push_back(std::move(table.views[i]));
    kept.back().world_from_camera = **pose;
  }
  if (kept.empty()) return file_error(series.folder, "its files of poses belong to no view");
  if (kept.size() < keys.size())
    table.notes.push_back(
        fmt::format("{} of {} views have no pose and are left out", keys.size() - kept.size(), keys.size()));
  table.views = std::move(kept);
  table.has_poses = true;
  table.poses_tell_convention = extension_of(series.pattern) == "json";
  note_poses(table, series.label());
  return {};
}

/// The best series of poses, one file per view; null if there is none.
const FileSeries* find_pose_series(const std::vector<FileSeries>& all, std::size_t num_views) {
  const FileSeries* best = nullptr;
  for (const FileSeries& series : all) {
    if (series.kind != SeriesKind::kPose || (series.files.size() < 2 && num_views != 1)) continue;
    if (best != nullptr && series.files.size() <= best->files.size()) continue;
    if (extension_of(series.pattern) == "json") {
      const auto camera = read_view_camera(series.files.begin()->second.file);
      if (!camera || !camera->world_from_camera) continue;
    }
    best = &series;
  }
  return best;
}

/// Only the content tells whether a JSON file holds poses.
bool may_be_json_poses(const std::string& lower_name) {
  return extension_of(lower_name) == "json" &&
         (lower_name.starts_with("transforms") || lower_name.starts_with("metadata") ||
          lower_name.find("pose") != lower_name.npos);
}

bool is_pose_list_name(const std::string& lower_name) {
  const bool named = lower_name.find("pose") != lower_name.npos || lower_name.find("traj") != lower_name.npos ||
                     lower_name.find("groundtruth") != lower_name.npos ||
                     lower_name.find("odometry") != lower_name.npos;
  const std::string extension = extension_of(lower_name);
  return named && (extension == "txt" || extension == "csv" || extension == "log" || extension == "freiburg" ||
                   extension == "tum" || extension.empty());
}

Result<void> find_poses(SequenceTable& table, const fs::path& folder, const std::vector<FileSeries>& all,
                        const std::vector<std::string>& keys) {
  table.has_poses = false;
  if (const FileSeries* series = find_pose_series(all, keys.size())) return read_poses_per_view(table, *series, keys);
  std::vector<fs::path> lists;
  for (const std::string& name : list_files(folder))
    if (is_pose_list_name(to_lower(name)) || (may_be_json_poses(to_lower(name)) && holds_json_poses(folder / name)))
      lists.push_back(folder / name);
  if (lists.size() > 1)
    return file_error(folder, fmt::format("holds several files of poses ({}, {}): choose one by --poses FILE",
                                          lists[0].filename().string(), lists[1].filename().string()));
  if (lists.empty()) return {};
  if (const auto done = assign_poses(table, lists.front()); !done) return done;
  note_poses(table, lists.front().filename().string());
  return {};
}

/// Reads the first view to check what was assumed: the size of the images and the unit of depth.
Result<void> check_first_view(const Sequence& sequence, const FolderCamera& camera, const fs::path& folder) {
  const auto frame = sequence.read_view(0);
  if (!frame) return frame.error();
  const auto fits = check_calibration(camera.calibration, frame->camera.width, frame->camera.height,
                                      folder.string() + ": " + camera.source);
  if (!fits) return fits;
  if (const auto done = check_depth_unit(*frame); !done) return file_error(folder, done.error().message);
  return {};
}

std::string describe_unit(const FileSeries& depth, const OpenSequenceOptions& options, const FolderCamera& camera) {
  if (options.depth_scale_m) return fmt::format("{} m per unit", *options.depth_scale_m);
  if (holds_depth_array(extension_of(depth.pattern))) return "taken as metres (--depth-scale)";
  if (camera.calibration.metres_per_unit)
    return fmt::format("{:.6g} m per unit ({})", *camera.calibration.metres_per_unit, camera.source);
  return "taken as millimetres (--depth-scale)";
}

/// Colour images in the folder of a series that belong to none of its views.
std::size_t count_other_images(const std::vector<FileSeries>& all, const FileSeries& series) {
  std::size_t count = 0;
  for (const FileSeries& other : all)
    if (other.kind == series.kind && other.folder == series.folder && other.pattern != series.pattern)
      count += other.files.size();
  return count;
}

void describe(SequenceTable& table, const PairedSeries& series, const OpenSequenceOptions& options,
              const FolderCamera& camera, std::size_t num_others) {
  table.notes.push_back(fmt::format("colour {}, depth {}, {}; intrinsics of {}", series.color.label(),
                                    series.depth.label(), describe_unit(series.depth, options, camera), camera.source));
  const std::size_t largest = std::max(series.color.files.size(), series.depth.files.size());
  if (series.pairs.size() < largest)
    table.notes.push_back(fmt::format("{} colour and {} depth images make {} views; the others are left out",
                                      series.color.files.size(), series.depth.files.size(), series.pairs.size()));
  if (num_others > 0)
    table.notes.push_back(fmt::format("colour images with other names, which are left out: {}", num_others));
}

SequenceTable make_table(const PairedSeries& series, const FolderCamera& camera) {
  SequenceTable table;
  table.format = "images";
  table.depth_storage = DepthStorage::kByName;
  table.may_enlarge_depth = true;
  table.lens = camera.calibration.lens;
  for (const ImagePair& pair : series.pairs) {
    ListedView view;
    view.name = pair.color.name;
    view.image_id = static_cast<int>(table.views.size());
    view.color = pair.color.file;
    view.depth = pair.depth.file;
    if (const auto own = camera.of_views.find(view.name); own != camera.of_views.end()) view.own_camera = own->second;
    const Calibration& calibration = view.own_camera ? *view.own_camera : camera.calibration;
    view.intrinsics = calibration.intrinsics;
    view.metres_per_unit = calibration.metres_per_unit.value_or(kMillimetre_m);
    view.time_s = pair.depth.time_s;
    table.views.push_back(std::move(view));
  }
  return table;
}

}  // namespace

bool holds_poses(const fs::path& directory) {
  const auto is_list = [&](const std::string& name) {
    return is_pose_list_name(to_lower(name)) && read_pose_list(directory / name, true).ok();
  };
  const auto is_series = [](const FileSeries& s) { return s.kind == SeriesKind::kPose && s.files.size() > 1; };
  return std::ranges::any_of(find_series(directory), is_series) || std::ranges::any_of(list_files(directory), is_list);
}

bool is_image_folder(const fs::path& directory) {
  const auto paired = pair_series(find_series(directory), directory);
  return !paired.ok() || paired->has_value();
}

SequenceResult open_image_folder(const fs::path& directory, const OpenSequenceOptions& options) {
  const std::vector<FileSeries> all = find_series(directory);
  const auto series = pair_series(all, directory);
  if (!series) return series.error();
  require(series->has_value(), "open_image_folder: the folder holds no images");
  const auto camera = find_folder_camera(directory, options, all, **series);
  if (!camera) return camera.error();
  SequenceTable table = make_table(**series, *camera);
  if (const auto done = set_depth_camera(table, options); !done) return done.error();
  describe(table, **series, options, *camera, count_other_images(all, (*series)->color));
  std::vector<std::string> keys;
  for (const ImagePair& pair : (*series)->pairs) keys.push_back(pair.key);
  if (options.poses.empty())
    if (const auto done = find_poses(table, directory, all, keys); !done) return done.error();
  if (options.depth_scale_m) {
    table.npy_unit_m = options.depth_scale_m;
    for (ListedView& view : table.views) view.metres_per_unit = *options.depth_scale_m;
  }
  if (std::string note = describe_enlarged_depth(table); !note.empty()) table.notes.push_back(std::move(note));
  auto sequence = make_listed_sequence(std::move(table));
  if (const auto done = check_first_view(*sequence, *camera, directory); !done) return done.error();
  return sequence;
}

std::string describe_image_folder(const fs::path& directory) {
  const std::string images = describe_images(find_series(directory));
  for (const std::string& name : list_files(directory))
    for (const char* video : {"mp4", "mov", "mkv", "avi"})
      if (!images.empty() && extension_of(name) == video)
        return images + fmt::format("; {} is a video, which is not read (extract its images)", name);
  return images;
}

}  // namespace resight::io
