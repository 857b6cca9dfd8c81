// SPDX-License-Identifier: Apache-2.0
#include "resight/io/internal/obj_parser.hpp"

#include <array>
#include <limits>
#include <map>
#include <set>

#include "resight/io/internal/obj_statements.hpp"
#include "resight/io/internal/polygon.hpp"
#include "resight/io/internal/text.hpp"

namespace resight::io {
namespace {

constexpr std::size_t kMaxNames = 4096;

/// The next number, or zero.
float next_value(TextCursor& cursor) { return static_cast<float>(cursor.next_number().value_or(0)); }

class ObjParser {
 public:
  Result<ObjContent> run(std::string_view lines) {
    ObjStatementReader reader(lines);
    for (ObjStatement statement; reader.next(statement);)
      if (const auto added = add(statement); !added) return added.error();
    if (const auto checked = check_corners(); !checked) return checked.error();
    if (content_.colors.size() != content_.positions.size()) content_.colors.clear();
    return std::move(content_);
  }

 private:
  Result<void> add(const ObjStatement& statement) {
    const std::string& keyword = statement.keyword;
    TextCursor cursor(statement.rest);
    if (keyword == "v") return add_vertex(statement.rest);
    if (keyword == "f") return add_face(statement.rest);
    if (keyword == "vt") {
      const float u = next_value(cursor);
      content_.uvs.emplace_back(u, next_value(cursor));
    } else if (keyword == "vn") {
      const float x = next_value(cursor);
      const float y = next_value(cursor);
      content_.normals.emplace_back(x, y, next_value(cursor));
    } else if (keyword == "usemtl") {
      use_material(std::string(statement.rest));
    } else if (keyword == "mtllib" && libraries_.emplace(statement.rest).second) {
      content_.libraries.emplace_back(statement.rest);
    }
    if (content_.materials.size() > kMaxNames || content_.libraries.size() > kMaxNames)
      return Error{"names more than 4096 materials or libraries of them"};
    return {};
  }

  Result<void> add_vertex(std::string_view rest) {
    std::array<float, 6> values{};
    std::size_t num_values = 0;
    TextCursor cursor(rest);
    while (num_values < values.size()) {
      const auto number = cursor.next_number();
      if (!number) break;
      values[num_values++] = static_cast<float>(*number);
    }
    if (num_values < 3)
      return Error{"holds a vertex without three numbers: 'v " + std::string(rest.substr(0, 80)) + "'"};
    content_.positions.emplace_back(values.data());
    if (!content_.positions.back().allFinite()) return Error{"holds vertices that are not finite"};
    if (num_values == values.size()) content_.colors.emplace_back(values.data() + 3);
    return {};
  }

  /// Faces of one or two corners are left out.
  Result<void> add_face(std::string_view rest) {
    const std::size_t start = content_.corners.size();
    TextCursor cursor(rest.substr(0, rest.find('#')));
    for (std::string_view token = cursor.next(); !token.empty(); token = cursor.next()) {
      const auto corner = parse_corner(token);
      if (!corner) return Error{"holds a face whose corners are not numbers of vertices"};
      if (content_.corners.size() - start == kMaxPolygonCorners) return Error{"has a face of more than 1024 corners"};
      content_.corners.push_back(*corner);
    }
    const auto num_corners = static_cast<int>(content_.corners.size() - start);
    if (num_corners >= 3)
      content_.faces.push_back({num_corners, material_});
    else
      content_.corners.resize(start);
    return {};
  }

  /// position, position/uv, position/uv/normal or position//normal. What stands behind a slash may be missing.
  [[nodiscard]] std::optional<ObjCorner> parse_corner(std::string_view token) const {
    const std::array<std::size_t, 3> sizes{content_.positions.size(), content_.uvs.size(), content_.normals.size()};
    std::array<int, 3> numbers{-1, -1, -1};
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      const std::size_t slash = token.find('/');
      const std::string_view text = token.substr(0, slash);
      if (!text.empty() || i == 0) {
        const auto number = parse_integer(text);
        if (!number || *number == 0) return std::nullopt;
        numbers[i] = index_of(*number, sizes[i]);
      }
      if (slash == token.npos) return ObjCorner{numbers[0], numbers[1], numbers[2]};
      token.remove_prefix(slash + 1);
    }
    return std::nullopt;  // more than two slashes
  }

  /// Counts from one, or from the last one back if negative. What has not come yet may still come.
  static int index_of(std::int64_t number, std::size_t size) {
    const std::int64_t index = number > 0 ? number - 1 : static_cast<std::int64_t>(size) + number;
    return index >= 0 && index <= std::numeric_limits<int>::max() ? static_cast<int>(index) : -1;
  }

  Result<void> check_corners() {
    const auto is_in = [](int index, const auto& list) {
      return index >= 0 && static_cast<std::size_t>(index) < list.size();
    };
    for (ObjCorner& corner : content_.corners) {
      if (!is_in(corner.position, content_.positions)) return Error{"holds a face with a vertex that does not exist"};
      if (!is_in(corner.uv, content_.uvs)) corner.uv = -1;
      if (!is_in(corner.normal, content_.normals)) corner.normal = -1;
    }
    return {};
  }

  void use_material(const std::string& name) {
    const auto [it, is_new] = number_of_material_.try_emplace(name, static_cast<int>(content_.materials.size()));
    if (is_new) content_.materials.push_back({name, {}, {}});
    material_ = it->second;
  }

  ObjContent content_;
  int material_ = -1;
  std::map<std::string, int> number_of_material_;
  std::set<std::string> libraries_;
};

}  // namespace

Result<ObjContent> parse_obj(std::string text) { return ObjParser().run(to_plain_lines(std::move(text))); }

}  // namespace resight::io
