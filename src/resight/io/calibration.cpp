// SPDX-License-Identifier: Apache-2.0
#include "resight/io/internal/calibration.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "resight/io/internal/calibration_fields.hpp"
#include "resight/io/internal/files.hpp"
#include "resight/io/internal/text.hpp"

namespace resight::io {
namespace {

/// Open3D writes the camera matrix column by column.
std::vector<double> without_transposition(std::vector<double> m) {
  if (m[2] == 0 && m[5] == 0 && m[6] != 0 && m[7] != 0) {
    std::swap(m[2], m[6]);
    std::swap(m[5], m[7]);
    std::swap(m[1], m[3]);
  }
  return m;
}

/// Files that may hold a calibration.
bool has_text_extension(const fs::path& file) {
  const std::string extension = extension_of(file);
  return extension.empty() || extension == "txt" || extension == "json" || extension == "yaml" || extension == "yml" ||
         extension == "csv" || extension == "ini" || extension == "cfg" || extension == "conf" || extension == "intr";
}

/// Whether the name says that the file holds a calibration. Others are read, too, but need not hold one.
bool is_named_for_calibration(std::string_view lower_name) {
  return lower_name.find("intrinsic") != lower_name.npos || lower_name.starts_with("camera") ||
         lower_name.starts_with("cam_k") || lower_name.find("calib") != lower_name.npos;
}

/// Whether the name hints at a calibration. For other files, only the content counts.
bool hints_at_calibration(std::string_view lower_name) {
  constexpr std::array<std::string_view, 7> kHints = {"cam", "meta", "info", "config", "kinect", "k.txt", "transforms"};
  return is_named_for_calibration(lower_name) ||
         std::ranges::any_of(kHints, [&](std::string_view hint) { return lower_name.find(hint) != lower_name.npos; });
}

/// Files of poses and of lists hold other numbers.
bool may_hold_calibration(std::string_view lower_name) {
  constexpr std::array<std::string_view, 7> kOthers = {"pose",  "traj", "groundtruth", "odometry",
                                                       "assoc", "imu",  "label"};
  return std::ranges::none_of(kOthers,
                              [&](std::string_view other) { return lower_name.find(other) != lower_name.npos; });
}

/// Whether the numbers are likely to be those of a camera: square pixels, and a centre near the middle of the image.
bool is_plausible(const Calibration& calibration) {
  const Intrinsics& k = calibration.intrinsics;
  const auto is_between = [](double value, double low, double high) { return value > low && value < high; };
  return k.fx > 50 && is_between(k.fx / k.fy, 0.8, 1.25) && is_between(k.cx / k.fx, 0.05, 3) &&
         is_between(k.cy / k.fy, 0.05, 3);
}

/// Of a camera in COLMAP's cameras.txt: which numbers behind the size are fx, fy, cx, cy and distortion coefficients.
struct ColmapModel {
  std::string_view name;
  std::string_view lens;
  std::size_t num_focal_lengths;
  std::size_t num_coefficients;
};
constexpr std::array<ColmapModel, 6> kColmapModels{{{"SIMPLE_PINHOLE", "", 1, 0},
                                                    {"PINHOLE", "", 2, 0},
                                                    {"SIMPLE_RADIAL", "plumb_bob", 1, 1},
                                                    {"RADIAL", "plumb_bob", 1, 2},
                                                    {"OPENCV", "plumb_bob", 2, 4},
                                                    {"OPENCV_FISHEYE", "equidistant", 2, 4}}};

/// None if the text is no list of COLMAP's cameras (number, model, width, height, parameters).
Result<std::optional<Calibration>> parse_colmap_cameras(std::string_view text, std::string_view what) {
  std::optional<Calibration> found;
  while (!text.empty()) {
    const auto words = split_tokens(cut_line(text));
    if (words.empty() || words[0].starts_with('#')) continue;
    if (words.size() < 4) return std::optional<Calibration>();
    const auto model = std::ranges::find(kColmapModels, words[1], &ColmapModel::name);
    if (model == kColmapModels.end()) return std::optional<Calibration>();
    std::vector<double> n;
    for (std::size_t i = 2; i < words.size(); ++i) n.push_back(parse_number(words[i]).value_or(std::nan("")));
    const std::size_t center = 2 + model->num_focal_lengths;
    if (n.size() != center + 2 + model->num_coefficients)
      return Error{fmt::format("{}: the camera '{}' has {} numbers", what, model->name, n.size())};
    if (!(n[0] >= 1 && n[0] < 1e6 && n[1] >= 1 && n[1] < 1e6))
      return Error{fmt::format("{}: the image size {}x{} is out of range", what, n[0], n[1])};
    // COLMAP counts from the corner of the image: the centre of its first pixel is at (0.5, 0.5).
    auto calibration = calibration_from_numbers({n[2], n[center - 1], n[center] - 0.5, n[center + 1] - 0.5}, what);
    if (!calibration) return calibration.error();
    std::vector<double> coefficients(n.begin() + static_cast<std::ptrdiff_t>(center) + 2, n.end());
    coefficients.resize(4, 0);
    const auto lens = LensDistortion::make(model->lens, coefficients);
    if (!lens) return Error{fmt::format("{}: {}", what, lens.error().message)};
    calibration->lens = *lens;
    calibration->width = static_cast<int>(n[0]);
    calibration->height = static_cast<int>(n[1]);
    if (found && (found->intrinsics != calibration->intrinsics || found->lens != calibration->lens ||
                  found->width != calibration->width || found->height != calibration->height))
      return Error{fmt::format("{}: holds several cameras; give one by --intrinsics fx,fy,cx,cy", what)};
    found = *calibration;
  }
  return found;
}

struct FoundCalibration {
  fs::path file;
  Calibration calibration;
  bool is_hinted = true;  ///< By its name.
};

/// A few numbers without names may be anything.
bool is_list_of_few_numbers(const fs::path& file) {
  const auto text = extension_of(file) == "json" ? Result<std::string>(Error{""}) : read_file(file);
  const auto numbers = text.ok() ? parse_number_list(*text) : std::nullopt;
  return numbers && numbers->size() != 9 && numbers->size() != 12 && numbers->size() != 16;
}

/// The calibration that a file of any name holds, if it can hardly be anything else.
std::optional<Calibration> find_by_content(const fs::path& file) {
  if (is_list_of_few_numbers(file)) return std::nullopt;
  const auto calibration = read_calibration(file);
  return calibration.ok() && is_plausible(*calibration) ? std::optional(*calibration) : std::nullopt;
}

bool is_of_color(const FoundCalibration& found) {
  const std::string name = to_lower(found.file.filename().string());
  return name.find("color") != name.npos || name.find("colour") != name.npos || name.find("rgb") != name.npos;
}

/// Collects the calibrations directly in a folder. Returns the error of a file that by its name must hold one.
std::optional<Error> collect_calibrations(const fs::path& folder, std::vector<FoundCalibration>& found) {
  constexpr std::uintmax_t kMaxCalibrationBytes = 1U << 20;
  constexpr int kMaxOtherFiles = 50;  // More are no calibrations, but one file per view.
  std::optional<Error> error;
  int num_others = 0;
  for (const std::string& name : list_files(folder)) {
    const std::string lower = to_lower(name);
    if (!has_text_extension(name) || !may_hold_calibration(lower)) continue;
    const bool is_hinted = hints_at_calibration(lower);
    if (!is_hinted && ++num_others > kMaxOtherFiles) continue;
    std::error_code ignored;
    if (fs::file_size(folder / name, ignored) > kMaxCalibrationBytes) continue;
    if (!is_hinted) {
      if (const auto calibration = find_by_content(folder / name))
        found.push_back({folder / name, *calibration, false});
      continue;
    }
    const auto calibration = read_calibration(folder / name);
    if (calibration)
      found.push_back({folder / name, *calibration});
    else if (is_named_for_calibration(lower))
      error = calibration.error();
  }
  return error;
}

}  // namespace

Result<Intrinsics> intrinsics_from_matrix(const std::vector<double>& matrix, std::string_view what) {
  const auto fail = [&](std::string_view why) { return Error{fmt::format("{}: {}", what, why)}; };
  if (matrix.size() != 9) return fail("expected the 9 numbers of a camera matrix");
  for (const double value : matrix)
    if (!std::isfinite(value)) return fail("the camera matrix holds NaN or infinite numbers");
  const Intrinsics k{matrix[0], matrix[4], matrix[2], matrix[5]};
  if (!(k.fx > 0 && k.fy > 0)) return fail(fmt::format("the focal lengths {} and {} must be positive", k.fx, k.fy));
  if (std::abs(matrix[1]) > 1e-3 * k.fx) return fail("the camera matrix has skew, which is not supported");
  if (matrix[3] != 0 || matrix[6] != 0 || matrix[7] != 0 || std::abs(matrix[8] - 1) > 1e-6)
    return fail("is not a camera matrix (fx 0 cx 0 fy cy 0 0 1)");
  return k;
}

Result<Calibration> calibration_from_numbers(const std::vector<double>& n, std::string_view what) {
  std::vector<double> matrix;
  std::vector<double> coefficients;
  if (n.size() == 9 && n[8] == 1)
    matrix = without_transposition(n);
  else if (n.size() == 12 && n[10] == 1)
    matrix = {n[0], n[1], n[2], n[4], n[5], n[6], n[8], n[9], n[10]};
  else if (n.size() == 16)
    matrix = without_transposition({n[0], n[1], n[2], n[4], n[5], n[6], n[8], n[9], n[10]});
  else if (n.size() == 4 || (n.size() >= 8 && n.size() <= 12)) {
    matrix = {n[0], 0, n[2], 0, n[1], n[3], 0, 0, 1};
    coefficients.assign(n.begin() + 4, n.end());
  } else {
    return Error{fmt::format("{}: {} numbers; expected fx fy cx cy (and distortion coefficients) or a camera matrix",
                             what, n.size())};
  }
  const auto intrinsics = intrinsics_from_matrix(matrix, what);
  if (!intrinsics) return intrinsics.error();
  const auto lens = LensDistortion::make("", coefficients);
  if (!lens) return Error{fmt::format("{}: {}", what, lens.error().message)};
  Calibration calibration;
  calibration.intrinsics = *intrinsics;
  calibration.lens = *lens;
  return calibration;
}

Result<Calibration> read_calibration(const fs::path& file) {
  if (extension_of(file) == "json") return read_json_calibration(file);
  const auto text = read_file(file);
  if (!text) return text.error();
  if (const auto numbers = parse_number_list(*text)) return calibration_from_numbers(*numbers, file.string());
  const auto of_colmap = parse_colmap_cameras(*text, file.string());
  if (!of_colmap) return of_colmap.error();
  if (*of_colmap) return **of_colmap;
  const auto calibration = calibration_from_text(*text, file.string());
  if (!calibration) return calibration.error();
  if (!*calibration)
    return file_error(file,
                      "holds no intrinsics (expected numbers fx fy cx cy, a camera matrix, or names such as fx: 525)");
  return **calibration;
}

bool complete(Calibration& calibration, const Calibration& other) {
  const auto take = [](auto& value, const auto& of_other) {
    const std::remove_cvref_t<decltype(value)> unknown{};
    if (value == unknown) value = of_other;
    return of_other == unknown || value == of_other;
  };
  return calibration.intrinsics == other.intrinsics && take(calibration.lens, other.lens) &&
         take(calibration.width, other.width) && take(calibration.height, other.height) &&
         take(calibration.metres_per_unit, other.metres_per_unit);
}

Result<Calibration> parse_calibration(std::string_view numbers_or_file, std::string_view option) {
  if (const auto numbers = parse_number_list(numbers_or_file); numbers && !is_file(numbers_or_file))
    return calibration_from_numbers(*numbers, option);
  return read_calibration(numbers_or_file);
}

Result<std::optional<Calibration>> find_calibration(const fs::path& folder, fs::path& source) {
  std::vector<FoundCalibration> found;
  std::optional<Error> error = collect_calibrations(folder, found);
  for (const std::string& name : list_directories(folder))
    if (is_named_for_calibration(to_lower(name)))
      if (auto below = collect_calibrations(folder / name, found); below && !error) error = below;
  if (std::ranges::any_of(found, &FoundCalibration::is_hinted))
    std::erase_if(found, [](const FoundCalibration& f) { return !f.is_hinted; });
  else if (error)
    return *error;
  if (found.empty()) return std::optional<Calibration>();
  std::ranges::stable_sort(found, {}, [](const FoundCalibration& f) { return is_of_color(f) ? 0 : 1; });
  const FoundCalibration& first = found.front();
  Calibration calibration = first.calibration;
  source = first.file;
  for (const FoundCalibration& other : found) {
    if (is_of_color(other) != is_of_color(first)) continue;
    const Calibration before = calibration;
    if (!complete(calibration, other.calibration))
      return file_error(folder, fmt::format("{} and {} hold different intrinsics; choose one by --intrinsics FILE",
                                            first.file.filename().string(), other.file.filename().string()));
    if (calibration != before) source += ", " + other.file.filename().string();
  }
  return std::optional(calibration);
}

Result<void> check_calibration(const Calibration& calibration, int width, int height, std::string_view what) {
  const Intrinsics& k = calibration.intrinsics;
  const bool other_size =
      calibration.width > 0 && calibration.height > 0 && (calibration.width != width || calibration.height != height);
  if (other_size)
    return Error{fmt::format("{}: the intrinsics are for images of {}x{}, but these have {}x{}", what,
                             calibration.width, calibration.height, width, height)};
  // The centre of a camera lies near that of its image; crops shift it, but hardly beyond the border.
  if (k.cx < 0 || k.cy < 0 || k.cx > width || k.cy > height)
    return Error{
        fmt::format("{}: the centre ({}, {}) lies outside the images of {}x{}: these intrinsics are of "
                    "another image size",
                    what, k.cx, k.cy, width, height)};
  return {};
}

}  // namespace resight::io
