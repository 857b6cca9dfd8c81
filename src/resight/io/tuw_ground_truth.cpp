// SPDX-License-Identifier: Apache-2.0
#include "resight/io/tuw_ground_truth.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <tuple>

#include "resight/core/check.hpp"
#include "resight/core/names.hpp"
#include "resight/io/internal/files.hpp"
#include "resight/io/internal/text.hpp"
#include "resight/io/internal/tuw_names.hpp"
#include "resight/io/pose_text.hpp"

namespace resight {
namespace {

using io::fs::path;
constexpr std::string_view kOcclusion = "occlusion_";

/// The view of a file, and the rest of the file stem.
struct Assignment {
  std::size_t view = 0;
  std::string_view rest;
};

/// Finds the view of file stems `<view>_..`: the longest matching view name, with any number of digits.
class ViewMatcher {
 public:
  explicit ViewMatcher(const std::vector<std::string>& views) {
    for (std::size_t i = 0; i < views.size(); ++i) numbers_.try_emplace(io::normalized_view(views[i]), i);
  }
  [[nodiscard]] std::optional<Assignment> match(std::string_view stem) const {
    for (std::size_t end = stem.rfind('_'); end != stem.npos && end > 0; end = stem.rfind('_', end - 1))
      if (const auto view = find(stem.substr(0, end))) return Assignment{*view, stem.substr(end + 1)};
    return std::nullopt;
  }
  [[nodiscard]] std::optional<std::size_t> find(std::string_view view) const {
    const auto it = numbers_.find(io::normalized_view(view));
    return it == numbers_.end() ? std::nullopt : std::optional(it->second);
  }

