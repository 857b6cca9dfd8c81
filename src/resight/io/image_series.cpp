// SPDX-License-Identifier: Apache-2.0
#include "resight/io/internal/image_series.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "resight/io/internal/depth_arrays.hpp"
#include "resight/io/internal/files.hpp"
#include "resight/io/internal/text.hpp"
#include "resight/io/internal/time_pairs.hpp"
#include "resight/io/internal/trajectory_file.hpp"

namespace resight::io {
namespace {

bool is_digit_char(char c) { return c >= '0' && c <= '9'; }

bool has_any(std::string_view text, std::initializer_list<std::string_view> words) {
  return std::ranges::any_of(words, [&](std::string_view word) { return text.find(word) != text.npos; });
}

/// Whether the letters of one of the words stand alone: "ir" in "left_ir_01", but not in "chair_01".
bool has_whole_word(std::string_view lower_text, std::initializer_list<std::string_view> words) {
  const auto is_letter = [](char c) { return c >= 'a' && c <= 'z'; };
  for (auto at = lower_text.begin(); at != lower_text.end();) {
    const auto begin = std::find_if(at, lower_text.end(), is_letter);
    at = std::find_if_not(begin, lower_text.end(), is_letter);
    if (std::ranges::find(words, std::string_view(begin, at)) != words.end()) return true;
  }
  return false;
}

/// Names of labels, masks and pictures of results, which are not views.
bool is_no_view(std::string_view lower_name) {
  return has_any(lower_name, {"mask", "label", "segment", "instance", "semantic", "normal", "confidence", "overlay",
                              "infra", "dispar", "amplitude", "preview", "visual"}) ||
         has_whole_word(lower_name, {"seg", "class", "classes", "conf", "ir", "vis"});
}

bool is_view_folder(std::string_view lower_name) {
  return has_any(lower_name,
                 {"rgb", "color", "colour", "depth", "image", "img", "pose", "camera", "frame", "result", "raw"}) ||
         lower_name.starts_with("cam") || lower_name == "data" || lower_name == "views";
}

/// The runs of digits of a name, with their places.
struct DigitRuns {
  std::string pattern;
  std::vector<std::string> digits;
  std::vector<std::size_t> ends;  ///< In the name, behind each run.
};

DigitRuns split_digits(std::string_view name) {
  DigitRuns runs;
  for (std::size_t i = 0; i < name.size();) {
    if (!is_digit_char(name[i])) {
      runs.pattern += name[i++];
      continue;
    }
    std::size_t end = i;
    while (end < name.size() && is_digit_char(name[end])) ++end;
    runs.pattern += '#';
    runs.digits.emplace_back(name.substr(i, end - i));
    runs.ends.push_back(end);
    i = end;
  }
  return runs;
}

std::string without_zeros(std::string_view digits) {
  const std::size_t begin = std::min(digits.find_first_not_of('0'), digits.size() - 1);
  return std::string(digits.substr(begin));
}

/// The time that a name such as 1305031102.175304 (seconds), 1305031102175.304 (milliseconds) or 1305031102175304000
/// (nanoseconds) tells.
double time_of_digits(const std::vector<std::string>& digits) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  if (digits.size() == 2 && digits[0].size() >= 9 && digits[0].size() <= 11)
    return parse_number(digits[0] + "." + digits[1]).value_or(kNone);
  if (digits.size() == 2 && digits[0].size() == 13)
    return parse_number(digits[0] + "." + digits[1]).value_or(kNone) * 1e-3;
  if (digits.size() != 1) return kNone;
  const double number = parse_number(digits[0]).value_or(kNone);
  if (digits[0].size() == 19) return number * 1e-9;
  if (digits[0].size() == 16) return number * 1e-6;
  return digits[0].size() == 13 ? number * 1e-3 : kNone;
}

/// Files whose name says depth, in formats that are not read: for messages.
bool is_unread_depth(const std::string& pattern) {
  const std::string extension = extension_of(pattern);
  return extension == "png" || extension == "tiff" || extension == "tif";
}

/// By the first bytes: 16-bit PNG with one channel is depth, other images are colour.
SeriesKind kind_of_image(const fs::path& file, const std::string& lower_name) {
  const std::string extension = extension_of(file);
  if (holds_depth_array(extension)) return has_any(lower_name, {"pose"}) ? SeriesKind::kOther : SeriesKind::kDepth;
  if (extension == "jpg" || extension == "jpeg") return SeriesKind::kColor;
  if (extension == "txt") return has_any(lower_name, {"pose", "extrinsic"}) ? SeriesKind::kPose : SeriesKind::kOther;
  // A camera per view, if its content agrees.
  if (extension == "json")
    return has_any(lower_name, {"pose", "camera", "frame"}) ? SeriesKind::kPose : SeriesKind::kOther;
  if (extension != "png") return SeriesKind::kOther;
  const auto start = read_file_start(file, 33);
  if (!start || start->size() < 33 || !start->starts_with("\x89PNG")) return SeriesKind::kOther;
  const int bits = static_cast<unsigned char>((*start)[24]);
  const int color_type = static_cast<unsigned char>((*start)[25]);
  if (bits == 16 && color_type == 0) return SeriesKind::kDepth;
  return has_any(lower_name, {"depth"}) ? SeriesKind::kOther : SeriesKind::kColor;
}

/// What tells views apart whose names have no number: "apple" of apple_rgb.png.
std::string bare_stem(const std::string& name) {
  std::string stem = to_lower(fs::path(name).stem().string());
  for (const std::string_view word :
       {"aligned", "registered", "to_color", "colour", "color", "rgb", "depth", "image", "img"})
    if (const std::size_t at = stem.find(word); at != stem.npos) stem.erase(at, word.size());
  std::erase_if(stem, [](char c) { return c == '_' || c == '-' || c == '.' || c == ' '; });
  return stem;
}

/// For names without numbers: what the pattern of their series says beside the extension.
std::string series_word(std::string_view lower_name) {
  if (has_any(lower_name, {"aligned", "registered", "to_color"})) return "*registered_depth*";
  if (has_any(lower_name, {"depth"})) return "*depth*";
  return has_any(lower_name, {"color", "colour", "rgb"}) ? "*color*" : "*";
}

/// Of a single file: all numbers of a time, otherwise the last one, or a longer one with leading zeros, which counts
/// images. Its name and partner stay if others follow.
std::vector<bool> guess_key_runs(const DigitRuns& runs) {
  std::vector<bool> is_key(runs.digits.size(), !std::isnan(time_of_digits(runs.digits)));
  if (is_key.empty()) return is_key;
  std::size_t best = is_key.size() - 1;
  for (std::size_t i = 0; i < is_key.size(); ++i)
    if (runs.digits[i].starts_with('0') && runs.digits[i].size() > runs.digits[best].size()) best = i;
  is_key[best] = true;
  return is_key;
}

/// Whether the names hold a decimal fraction, as times do.
bool is_decimal(std::string_view pattern) { return pattern.find("#.#") != pattern.npos; }

/// Whether the names are times whose order is theirs: numbers, with a decimal fraction or without.
bool tells_times(const FileSeries& series) {
  const bool is_number = is_decimal(series.pattern) || series.pattern.find('#') == series.pattern.rfind('#');
  return is_number &&
         std::ranges::none_of(series.files, [](const auto& file) { return std::isnan(file.second.time_s); });
}

/// Removes the numbers that are the same in all names, such as those of "color_640x480".
void set_keys(FileSeries& series, const std::vector<std::string>& names) {
  const DigitRuns first = split_digits(names.front());
  std::vector<bool> differs = names.size() == 1 ? guess_key_runs(first) : std::vector<bool>(first.digits.size(), false);
  for (const std::string& name : names) {
    const DigitRuns runs = split_digits(name);
    for (std::size_t i = 0; i < runs.digits.size(); ++i)
      if (runs.digits[i] != first.digits[i]) differs[i] = true;
  }
  for (const std::string& name : names) {
    const DigitRuns runs = split_digits(name);
    std::string key;
    std::vector<std::string> digits;
    std::size_t end = 0;
    for (std::size_t i = 0; i < runs.digits.size(); ++i) {
      if (!differs[i]) continue;
      if (!key.empty()) key += '.';
      // A fraction keeps its zeros: .05 is not .5.
      key += i > 0 && is_decimal(series.pattern) ? runs.digits[i] : without_zeros(runs.digits[i]);
      digits.push_back(runs.digits[i]);
      end = runs.ends[i];
    }
    if (runs.digits.empty()) key = bare_stem(name);
    const std::string stem = fs::path(name).stem().string();
    const std::string shown = end == 0 || end > stem.size() ? stem : name.substr(0, end);
    // Two seconds with one fraction: all runs belong to the time, although the first may be the same in all names.
    series.files.emplace(key, SeriesFile{series.folder / name, shown, time_of_digits(runs.digits)});
  }
}

/// `says_what`: the name of the folder says what its files are. That of the sequence may be any.
void add_series(const fs::path& folder, bool says_what, std::vector<FileSeries>& all) {
  const std::string prefix = says_what ? to_lower(folder_name(folder)) + "/" : "";
  const auto kind_of = [&](const std::string& name) { return kind_of_image(folder / name, prefix + to_lower(name)); };
  std::map<std::pair<std::string, SeriesKind>, std::vector<std::string>> names;  // Numbered names have no kind yet.
  for (const std::string& name : list_files(folder)) {
    std::string pattern = split_digits(name).pattern;
    SeriesKind kind = SeriesKind::kOther;
    if (pattern.find('#') == pattern.npos && !is_no_view(to_lower(name))) {
      kind = kind_of(name);
      if (kind == SeriesKind::kColor || kind == SeriesKind::kDepth)
        pattern = series_word(to_lower(name)) + "." + extension_of(name);
    }
    names[{pattern, kind}].push_back(name);
  }
  for (const auto& [key, of_pattern] : names) {
    const std::string& pattern = key.first;
    FileSeries series;
    series.folder = folder;
    series.pattern = pattern;
    series.kind = kind_of(of_pattern.front());
    if (series.kind == SeriesKind::kOther && !is_unread_depth(pattern)) continue;
    if (is_no_view(to_lower(pattern))) continue;
    set_keys(series, of_pattern);
    all.push_back(std::move(series));
  }
}

std::vector<ImagePair> pair_by_key(const FileSeries& color, const FileSeries& depth) {
  std::vector<ImagePair> pairs;
  for (const auto& [key, file] : color.files)
    if (const auto it = depth.files.find(key); it != depth.files.end()) pairs.push_back({file, it->second, key});
  return pairs;
}

std::vector<double> times_of(const FileSeries& series) {
  std::vector<double> times_s;
  for (const auto& [key, file] : series.files) times_s.push_back(file.time_s);
  return times_s;
}

std::vector<ImagePair> pair_series_by_time(const FileSeries& color, const FileSeries& depth) {
  const std::vector<std::pair<std::string, SeriesFile>> colors(color.files.begin(), color.files.end());
  const std::vector<std::pair<std::string, SeriesFile>> depths(depth.files.begin(), depth.files.end());
  std::vector<ImagePair> pairs;
  for (const TimePair& pair : pair_by_time(times_of(color), times_of(depth), kMaxImageGap_s))
    pairs.push_back({colors[pair.color].second, depths[pair.depth].second, colors[pair.color].first});
  return pairs;
}

/// How well names say what the files are. Float depth has a known unit and is preferred.
int rank_of(const FileSeries& series) {
  const std::string name = to_lower(folder_name(series.folder) + "/" + series.pattern);
  if (series.kind == SeriesKind::kColor) return has_any(name, {"color", "colour", "rgb"}) ? 2 : 1;
  const bool registered = has_any(name, {"aligned", "registered", "to_color"});
  return (has_any(name, {"depth"}) ? 2 : 0) + (registered ? 2 : 0) +
         (holds_depth_array(extension_of(series.pattern)) ? 1 : 0);
}

bool holds_kind(const std::vector<FileSeries>& all, SeriesKind kind) {
  return std::ranges::any_of(all, [&](const FileSeries& series) { return series.kind == kind; });
}

std::vector<ImagePair> find_pairs(const FileSeries& color, const FileSeries& depth) {
  std::vector<ImagePair> pairs;
  if (!tells_times(color) || !tells_times(depth)) pairs = pair_by_key(color, depth);
  return pairs.empty() ? pair_series_by_time(color, depth) : pairs;
}

struct RankedSeries {
  const FileSeries* series;
  int rank;
};

std::vector<RankedSeries> rank_kind(const std::vector<FileSeries>& all, SeriesKind kind) {
  std::vector<RankedSeries> ranked;
  for (const FileSeries& series : all)
    if (series.kind == kind) ranked.push_back({&series, rank_of(series)});
  return ranked;
}

struct Candidate {
  const FileSeries* color = nullptr;
  const FileSeries* depth = nullptr;
  int rank = 0;
  std::size_t num_pairs = 0;
};

bool is_better(const Candidate& a, const Candidate& b) {
  return a.rank != b.rank ? a.rank > b.rank : a.num_pairs > b.num_pairs;
}

}  // namespace

