// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <set>

#include "resight/io/internal/files.hpp"
#include "resight/io/internal/listed_sequence.hpp"
#include "resight/io/internal/sequences.hpp"
#include "resight/io/internal/text.hpp"
#include "resight/io/internal/time_pairs.hpp"
#include "resight/io/internal/trajectory_file.hpp"

namespace resight::io {
namespace {

struct StampedFile {
  double time_s = 0;
  fs::path file;
};

/// Calls row(words) for each line that is neither empty nor a comment, until it returns false. A line that occurs again
/// says nothing new.
template <typename Row>
Result<void> for_each_row(const fs::path& file, const Row& row) {
  const auto text = read_file(file);
  if (!text) return text.error();
  std::string_view rest = *text;
  std::set<std::vector<std::string_view>> known;
  for (int number = 1; !rest.empty(); ++number) {
    const auto words = split_tokens(cut_line(rest));
    if (words.empty() || words[0].starts_with('#') || !known.insert(words).second) continue;
    if (!row(words))
      return file_error(file, fmt::format("line {} cannot be parsed, or leads out of the folder", number));
  }
  return {};
}

Result<std::vector<StampedFile>> read_file_list(const fs::path& list) {
  std::vector<StampedFile> files;
  const auto done = for_each_row(list, [&](const std::vector<std::string_view>& words) {
    const auto time_s = parse_number(words[0]);
    if (!time_s || words.size() != 2) return false;
    const auto image = path_below(list.parent_path(), words[1]);
    if (!image) return false;
    files.push_back({*time_s, *image});
    return true;
  });
  if (!done) return done.error();
  return files;
}

std::vector<double> times_of(const std::vector<StampedFile>& files) {
  std::vector<double> times_s;
  for (const StampedFile& file : files) times_s.push_back(file.time_s);
  return times_s;
}

using ImagePairs = std::vector<std::pair<StampedFile, StampedFile>>;  ///< Colour and depth, by the time of the colour.

Result<ImagePairs> read_associations(const fs::path& file) {
  ImagePairs pairs;
  const auto done = for_each_row(file, [&](const std::vector<std::string_view>& words) {
    if (words.size() != 4) return false;
    const auto first = parse_number(words[0]);
    const auto second = parse_number(words[2]);
    if (!first || !second || !std::isfinite(*first) || !std::isfinite(*second)) return false;
    const auto first_image = path_below(file.parent_path(), words[1]);
    const auto second_image = path_below(file.parent_path(), words[3]);
    if (!first_image || !second_image) return false;
    StampedFile color{*first, *first_image};
    StampedFile depth{*second, *second_image};
    if (words[1].starts_with("depth")) std::swap(color, depth);  // both orders occur
    pairs.emplace_back(std::move(color), std::move(depth));
    return true;
  });
  if (!done) return done.error();
  std::ranges::stable_sort(pairs, {}, [](const auto& pair) { return pair.first.time_s; });
  return pairs;
}

Result<ImagePairs> associate(const fs::path& directory) {
  const auto colors = read_file_list(directory / "rgb.txt");
  if (!colors) return colors.error();
  const auto depths = read_file_list(directory / "depth.txt");
  if (!depths) return depths.error();
  ImagePairs pairs;
  for (const TimePair& pair : pair_by_time(times_of(*colors), times_of(*depths), kMaxImageGap_s))
    pairs.emplace_back((*colors)[pair.color], (*depths)[pair.depth]);
  return pairs;
}

/// Whether one of the words of a folder's name, such as rgbd_dataset_freiburg1_xyz, is the word.
bool names(std::string_view folder, std::string_view word) {
  const auto is_letter_or_digit = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0; };
  for (std::size_t at = folder.find(word); at != folder.npos; at = folder.find(word, at + 1)) {
    const std::size_t end = at + word.size();
    if ((at == 0 || !is_letter_or_digit(folder[at - 1])) && (end == folder.size() || !is_letter_or_digit(folder[end])))
      return true;
  }
  return false;
}

/// The calibration given, in the folder, or published for the data set of that name, with a note.
Result<Calibration> find_tum_calibration(const fs::path& directory, const OpenSequenceOptions& options,
                                         std::vector<std::string>& notes) {
  if (!options.intrinsics.empty()) return parse_calibration(options.intrinsics);
  fs::path source;
  const auto found = find_calibration(directory, source);
  if (!found) return found.error();
  if (*found) return **found;
  const std::string name = to_lower(folder_name(directory));
  constexpr std::array<Intrinsics, 3> kPublished{
      {{517.3, 516.5, 318.6, 255.3}, {520.9, 521.0, 325.1, 249.7}, {535.4, 539.2, 320.1, 247.6}}};
  for (std::size_t i = 0; i < kPublished.size(); ++i) {
    if (!names(name, fmt::format("freiburg{}", i + 1)) && !names(name, fmt::format("fr{}", i + 1))) continue;
    notes.push_back(fmt::format(
        "intrinsics: those published for freiburg{} of the TUM data set, by the folder's name (--intrinsics)", i + 1));
    Calibration calibration;
    calibration.intrinsics = kPublished[i];
    calibration.width = 640;
    calibration.height = 480;
    return calibration;
  }
  return file_error(directory,
                    "holds no camera.txt, and its name is none of the TUM data set (freiburg1, ..): give "
                    "--intrinsics fx,fy,cx,cy or FILE");
}

/// groundtruth.txt, or the file of ICL-NUIM, such as livingRoom0n.gt.freiburg. Empty if there is none.
fs::path find_tum_poses(const fs::path& directory) {
  if (is_file(directory / "groundtruth.txt")) return directory / "groundtruth.txt";
  for (const std::string& name : list_files(directory))
    if (name.ends_with(".gt.freiburg")) return directory / name;
  return {};
}

}  // namespace

