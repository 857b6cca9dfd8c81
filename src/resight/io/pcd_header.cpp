// SPDX-License-Identifier: Apache-2.0
#include "resight/io/internal/pcd_header.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "resight/core/printable.hpp"
#include "resight/io/internal/files.hpp"
#include "resight/io/internal/text.hpp"
#include "resight/io/pose_text.hpp"

namespace resight::io {
namespace {

constexpr std::size_t kMaxFields = 1000;
constexpr int kMaxValues = 4096;  ///< Of a point. The longest descriptors have about 2000.
constexpr std::size_t kHeaderBytes = 65536;

class PcdHeaderParser {
 public:
  explicit PcdHeaderParser(std::string_view name) : name_(name) {}

  Result<PcdHeader> parse(std::string_view bytes) {
    std::string_view rest = bytes;
    while (!rest.empty()) {
      const std::string_view line = cut_line(rest);
      const auto words = split_tokens(line);
      if (words.empty()) continue;
      if (words[0].starts_with('#')) {
        parse_comment(words);
        continue;
      }
      if (const auto done = parse_entry(words); !done) return done.error();
      if (words[0] == "DATA") {
        header_.body_offset = bytes.size() - rest.size();
        return finish();
      }
    }
    return fail("is not a PCD file (its header has no DATA line)");
  }

 private:
  Error fail(std::string_view what) const { return Error{fmt::format("{}: {}", name_, what)}; }
  Error wrong(std::string_view entry, std::string_view expected) const {
    return fail(fmt::format("{} of the PCD header is wrong (expected {})", entry, expected));
  }

  /// Parses "# camera fx fy cx cy"; ignores the rest of the line.
  void parse_comment(const std::vector<std::string_view>& words) {
    if (words.size() < 6 || words[0] != "#" || words[1] != "camera") return;
    std::vector<double> numbers;
    for (std::size_t i = 2; i < words.size(); ++i) numbers.push_back(parse_number(words[i]).value_or(0));
    header_.camera = Camera{1, 1, numbers[0], numbers[1], numbers[2], numbers[3]};
    if (!header_.camera->is_valid()) header_.camera.reset();
  }

  Result<void> parse_entry(const std::vector<std::string_view>& words) {
    const std::string_view key = words[0];
    if (key == "FIELDS" || key == "COLUMNS") return parse_names(words);
    if (key == "SIZE" || key == "TYPE" || key == "COUNT") return parse_per_field(words);
    if (key == "VIEWPOINT") return parse_viewpoint(words);
    if (key == "WIDTH") return parse_size(words, width_);
    if (key == "HEIGHT") return parse_size(words, height_);
    if (key == "POINTS") return parse_size(words, points_);
    if (key == "DATA") return parse_encoding(words);
    if (key == "VERSION") return {};
    return fail(fmt::format("is not a PCD file (unknown header line starting with '{:.20}')", printable(key)));
  }

  Result<void> parse_names(const std::vector<std::string_view>& words) {
    if (words.size() < 2 || words.size() > kMaxFields || !header_.fields.empty())
      return wrong("FIELDS", "one line of names");
    for (std::size_t i = 1; i < words.size(); ++i) header_.fields.push_back({.name = std::string(words[i])});
    return {};
  }

  Result<void> parse_per_field(const std::vector<std::string_view>& words) {
    if (header_.fields.empty() || words.size() != header_.fields.size() + 1)
      return wrong(words[0], "one entry for each of FIELDS");
    for (std::size_t i = 0; i < header_.fields.size(); ++i) {
      PcdField& field = header_.fields[i];
      const std::string_view word = words[i + 1];
      if (words[0] == "TYPE") {
        if (word != "F" && word != "I" && word != "U") return wrong("TYPE", "F, I or U");
        field.type = word[0];
        continue;
      }
      const auto number = parse_integer(word);
      if (words[0] == "COUNT") {
        if (!number || *number < 1 || *number > kMaxValues) return wrong("COUNT", fmt::format("1 to {}", kMaxValues));
        field.count = static_cast<int>(*number);
      } else {
        if (!number || (*number != 1 && *number != 2 && *number != 4 && *number != 8))
          return wrong("SIZE", "1, 2, 4 or 8");
        field.size = static_cast<int>(*number);
      }
    }
    return {};
  }

