// SPDX-License-Identifier: Apache-2.0
#include "resight/io/internal/ply_header.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <optional>

#include "resight/io/internal/text.hpp"

namespace resight::io {
namespace {

std::optional<PlyType> parse_type(std::string_view name) {
  struct Entry {
    std::string_view name;
    PlyType type;
  };
  static constexpr std::array<Entry, 16> kTypes = {{{"char", PlyType::kInt8},
                                                    {"int8", PlyType::kInt8},
                                                    {"uchar", PlyType::kUint8},
                                                    {"uint8", PlyType::kUint8},
                                                    {"short", PlyType::kInt16},
                                                    {"int16", PlyType::kInt16},
                                                    {"ushort", PlyType::kUint16},
                                                    {"uint16", PlyType::kUint16},
                                                    {"int", PlyType::kInt32},
                                                    {"int32", PlyType::kInt32},
                                                    {"uint", PlyType::kUint32},
                                                    {"uint32", PlyType::kUint32},
                                                    {"float", PlyType::kFloat32},
                                                    {"float32", PlyType::kFloat32},
                                                    {"double", PlyType::kFloat64},
                                                    {"float64", PlyType::kFloat64}}};
  const auto it = std::ranges::find(kTypes, name, &Entry::name);
  return it == kTypes.end() ? std::nullopt : std::optional(it->type);
}

std::optional<PlyProperty> parse_property(const std::vector<std::string_view>& words) {
  PlyProperty property;
  if (words.size() == 5 && words[1] == "list") {
    const auto count_type = parse_type(words[2]);
    const auto type = parse_type(words[3]);
    if (!count_type || !type || *count_type == PlyType::kFloat32 || *count_type == PlyType::kFloat64)
      return std::nullopt;
    return PlyProperty{std::string(words[4]), *type, true, *count_type};
  }
  const auto type = words.size() == 3 ? parse_type(words[1]) : std::nullopt;
  if (!type) return std::nullopt;
  property.name = words[2];
  property.type = *type;
  return property;
}

/// Smallest number of bytes per item.
std::size_t min_item_bytes(const PlyElement& element, PlyEncoding encoding) {
  std::size_t bytes = 0;
  for (const PlyProperty& p : element.properties)
    bytes += encoding == PlyEncoding::kAscii ? 2 : size_of(p.is_list ? p.count_type : p.type);
  return bytes;
}

class PlyHeaderParser {
 public:
  explicit PlyHeaderParser(std::string_view name) : name_(name) {}

  Result<PlyHeader> parse(std::string_view bytes) {
    std::string_view rest = bytes;
    if (cut_line(rest) != "ply") return fail("is not a PLY file (the first line must be 'ply')");
    bool ended = false;
    for (int line_number = 2; !rest.empty() && !ended; ++line_number) {
      const std::string_view line = cut_line(rest);
      ended = line == "end_header";
      if (!ended && !parse_line(line))
        return fail(fmt::format("line {} of the PLY header cannot be parsed", line_number));
    }
    if (!ended || !has_format_) return fail("the PLY header has no 'format' or no 'end_header'");
    header_.body_offset = bytes.size() - rest.size();
    return check_counts(rest.size());
  }

 private:
  Error fail(std::string_view what) const { return Error{fmt::format("{}: {}", name_, what)}; }

  bool parse_line(std::string_view line) {
    const auto words = split_tokens(line);
    if (words.empty() || words[0] == "obj_info") return true;
    if (words[0] == "comment") return parse_comment(line, words);
    if (words[0] == "format") return parse_format(words);
    if (words[0] == "element") return parse_element(words);
    if (words[0] != "property" || header_.elements.empty()) return false;
    auto property = parse_property(words);
    if (!property || header_.elements.back().properties.size() >= 1000) return false;
    header_.elements.back().properties.push_back(std::move(*property));
    return true;
  }

  bool parse_comment(std::string_view line, const std::vector<std::string_view>& words) {
    if (words.size() < 3 || words[1] != "TextureFile") return true;
    std::string_view file =
        line.substr(static_cast<std::size_t>(words[2].data() - line.data()));  // names may contain blanks
    while (!file.empty() && (file.back() == ' ' || file.back() == '\t')) file.remove_suffix(1);
    header_.texture_files.emplace_back(file);
    return true;
  }

