// SPDX-License-Identifier: Apache-2.0
#include "resight/io/follow_sequence.hpp"

#include <fmt/format.h>

#include <utility>

#include "resight/core/files.hpp"

namespace resight {
namespace {

FollowedView make_followed(const Sequence& sequence, int view, RgbdFrame frame) {
  return {
      .frame = std::move(frame), .number = view, .scene_id = sequence.scene_id(), .image_id = sequence.image_id(view)};
}

}  // namespace

SequenceFollower::SequenceFollower(std::filesystem::path folder, OpenSequenceOptions open,
                                   FollowSequenceOptions options)
    : folder_(std::move(folder)), open_(std::move(open)), options_(options) {}

std::optional<FollowedView> SequenceFollower::poll() {
  const auto sequence = open_posed_sequence(folder_, open_);
  if (!sequence.ok()) {
    why_none_ = sequence.error().message;
    return std::nullopt;
  }
  // A single view needs no pose elsewhere, but here others may come, and its pose may be on its way.
  if (!(*sequence)->has_poses()) {
    why_none_ = file_error(folder_, "holds no camera pose (give --poses fixed if the camera stands still)").message;
    return std::nullopt;
  }
  notes_ = (*sequence)->notes();
  std::vector<int> fresh;
  for (int v = 0; v < (*sequence)->num_views(); ++v)
    if (!done_.contains((*sequence)->view_name(v))) fresh.push_back(v);
  why_none_ = fmt::format("{}: no new view", folder_.string());
  return options_.skips_late ? take_newest(**sequence, fresh) : take_next(**sequence, fresh);
}

std::optional<FollowedView> SequenceFollower::take_newest(const Sequence& sequence, const std::vector<int>& fresh) {
  for (auto it = fresh.rbegin(); it != fresh.rend(); ++it) {
    auto frame = sequence.read_view(*it);
    if (!frame.ok()) {
      why_none_ = frame.error().message;
      continue;
    }
    for (auto older = it; older != fresh.rend(); ++older) done_.insert(sequence.view_name(*older));
    num_skipped_ += static_cast<int>(fresh.rend() - it) - 1;
    return make_followed(sequence, *it, std::move(frame).value());
  }
  return std::nullopt;
}

std::optional<FollowedView> SequenceFollower::take_next(const Sequence& sequence, const std::vector<int>& fresh) {
  for (const int view : fresh) {
    const std::string name = sequence.view_name(view);
    auto frame = sequence.read_view(view);
    if (frame.ok()) {
      done_.insert(name);
      return make_followed(sequence, view, std::move(frame).value());
    }
    why_none_ = frame.error().message;
    if (view == fresh.back() || ++tries_[name] < options_.max_tries) return std::nullopt;
    done_.insert(name);
    left_out_.push_back(why_none_);
  }
  return std::nullopt;
}

std::vector<std::string> SequenceFollower::take_left_out() { return std::exchange(left_out_, {}); }

}  // namespace resight