  Result<void> parse_viewpoint(const std::vector<std::string_view>& words) {
    std::array<double, 7> n{};
    for (std::size_t i = 0; i < n.size(); ++i) {
      const auto number = words.size() == 8 ? parse_number(words[i + 1]) : std::nullopt;
      if (!number) return wrong("VIEWPOINT", "tx ty tz qw qx qy qz");
      n[i] = *number;
    }
    const auto pose =
        rigid_from_quaternion({n[3], n[4], n[5], n[6]}, {n[0], n[1], n[2]}, fmt::format("{}: VIEWPOINT", name_));
    if (!pose) return pose.error();
    header_.viewpoint = *pose;
    return {};
  }

  Result<void> parse_size(const std::vector<std::string_view>& words, std::optional<std::int64_t>& size) const {
    size = words.size() == 2 ? parse_integer(words[1]) : std::nullopt;
    if (!size || *size < 0 || *size > INT32_MAX)
      return wrong(words[0], fmt::format("a whole number up to {}", INT32_MAX));
    return {};
  }

  Result<void> parse_encoding(const std::vector<std::string_view>& words) {
    const std::string_view word = words.size() == 2 ? words[1] : "";
    if (word == "ascii")
      header_.encoding = PcdEncoding::kAscii;
    else if (word == "binary")
      header_.encoding = PcdEncoding::kBinary;
    else if (word == "binary_compressed")
      header_.encoding = PcdEncoding::kBinaryCompressed;
    else
      return wrong("DATA", "ascii, binary or binary_compressed");
    return {};
  }

  Result<PcdHeader> finish() {
    if (header_.fields.empty()) return fail("the PCD header has no FIELDS");
    if (!width_ && points_) width_ = points_;  // old files have POINTS only
    if (!width_) return fail("the PCD header has no WIDTH");
    header_.width = static_cast<int>(*width_);
    header_.height = static_cast<int>(height_.value_or(1));
    const std::size_t num_points = header_.num_points();
    if (points_ && static_cast<std::size_t>(*points_) != num_points)
      return fail(fmt::format("the PCD header says {} POINTS, but WIDTH x HEIGHT is {} x {}", *points_, header_.width,
                              header_.height));
    for (PcdField& field : header_.fields) {
      if (field.type == 'F' && field.size < 4) return wrong("SIZE", "4 or 8 for TYPE F");
      field.offset = header_.point_bytes;
      field.column = header_.values_per_point;
      header_.point_bytes += field.bytes();
      header_.values_per_point += static_cast<std::size_t>(field.count);
    }
    if (header_.values_per_point > kMaxValues) return wrong("COUNT", fmt::format("at most {} in all", kMaxValues));
    if (header_.camera) {
      header_.camera->width = header_.width;
      header_.camera->height = header_.height;
    }
    return std::move(header_);
  }

  std::string_view name_;
  PcdHeader header_;
  std::optional<std::int64_t> width_, height_, points_;
};

}  // namespace

const PcdField* PcdHeader::find(std::string_view name) const {
  const auto it = std::ranges::find(fields, name, &PcdField::name);
  return it == fields.end() ? nullptr : &*it;
}

Result<PcdHeader> parse_pcd_header(std::string_view bytes, std::string_view name) {
  return PcdHeaderParser(name).parse(bytes);
}

Result<PcdHeader> read_pcd_header(const std::filesystem::path& file) {
  const auto bytes = read_file_start(file, kHeaderBytes);
  if (!bytes) return bytes.error();
  return parse_pcd_header(*bytes, file.string());
}

}  // namespace resight::io
