// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

namespace resight::app {

/// Reports progress on standard error: a line that is overwritten on a terminal, otherwise one line per item.
class Progress {
 public:
  Progress(const std::string& what, int num_items);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  /// Reports that item `done` of num_items is finished; `detail` describes its result. num_items 0: unknown.
  void report(int done, const std::string& detail);

 private:
  std::string what_;
  int num_items_;
  bool is_terminal_;
  bool has_open_line_ = false;
};

}  // namespace resight::app
