// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <deque>
#include <memory>
#include <utility>

#include "resight/sensor/sequence.hpp"

namespace resight {

/// Reads the views of a sequence and keeps those used last, up to 64 of them and 400 MB.
class ViewStore {
 public:
  using View = std::shared_ptr<const RgbdFrame>;
  explicit ViewStore(std::shared_ptr<const Sequence> sequence) : sequence_(std::move(sequence)) {}
  [[nodiscard]] const Sequence& sequence() const { return *sequence_; }
  [[nodiscard]] int num_views() const { return sequence_->num_views(); }
  /// Fails if the view cannot be read. Throws std::out_of_range for a view that does not exist.
  [[nodiscard]] Result<View> get(int view);

 private:
  std::shared_ptr<const Sequence> sequence_;
  std::deque<std::pair<int, View>> views_;  ///< The one used last comes first.
};

}  // namespace resight
