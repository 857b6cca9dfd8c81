// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <map>

#include "resight/io/internal/obj_parser.hpp"
#include "resight/io/internal/obj_statements.hpp"
#include "resight/io/internal/text.hpp"
#include "resight/io/internal/textured_parts.hpp"

namespace resight::io {
namespace {

/// One number is a grey. Other values than numbers, such as a spectrum, are no colour.
std::optional<Rgb8> parse_color(std::string_view value) {
  TextCursor cursor(value);
  const auto r = cursor.next_number();
  if (!r) return std::nullopt;
  const double g = cursor.next_number().value_or(*r);
  const double b = cursor.next_number().value_or(*r);
  return to_color(static_cast<float>(*r), static_cast<float>(g), static_cast<float>(b));
}

/// The name of the file, which may stand behind options and hold blanks.
std::string_view parse_texture_name(std::string_view value) {
  static const std::map<std::string_view, int> kMaxValues = {
      {"-blendu", 1},  {"-blendv", 1}, {"-bm", 1}, {"-boost", 1}, {"-cc", 1}, {"-clamp", 1},  {"-colorspace", 1},
      {"-imfchan", 1}, {"-mm", 2},     {"-o", 3},  {"-s", 3},     {"-t", 3},  {"-texres", 1}, {"-type", 1}};
  TextCursor cursor(value);
  for (TextCursor ahead = cursor;; cursor = ahead) {
    const auto option = kMaxValues.find(ahead.next());
    if (option == kMaxValues.end()) {
      const std::string_view name = cursor.rest();
      return name.substr(std::min(name.find_first_not_of(" \t"), name.size()));
    }
    (void)ahead.next();
    for (int i = 1; i < option->second; ++i)
      if (TextCursor number = ahead; number.next_number()) ahead = number;
  }
}

}  // namespace

void define_materials(std::span<const std::shared_ptr<const std::string>> libraries,
                      std::vector<ObjMaterial>& materials) {
  std::map<std::string_view, ObjMaterial*> used;
  for (ObjMaterial& material : materials) used[material.name] = &material;
  for (const auto& library : libraries) {
    const std::string lines = to_plain_lines(*library);
    ObjStatementReader reader(lines);
    ObjMaterial* material = nullptr;  // null: before the first one, or one that is not used
    for (ObjStatement statement; reader.next(statement);) {
      if (statement.keyword == "newmtl") {
        const auto it = used.find(statement.rest);
        material = it == used.end() ? nullptr : it->second;
      }
      if (material == nullptr) continue;
      if (statement.keyword == "kd") material->color = parse_color(statement.rest);
      if (statement.keyword == "map_kd") material->texture = parse_texture_name(statement.rest);
    }
  }
}

}  // namespace resight::io
