// SPDX-License-Identifier: Apache-2.0
#include "resight/io/internal/obj_statements.hpp"

#include <algorithm>

#include "resight/io/internal/text.hpp"

namespace resight::io {
namespace {

bool is_blank(char c) { return c == ' ' || c == '\t'; }

std::string_view trim_blanks(std::string_view text) {
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

}  // namespace

std::string to_plain_lines(std::string text) {
  if (text.starts_with("\xEF\xBB\xBF")) text.erase(0, 3);
  std::size_t size = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    const bool is_control = static_cast<unsigned char>(c) < ' ' && c != '\n' && c != '\t';
    if (c == '\r' && i + 1 < text.size() && text[i + 1] == '\n') continue;
    text[size++] = c == '\r' ? '\n' : is_control ? ' ' : c;
  }
  text.resize(size);
  return text;
}

bool ObjStatementReader::next(ObjStatement& statement) {
  if (lines_.empty()) return false;
  std::string_view line = trim_blanks(cut_line(lines_));
  if (line.ends_with('\\') && !line.starts_with('#')) line = join(line);
  const std::size_t end = std::min(line.find_first_of(" \t"), line.size());
  statement.keyword = to_lower(line.substr(0, end));
  statement.rest = trim_blanks(line.substr(end));
  return true;
}

std::string_view ObjStatementReader::join(std::string_view line) {
  joined_.clear();
  while (line.ends_with('\\')) {
    joined_ += line.substr(0, line.size() - 1);
    joined_ += ' ';
    line = cut_line(lines_);
  }
  joined_ += line;
  return trim_blanks(joined_);
}

}  // namespace resight::io