std::string FileSeries::label() const {
  std::string shown = pattern;
  std::ranges::replace(shown, '#', '*');
  return folder_name(folder) + "/" + shown;
}

std::vector<FileSeries> find_series(const fs::path& folder) {
  std::vector<FileSeries> all;
  add_series(folder, false, all);
  for (const std::string& name : list_directories(folder))
    if (is_view_folder(to_lower(name)) && !is_no_view(to_lower(name))) add_series(folder / name, true, all);
  // Beside named images, images of any other folder would be a guess: infrared has 16 bits, too.
  if (holds_kind(all, SeriesKind::kColor) || holds_kind(all, SeriesKind::kDepth)) return all;
  for (const std::string& name : list_directories(folder)) {
    if (is_view_folder(to_lower(name)) || is_no_view(to_lower(name))) continue;
    std::vector<FileSeries> of_folder;
    add_series(folder / name, true, of_folder);
    // A folder that holds both is a sequence of its own.
    if (holds_kind(of_folder, SeriesKind::kColor) == holds_kind(of_folder, SeriesKind::kDepth)) continue;
    std::ranges::move(of_folder, std::back_inserter(all));
  }
  return all;
}

Result<std::optional<PairedSeries>> pair_series(const std::vector<FileSeries>& all, const fs::path& folder) {
  constexpr std::size_t kMaxCandidates = 100'000;
  const std::vector<RankedSeries> colors = rank_kind(all, SeriesKind::kColor);
  const std::vector<RankedSeries> depths = rank_kind(all, SeriesKind::kDepth);
  if (colors.size() * depths.size() > kMaxCandidates)
    return file_error(folder,
                      fmt::format("holds too many series of images ({} of colour and {} of depth); names of one "
                                  "series differ in their numbers only",
                                  colors.size(), depths.size()));
  Candidate best;
  std::optional<Candidate> equal;
  for (const RankedSeries& color : colors)
    for (const RankedSeries& depth : depths) {
      const Candidate candidate{color.series, depth.series, color.rank + 10 * depth.rank,
                                find_pairs(*color.series, *depth.series).size()};
      if (candidate.num_pairs == 0) continue;
      if (best.num_pairs == 0 || is_better(candidate, best)) {
        best = candidate;
        equal.reset();
      } else if (!equal && !is_better(best, candidate)) {
        equal = candidate;
      }
    }
  if (best.num_pairs == 0) return std::optional<PairedSeries>();
  if (equal)
    return file_error(
        folder, fmt::format("holds several series of views: {} with {}, and {} with {}; give one of them a folder of "
                            "its own",
                            best.color->label(), best.depth->label(), equal->color->label(), equal->depth->label()));
  PairedSeries paired{*best.color, *best.depth, find_pairs(*best.color, *best.depth)};
  std::ranges::sort(paired.pairs, [](const ImagePair& a, const ImagePair& b) {
    return natural_less(a.color.file.filename().string(), b.color.file.filename().string());
  });
  if (tells_times(paired.color))
    std::ranges::stable_sort(paired.pairs, {}, [](const ImagePair& pair) { return pair.color.time_s; });
  return std::optional(std::move(paired));
}

