// SPDX-License-Identifier: Apache-2.0
#include "resight/io/internal/trajectory_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>

#include "resight/io/internal/files.hpp"
#include "resight/io/internal/json_poses.hpp"
#include "resight/io/internal/text.hpp"
#include "resight/io/pose_text.hpp"

namespace resight::io {
namespace {

constexpr double kMaxPoseGap_s = 0.1;  ///< Largest time between an image and the poses before and after it.

/// A line of the file: its words, and their numbers (NaN for other words).
struct PoseRow {
  int line = 0;
  std::string stamp;
  std::vector<double> numbers;
};

struct PoseTable {
  std::vector<std::string> title;  ///< Names of the columns in lower case, if the first line has no numbers.
  std::vector<PoseRow> rows;
};

PoseTable split_table(std::string text) {
  std::ranges::replace(text, ',', ' ');
  PoseTable table;
  std::string_view rest = text;
  for (int line = 1; !rest.empty(); ++line) {
    const auto words = split_tokens(cut_line(rest));
    if (words.empty() || words[0].starts_with('#')) continue;
    const bool is_first = table.title.empty() && table.rows.empty();
    if (is_first && std::ranges::none_of(words, [](auto word) { return parse_number(word).has_value(); })) {
      for (const std::string_view word : words) table.title.push_back(to_lower(word));
      continue;
    }
    PoseRow row{line, std::string(words[0]), {}};
    for (const std::string_view word : words)
      row.numbers.push_back(parse_number(word).value_or(std::numeric_limits<double>::quiet_NaN()));
    table.rows.push_back(std::move(row));
  }
  return table;
}

/// The columns of x y z qx qy qz qw.
using PoseColumns = std::array<std::size_t, 7>;

/// In the last seven columns, by the letters at the end of their names. None if the title does not name each of them.
std::optional<PoseColumns> find_pose_columns(const std::vector<std::string>& title, std::size_t width) {
  PoseColumns columns{};
  if (title.size() != width) return std::nullopt;
  for (std::size_t i = width - columns.size(); i < width; ++i) {
    const std::string& name = title[i];
    const bool is_rotation =
        name.find('q') != name.npos || name.find("rot") != name.npos || name.find("orient") != name.npos;
    const std::size_t axis = std::string_view(is_rotation ? "xyzw" : "xyz").find(name.back());
    if (axis == std::string_view::npos) return std::nullopt;
    std::size_t& column = columns[is_rotation ? 3 + axis : axis];
    if (column != 0) return std::nullopt;
    column = i;
  }
  return columns;
}

bool is_finite_row(const PoseRow& row, std::size_t first) {
  return std::all_of(row.numbers.begin() + static_cast<std::ptrdiff_t>(first), row.numbers.end(),
                     [](double n) { return std::isfinite(n); });
}

/// A row `stamp tx ty tz qx qy qz qw`, or as the title says; with 9 numbers, `stamp number tx ..` (phone recordings).
Result<std::vector<StampedPose>> from_stamped_rows(const PoseTable& table, const fs::path& file,
                                                   bool may_be_untracked) {
  const std::size_t at = table.rows.back().numbers.size() - PoseColumns().size();
  std::optional<PoseColumns> columns{{at, at + 1, at + 2, at + 3, at + 4, at + 5, at + 6}};
  if (!table.title.empty()) columns = find_pose_columns(table.title, at + columns->size());
  if (!columns) return file_error(file, "the title does not name the columns x y z qx qy qz qw behind the stamp");
  std::vector<StampedPose> poses;
  for (const PoseRow& row : table.rows) {
    if (may_be_untracked && !is_finite_row(row, at)) continue;
    const auto n = [&](std::size_t i) { return row.numbers[(*columns)[i]]; };
    const auto pose = rigid_from_quaternion({n(6), n(3), n(4), n(5)}, {n(0), n(1), n(2)},
                                            fmt::format("{}: time {}", file.string(), row.stamp));
    if (!pose) return pose.error();
    if (!may_be_untracked && !std::isfinite(row.numbers[0]))
      return file_error(file, fmt::format("line {} cannot be parsed: its time is no number", row.line));
    poses.push_back({row.numbers[0], row.stamp, *pose});
    if (at == 2) poses.back().number = row.numbers[1];
  }
  return poses;
}

Result<Rigid3> from_matrix_numbers(const std::vector<double>& numbers, const fs::path& file, int line) {
  return rigid_from_numbers(numbers, fmt::format("{}: line {}", file.string(), line));
}

/// Matrices of four rows. Rows of other lengths between them are headers.
Result<std::vector<StampedPose>> from_blocks(const std::vector<PoseRow>& rows, const fs::path& file) {
  std::vector<StampedPose> poses;
  std::vector<double> numbers;
  for (const PoseRow& row : rows) {
    if (row.numbers.size() != 4) {
      if (!numbers.empty() || row.numbers.size() > 3)
        return file_error(file, fmt::format("line {} cannot be parsed (expected a row of 4 numbers)", row.line));
      continue;
    }
    numbers.insert(numbers.end(), row.numbers.begin(), row.numbers.end());
    if (numbers.size() < 16) continue;
    const auto pose = from_matrix_numbers(numbers, file, row.line);
    if (!pose) return pose.error();
    poses.push_back({std::numeric_limits<double>::quiet_NaN(), "", *pose});
    numbers.clear();
  }
  if (!numbers.empty()) return file_error(file, "is cut off: its last matrix has fewer than 4 rows");
  return poses;
}

Result<std::vector<StampedPose>> from_matrix_rows(const std::vector<PoseRow>& rows, const fs::path& file) {
  std::vector<StampedPose> poses;
  for (const PoseRow& row : rows) {
    const auto pose = from_matrix_numbers(row.numbers, file, row.line);
    if (!pose) return pose.error();
    poses.push_back({std::numeric_limits<double>::quiet_NaN(), "", *pose});
  }
  return poses;
}

}  // namespace

Result<std::vector<StampedPose>> read_pose_list(const fs::path& file, bool may_be_untracked) {
  if (extension_of(file) == "json") return read_json_poses(file);
  auto text = read_file(file);
  if (!text) return text.error();
  const PoseTable table = split_table(std::move(*text));
  const std::vector<PoseRow>& rows = table.rows;
  if (rows.empty()) return file_error(file, "holds no poses");
  const std::size_t width = rows.back().numbers.size();
  if (width == 4) return from_blocks(rows, file);
  const bool known = width == 8 || width == 9 || width == 12 || width == 16;
  for (const PoseRow& row : rows)
    if (!known || row.numbers.size() != width)
      return file_error(file, fmt::format("line {} cannot be parsed: {} numbers (expected stamp tx ty tz qx qy qz qw, "
                                          "or a matrix of 12 or 16 numbers)",
                                          row.line, row.numbers.size()));
  return width <= 9 ? from_stamped_rows(table, file, may_be_untracked) : from_matrix_rows(rows, file);
}

std::optional<Rigid3> interpolate_pose(const std::vector<StampedPose>& poses, double time_s) {
  const auto after = std::ranges::lower_bound(poses, time_s, {}, &StampedPose::time_s);
  const bool has_after = after != poses.end() && after->time_s - time_s <= kMaxPoseGap_s;
  const bool has_before = after != poses.begin() && time_s - std::prev(after)->time_s <= kMaxPoseGap_s;
  if (has_after && has_before) {
    const StampedPose& a = *std::prev(after);
    const double share = after->time_s > a.time_s ? (time_s - a.time_s) / (after->time_s - a.time_s) : 0.0;
    return interpolate(a.world_from_camera, after->world_from_camera, share);
  }
  // At the ends of the recording, the nearest pose is used if it is close enough.
  if (has_after && after->time_s - time_s <= kMaxImageGap_s) return after->world_from_camera;
  if (has_before && time_s - std::prev(after)->time_s <= kMaxImageGap_s) return std::prev(after)->world_from_camera;
  return std::nullopt;
}

}  // namespace resight::io
