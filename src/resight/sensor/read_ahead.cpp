// SPDX-License-Identifier: Apache-2.0
#include "resight/sensor/read_ahead.hpp"

#include <utility>

namespace resight {

Result<RgbdFrame> ReadAhead::read_view(int view) {
  auto found = next_.valid() ? std::exchange(next_, {}) : std::future<Result<RgbdFrame>>();
  Result<RgbdFrame> frame = found.valid() && next_view_ == view ? found.get() : sequence_.read_view(view);
  next_view_ = view + 1;
  if (is_ahead_ && frame.ok() && next_view_ < sequence_.num_views())
    next_ =
        std::async(std::launch::async, [&sequence = sequence_, next = next_view_] { return sequence.read_view(next); });
  return frame;
}

}  // namespace resight