bool is_tum_sequence(const fs::path& directory) {
  return is_folder(directory / "rgb") && is_folder(directory / "depth") &&
         (is_file(directory / "associations.txt") ||
          (is_file(directory / "rgb.txt") && is_file(directory / "depth.txt")));
}

SequenceResult open_tum_sequence(const fs::path& directory, const OpenSequenceOptions& options) {
  const fs::path associations = directory / "associations.txt";
  const auto pairs = is_file(associations) ? read_associations(associations) : associate(directory);
  if (!pairs) return pairs.error();
  SequenceTable table;
  const auto calibration = find_tum_calibration(directory, options, table.notes);
  if (!calibration) return calibration.error();
  table.format = "tum";
  table.lens = calibration->lens;
  const fs::path pose_file = find_tum_poses(directory);
  table.has_poses = options.poses.empty() && !pose_file.empty();
  Result<std::vector<StampedPose>> poses = std::vector<StampedPose>{};
  if (table.has_poses) poses = read_pose_list(pose_file, false);
  if (!poses) return poses.error();
  std::ranges::stable_sort(*poses, {}, &StampedPose::time_s);
  for (const auto& [color, depth] : *pairs) {
    // Uses the pose of the depth image, because its geometry is placed in the world.
    const auto pose = table.has_poses ? interpolate_pose(*poses, depth.time_s) : std::optional(Rigid3::identity());
    if (!pose) continue;
    ListedView view;
    view.name = color.file.stem().string();
    view.image_id = static_cast<int>(table.views.size());
    view.color = color.file;
    view.depth = depth.file;
    view.intrinsics = calibration->intrinsics;
    view.metres_per_unit = 1.0 / 5000;
    view.time_s = depth.time_s;
    view.world_from_camera = *pose;
    table.views.push_back(std::move(view));
  }
  if (table.views.empty())
    return file_error(directory, pairs->empty()
                                     ? std::string("its lists name no pair of images")
                                     : "no image has a pose near in time in " + pose_file.filename().string());
  if (table.views.size() < pairs->size())
    table.notes.push_back(fmt::format("{} of {} views have no pose near in time and are left out",
                                      pairs->size() - table.views.size(), pairs->size()));
  if (const auto fits = check_image_size(*calibration, table.views.front().color, directory.string()); !fits)
    return fits.error();
  return make_listed_sequence(std::move(table));
}

}  // namespace resight::io
