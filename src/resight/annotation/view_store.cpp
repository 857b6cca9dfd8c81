// SPDX-License-Identifier: Apache-2.0
#include "resight/annotation/view_store.hpp"

#include <algorithm>
#include <stdexcept>

namespace resight {
namespace {

constexpr std::size_t kMaxKeptViews = 64;
constexpr std::size_t kMaxKeptPixels = std::size_t{400} << 17;  // 8 bytes each

}  // namespace

Result<ViewStore::View> ViewStore::get(int view) {
  if (view < 0 || view >= num_views()) throw std::out_of_range("ViewStore::get: there is no such view");
  const auto known = std::ranges::find(views_, view, &std::pair<int, View>::first);
  if (known != views_.end()) {
    std::rotate(views_.begin(), known, known + 1);
    return views_.front().second;
  }
  auto frame = sequence_->read_view(view);
  if (!frame) return frame.error();
  views_.emplace_front(view, std::make_shared<const RgbdFrame>(*std::move(frame)));
  const std::size_t fitting = kMaxKeptPixels / std::max<std::size_t>(1, views_.front().second->depth_m.size());
  while (views_.size() > std::clamp<std::size_t>(fitting, 1, kMaxKeptViews)) views_.pop_back();
  return views_.front().second;
}

}  // namespace resight