  bool parse_format(const std::vector<std::string_view>& words) {
    if (words.size() != 3 || has_format_) return false;
    has_format_ = true;
    if (words[1] == "ascii")
      header_.encoding = PlyEncoding::kAscii;
    else if (words[1] == "binary_little_endian")
      header_.encoding = PlyEncoding::kBinaryLittleEndian;
    else if (words[1] == "binary_big_endian")
      header_.encoding = PlyEncoding::kBinaryBigEndian;
    else
      return false;
    return true;
  }

  bool parse_element(const std::vector<std::string_view>& words) {
    const auto count = words.size() == 3 ? parse_integer(words[2]) : std::nullopt;
    if (!count || *count < 0 || header_.elements.size() >= 100) return false;
    header_.elements.push_back({std::string(words[1]), static_cast<std::size_t>(*count), {}});
    return true;
  }

  Result<PlyHeader> check_counts(std::size_t body_bytes) {
    for (const PlyElement& element : header_.elements) {
      const std::size_t item_bytes = min_item_bytes(element, header_.encoding);
      // One more byte, because the last line of a text needs no end.
      if (element.count > 0 && (item_bytes == 0 || element.count > (body_bytes + 1) / item_bytes))
        return fail(fmt::format("claims {} items of '{}', more than the file can hold (cut off?)", element.count,
                                element.name));
      if (element.count > INT32_MAX)
        return fail(fmt::format("{} items of '{}' are too many", element.count, element.name));
    }
    return std::move(header_);
  }

  std::string_view name_;
  PlyHeader header_;
  bool has_format_ = false;
};

template <typename T>
double load(const char* bytes, bool swap) {
  std::array<char, sizeof(T)> raw;
  std::memcpy(raw.data(), bytes, sizeof(T));
  if (swap) std::ranges::reverse(raw);
  T value;
  std::memcpy(&value, raw.data(), sizeof(T));
  return static_cast<double>(value);
}

}  // namespace

int PlyElement::find(std::string_view property) const {
  const auto it = std::ranges::find(properties, property, &PlyProperty::name);
  return it == properties.end() ? -1 : static_cast<int>(it - properties.begin());
}

std::size_t size_of(PlyType type) {
  switch (type) {
    case PlyType::kInt8:
    case PlyType::kUint8:
      return 1;
    case PlyType::kInt16:
    case PlyType::kUint16:
      return 2;
    case PlyType::kInt32:
    case PlyType::kUint32:
    case PlyType::kFloat32:
      return 4;
    case PlyType::kFloat64:
      return 8;
  }
  return 0;
}

Result<PlyHeader> parse_ply_header(std::string_view bytes, std::string_view name) {
  return PlyHeaderParser(name).parse(bytes);
}

bool PlyValueReader::next(PlyType type, double& value) {
  if (encoding_ == PlyEncoding::kAscii) {
    TextCursor cursor(rest_);
    const auto number = cursor.next_number();
    rest_ = cursor.rest();
    value = number.value_or(0);
    return number.has_value();
  }
  const std::size_t size = size_of(type);
  if (rest_.size() < size) return false;
  const bool swap = encoding_ == PlyEncoding::kBinaryBigEndian;
  const char* bytes = rest_.data();
  switch (type) {
    case PlyType::kInt8:
      value = load<std::int8_t>(bytes, swap);
      break;
    case PlyType::kUint8:
      value = load<std::uint8_t>(bytes, swap);
      break;
    case PlyType::kInt16:
      value = load<std::int16_t>(bytes, swap);
      break;
    case PlyType::kUint16:
      value = load<std::uint16_t>(bytes, swap);
      break;
    case PlyType::kInt32:
      value = load<std::int32_t>(bytes, swap);
      break;
    case PlyType::kUint32:
      value = load<std::uint32_t>(bytes, swap);
      break;
    case PlyType::kFloat32:
      value = load<float>(bytes, swap);
      break;
    case PlyType::kFloat64:
      value = load<double>(bytes, swap);
      break;
  }
  rest_.remove_prefix(size);
  return true;
}

}  // namespace resight::io
