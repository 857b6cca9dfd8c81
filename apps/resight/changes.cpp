// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <string_view>
#include <utility>

#include "camera_run.hpp"
#include "commands.hpp"
#include "output_paths.hpp"
#include "progress.hpp"
#include "recognition_run.hpp"
#include "resight/changes/change_regions.hpp"
#include "resight/core/files.hpp"
#include "resight/core/input_file.hpp"
#include "resight/io/images.hpp"
#include "resight/io/parse_json.hpp"
#include "resight/io/ply.hpp"
#include "resight/recognition/stage_options.hpp"
#include "resight/reconstruction/dynamic_scene.hpp"
#include "resight/report/overlay.hpp"
#include "resight/report/scene_changes.hpp"
#include "resight/sensor/read_ahead.hpp"
#include "resight/sensor/reduce_frame.hpp"

namespace resight::app {
namespace {

constexpr Rgb8 kRemovedColor{220, 30, 30};
constexpr Rgb8 kNovelColor{30, 190, 60};

// Ends of the names of the files of a view.
constexpr const char* kOverlay = ".png";
constexpr const char* kNovelMask = "_novel.png";
constexpr const char* kRemovedMask = "_removed.png";
constexpr const char* kCloud = ".ply";
constexpr const char* kEnds[] = {kOverlay, kNovelMask, kRemovedMask, kCloud};

constexpr const char* kChangesFile = "changes.json";

/// The files of all views. Two views may have a file in common: `cup_removed.png` is the mask of `cup`, but also the
/// picture of `cup_removed`.
std::set<std::string> name_files(const Sequence& sequence) {
  std::set<std::string> files;
  for (int v = 0; v < sequence.num_views(); ++v)
    for (const char* end : kEnds)
      if (const std::string file = sequence.view_name(v) + end; !files.insert(file).second)
        throw InputError(fmt::format("view '{}': its file {} would also be one of another view (rename the view)",
                                     sequence.view_name(v), file));
  return files;
}

/// The files that the results in a folder name as theirs.
std::vector<std::string> list_old_files(const std::filesystem::path& folder) {
  std::vector<std::string> files;
  const auto text = read_file(folder / kChangesFile);
  if (!text) return files;
  const auto old = parse_json(*text);
  if (!old || !old->is_object() || !old->contains("views")) return files;
  for (const auto& view : old->at("views")) {
    const auto name = view.is_object() ? view.find("name") : view.end();
    if (name == view.end() || !name->is_string()) continue;
    for (const char* end : kEnds)
      if (std::string file = name->get<std::string>() + end;
          file.find_first_of(std::string_view("/\0", 2)) == std::string::npos)
        files.push_back(std::move(file));
  }
  return files;
}

// The reconstruction with its changes: red = removed, green = novel, otherwise the colours of the scene.
PointCloud paint(PointCloud scene, const ChangeResult& changes) {
  const auto add = [&](PointCloud cloud, Rgb8 color) {
    cloud.normals.clear();
    cloud.colors.assign(cloud.size(), color);
    scene.append(cloud);
  };
  scene.normals.clear();
  add(changes.removed_in_world, kRemovedColor);
  add(changes.novel_in_world, kNovelColor);
  return scene;
}

void write_masks(const std::filesystem::path& folder, const std::string& name, const ChangeResult& changes,
                 int reduction, const Camera& recorded) {
  const auto write = [&](const char* end, const Image<std::uint8_t>& mask) {
    value_or_throw(write_mask(folder / (name + end), enlarge_mask(mask, reduction, recorded.width, recorded.height)));
  };
  write(kNovelMask, changes.novel_mask);
  write(kRemovedMask, changes.removed_mask);
}

std::string count_regions(const ViewChangeRecord& view) {
  const auto num_novel =
      std::ranges::count_if(view.regions, [](const ChangeRegion& r) { return r.kind == RegionKind::kNovel; });
  return fmt::format("{} regions removed, {} novel", static_cast<std::ptrdiff_t>(view.regions.size()) - num_novel,
                     num_novel);
}

}  // namespace

// Alg. 1 without models: compares each view with the reconstruction from the views before it. `mvr` compares nothing,
// so that its reconstruction is the one of a static world (paper, Fig. 6).
void run_changes(const ChangesArguments& arguments) {
  check_output_folder(arguments.out, "changes", {arguments.sequence});
  RecognizerConfig config =
      make_config(arguments.preset, arguments.config, arguments.num_previous_views, arguments.num_threads);
  if (arguments.poses == "fixed") config.camera.poses.fixed = true;
  const auto given = open_recorded_input(arguments.sequence, arguments.input, arguments.poses);
  const std::set<std::string> files = name_files(*given);
  auto folder = value_or_throw(PendingDirectory::create(arguments.out, ExistingFolder::kFill));
  const auto tracked = estimate_poses(*given, arguments.sequence, arguments.poses, nullptr, arguments.num_threads);
  const Sequence& sequence = tracked ? static_cast<const Sequence&>(*tracked) : *given;
  const CameraErrors errors =
      measure_camera_errors(sequence, config.prepare, config.camera.color_offset, config.camera.depth_bias);
  DynamicScene scene(scene_options(config));
  SceneChanges record{RESIGHT_VERSION, arguments.preset, arguments.sequence.string(), {}};
  Progress progress("changes", sequence.num_views());
  ReadAhead reader(sequence, arguments.num_threads);
  for (int v = 0; v < sequence.num_views(); ++v) {
    RgbdFrame recorded = value_or_throw(reader.read_view(v));
    const Camera camera = recorded.camera;
    const ChangeResult changes = scene.add_view(prepare_corrected(std::move(recorded), errors, config.prepare));
    const RgbdFrame& frame = scene.window().back().raw;
    value_or_throw(write_color(folder.path() / (frame.name + kOverlay), draw_changes(frame, changes)));
    const int reduction = find_reduction(camera, config.prepare);
    write_masks(folder.path(), frame.name, changes, reduction, camera);
    value_or_throw(write_ply(folder.path() / (frame.name + kCloud), paint(scene.reconstruction(), changes)));
    record.views.push_back({frame.name, frame.camera.width, reduction, frame.world_from_camera, changes.changed_share,
                            changes.pose_suspect,
                            find_change_regions(frame, changes, config.changes.detection.voxel_m)});
    progress.report(v + 1, fmt::format("{}: {}{}", frame.name, count_regions(record.views.back()),
                                       changes.pose_suspect ? ", camera pose suspect" : ""));
  }
  value_or_throw(write_file(folder.path() / kChangesFile, format_scene_changes_json(record)));
  const std::vector<std::string> old_files = list_old_files(arguments.out);
  value_or_throw(folder.commit());
  std::error_code error;
  for (const std::string& file : old_files)  // Those of other views, and of more.
    if (!files.contains(file)) std::filesystem::remove(arguments.out / file, error);
  print("{} views: {}\n", sequence.num_views(), arguments.out.string());
}

}  // namespace resight::app