 private:
  std::map<std::string, std::size_t, std::less<>> numbers_;
};

Result<double> read_visible_share(const path& occlusion_file) {
  if (occlusion_file.empty()) return std::numeric_limits<double>::quiet_NaN();
  const auto text = io::read_file(occlusion_file);
  if (!text) return text.error();
  const auto numbers = io::parse_numbers(*text);
  if (!numbers || numbers->size() != 1 || !(numbers->front() >= -1e-6 && numbers->front() <= 1 + 1e-6))
    return io::file_error(occlusion_file, "expected one number from 0 (visible) to 1 (hidden)");
  return std::clamp(1 - numbers->front(), 0.0, 1.0);
}

bool is_taken_for_occlusion(const std::string& object) { return (object + "_").starts_with(kOcclusion); }

Result<void> check_objects(const path& directory, const std::vector<GroundTruthObject>& objects) {
  for (const GroundTruthObject& object : objects) {
    if (!io::is_safe_name(object.object))
      return io::file_error(directory, "object name '" + object.object + "' cannot be part of a file name");
    if (is_taken_for_occlusion(object.object))
      return io::file_error(directory, "object name '" + object.object +
                                           "' begins like the files of occlusions of TUW: rename the object, or write "
                                           "BOP");
    require(object.camera_from_object.is_rigid(), "write_tuw_annotation: camera_from_object is not rigid");
  }
  return {};
}

}  // namespace

std::vector<TuwViewAnnotation> find_tuw_annotations(const path& directory, const std::vector<std::string>& views) {
  const ViewMatcher matcher(views);
  std::vector<TuwViewAnnotation> annotations(views.size());
  std::vector<std::map<std::pair<std::string, int>, path>> occlusions(views.size());
  for (const std::string& name : io::list_files(directory)) {
    const path file = directory / name;
    const std::string stem = file.stem().string();
    const std::string extension = io::extension_of(file);
    if (extension == "anno") {
      if (const auto view = matcher.find(stem)) annotations[*view].anno = file;
    }
    const auto assignment = extension == "txt" ? matcher.match(stem) : std::nullopt;
    if (!assignment) continue;
    const bool is_occlusion = assignment->rest.starts_with(kOcclusion);
    auto what = io::split_object_instance(assignment->rest.substr(is_occlusion ? kOcclusion.size() : 0));
    if (!what) continue;
    if (is_occlusion)
      occlusions[assignment->view][{what->object, what->instance}] = file;
    else
      annotations[assignment->view].poses.push_back({std::move(what->object), what->instance, file, {}});
  }
  for (std::size_t i = 0; i < views.size(); ++i) {
    for (auto& pose : annotations[i].poses)
      if (const auto it = occlusions[i].find({pose.object, pose.instance}); it != occlusions[i].end())
        pose.occlusion = it->second;
    std::ranges::sort(annotations[i].poses, {}, [](const auto& p) { return std::tie(p.object, p.instance); });
  }
  return annotations;
}

path find_tuw_annotation_directory(const path& sequence, const std::vector<std::string>& views) {
  const std::string name = io::folder_name(sequence);
  const path parent = io::fs::absolute(sequence).lexically_normal() / (name.empty() ? "." : "..");
  std::vector<path> candidates = {sequence, sequence / "annotations", sequence / "gt"};
  for (const path& base : {parent, parent / ".."})
    for (const std::string& folder : io::list_directories(base)) {
      const std::string lower = io::to_lower(folder);
      if (lower.ends_with("annotations") || lower.ends_with("annotation") || lower == "gt" ||
          lower.ends_with("ground_truth"))
        candidates.push_back(base / folder / name);
    }
  for (const path& candidate : candidates)
    if (std::ranges::any_of(find_tuw_annotations(candidate, views), [](const auto& a) { return !a.empty(); }))
      return candidate.lexically_normal();
  return sequence;
}

Result<std::vector<GroundTruthObject>> parse_tuw_anno(std::string_view text, std::string_view name) {
  std::vector<GroundTruthObject> objects;
  std::map<std::string, int, std::less<>> counts;
  for (int number = 1; !text.empty(); ++number) {
    const std::string_view line = io::cut_line(text);
    if (io::split_tokens(line).empty()) continue;
    const std::string where = fmt::format("{}: line {}", name, number);
    const std::size_t colon = line.rfind(':');
    const std::size_t close = line.rfind(')', colon);
    const std::size_t open = line.rfind('(', close);
    if (colon == line.npos || close == line.npos || open == line.npos)
      return Error{where + ": expected '<name> (<visible share>): <16 numbers>'"};
    const auto words = io::split_tokens(line.substr(0, open));
    const auto share = io::parse_number(line.substr(open + 1, close - open - 1));
    if (words.size() != 1 || !share || *share < -1e-6 || *share > 1 + 1e-6)
      return Error{where + ": expected '<name> (<visible share>): <16 numbers>'"};
    if (const auto valid = check_object_name(words[0]); !valid) return Error{where + ": " + valid.error().message};
    const auto pose = parse_pose(line.substr(colon + 1), where);
    if (!pose) return pose.error();
    GroundTruthObject object;
    object.object = words[0];
    object.instance = counts[object.object]++;
    object.camera_from_object = *pose;
    object.visible_share = std::clamp(*share, 0.0, 1.0);
    objects.push_back(std::move(object));
  }
  return objects;
}

Result<std::vector<GroundTruthObject>> read_tuw_annotation(const TuwViewAnnotation& annotation) {
  if (annotation.poses.empty() && !annotation.anno.empty()) {
    const auto text = io::read_file(annotation.anno);
    if (!text) return text.error();
    return parse_tuw_anno(*text, annotation.anno.string());
  }
  std::vector<GroundTruthObject> objects;
  for (const auto& file : annotation.poses) {
    if (const auto valid = check_object_name(file.object); !valid)
      return io::file_error(file.pose, valid.error().message);
    const auto pose = read_pose(file.pose);
    if (!pose) return pose.error();
    const auto share = read_visible_share(file.occlusion);
    if (!share) return share.error();
    objects.push_back({file.object, 0, file.instance, *pose, *share});
  }
  return objects;
}

Result<void> write_tuw_annotation(const path& directory, const std::string& view,
                                  const std::vector<GroundTruthObject>& objects) {
  if (const auto done = check_objects(directory, objects); !done) return done;
  for (const GroundTruthObject& object : objects) {
    const std::string what = fmt::format("{}_{}.txt", object.object, object.instance);
    if (io::is_file(directory / (view + "_" + what)))
      return io::file_error(directory / (view + "_" + what), "two objects of one view have the same name and instance");
    if (const auto done =
            io::write_file(directory / (view + "_" + what), format_pose(object.camera_from_object) + "\n");
        !done)
      return done;
    if (std::isnan(object.visible_share)) continue;
    const auto done = io::write_file(directory / fmt::format("{}_{}{}", view, kOcclusion, what),
                                     fmt::format("{}\n", 1 - object.visible_share));
    if (!done) return done;
  }
  return {};
}

}  // namespace resight
