// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

namespace resight::app {

/// Tells how far long work is, on standard error: a line that is overwritten on a terminal, else one line per item.
class Progress {
 public:
  Progress(std::string what, int num_items);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  /// Item `done` of num_items is finished; `detail` says what came of it.
  void report(int done, const std::string& detail);

 private:
  std::string what_;
  int num_items_;
  bool is_terminal_;
  bool has_open_line_ = false;
};

}  // namespace resight::app
