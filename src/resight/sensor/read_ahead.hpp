// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <future>

#include "resight/sensor/sequence.hpp"

namespace resight {

/// Reads the views of a sequence in order: the next one on another thread, while the caller works on this one.
class ReadAhead {
 public:
  /// The sequence must outlive it. With one thread, a view is read when it is asked for.
  ReadAhead(const Sequence& sequence, int num_threads) : sequence_(sequence), is_ahead_(num_threads > 1) {}

  /// Same as Sequence::read_view().
  [[nodiscard]] Result<RgbdFrame> read_view(int view);

 private:
  const Sequence& sequence_;
  bool is_ahead_;
  int next_view_ = -1;
  std::future<Result<RgbdFrame>> next_;  ///< Of next_view_. Its destructor waits.
};

}  // namespace resight