std::string describe_images(const std::vector<FileSeries>& all) {
  std::size_t num_color = 0;
  std::size_t num_depth = 0;
  for (const FileSeries& series : all) {
    if (series.kind == SeriesKind::kColor) num_color += series.files.size();
    if (series.kind == SeriesKind::kDepth) num_depth += series.files.size();
  }
  for (const FileSeries& series : all) {
    const bool is_depth = to_lower(series.label()).find("depth") != std::string::npos;
    if (num_depth > 0 || !is_depth || series.kind != SeriesKind::kOther) continue;
    const std::string extension = extension_of(series.pattern);
    const std::string why = extension == "png" ? "8-bit or colour images (pictures of depth, no depth)"
                                               : "." + extension + " files, which are not read (convert them)";
    return fmt::format("found {} colour images, but {} are {}; expected 16-bit PNG, npy, npz or exr", num_color,
                       series.label(), why);
  }
  if (num_color == 0 && num_depth == 0) return "";
  if (num_color > 0 && num_depth > 0)
    return fmt::format(
        "found {} colour and {} depth images whose names have no number in common (1.jpg and 1.png, or NAME_color.jpg "
        "and NAME_depth.png, are a view)",
        num_color, num_depth);
  return num_color > 0 ? fmt::format("found {} colour images, but no depth (16-bit PNG, npy, npz or exr)", num_color)
                       : fmt::format("found {} depth images, but no colour (JPEG or 8-bit PNG)", num_depth);
}

}  // namespace resight::io
