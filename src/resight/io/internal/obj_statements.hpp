// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>

namespace resight::io {

/// Removes the byte order mark, which would hide the first statement. Lines then end with LF, and other control
/// characters are blanks.
[[nodiscard]] std::string to_plain_lines(std::string text);

struct ObjStatement {
  std::string keyword;    ///< In lower case.
  std::string_view rest;  ///< Without blanks around it.
};

/// The statements of an OBJ file or a material library. One that ends with a backslash goes on in the next line.
class ObjStatementReader {
 public:
  /// `lines`: from to_plain_lines(); must outlive it.
  explicit ObjStatementReader(std::string_view lines) : lines_(lines) {}

  /// False at the end. A statement is valid until the next call.
  bool next(ObjStatement& statement);

 private:
  [[nodiscard]] std::string_view join(std::string_view line);

  std::string_view lines_;
  std::string joined_;
};

}  // namespace resight::io
