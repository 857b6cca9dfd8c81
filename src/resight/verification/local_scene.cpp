// SPDX-License-Identifier: Apache-2.0
#include "resight/verification/local_scene.hpp"

#include <algorithm>

namespace resight {
namespace {

constexpr float kMaxBlocksPerAxis = 128;  // A huge model gets coarser cells, never a huge grid.

}  // namespace

LocalScene::LocalScene(std::span<const Eigen::Vector3f> scene, const BlockGrid& blocks,
                       std::span<const Eigen::Vector3f> around, float margin_m, float cell_m) {
  begin_.assign(2, 0);
  if (around.empty()) return;
  min_ = around.front();
  Eigen::Vector3f max = around.front();
  for (const Eigen::Vector3f& p : around) {
    min_ = min_.cwiseMin(p);
    max = max.cwiseMax(p);
  }
  min_.array() -= margin_m;
  max.array() += margin_m;
  const Eigen::Vector3f size = max - min_;
  inverse_cell_ = 1 / std::max(cell_m, size.maxCoeff() / kMaxBlocksPerAxis);
  dims_ = (size * inverse_cell_).cast<int>() + Eigen::Vector3i::Ones();

  std::vector<int> found;
  blocks.find_in_box(scene, min_, max, found);
  const auto flat_cell = [&](int i) {
    const Eigen::Vector3i c = cell_of(scene[i]);
    return (static_cast<std::size_t>(c.x()) * dims_.y() + c.y()) * dims_.z() + c.z();
  };
  begin_.assign(static_cast<std::size_t>(dims_.x()) * dims_.y() * dims_.z() + 1, 0);
  for (const int i : found) ++begin_[flat_cell(i) + 1];
  for (std::size_t c = 1; c < begin_.size(); ++c) begin_[c] += begin_[c - 1];
  std::vector<int> next(begin_.begin(), begin_.end() - 1);
  points_.resize(found.size());
  indices_.resize(found.size());
  for (const int i : found) {
    const int slot = next[flat_cell(i)]++;
    points_[slot] = scene[i];
    indices_[slot] = i;
  }
}

LocalScene LocalScene::subset(std::span<const std::uint8_t> kept) const {
  LocalScene result;
  result.min_ = min_;
  result.inverse_cell_ = inverse_cell_;
  result.dims_ = dims_;
  result.begin_.assign(1, 0);
  result.begin_.reserve(begin_.size());
  for (std::size_t c = 0; c + 1 < begin_.size(); ++c) {
    for (int i = begin_[c]; i < begin_[c + 1]; ++i) {
      if (kept[static_cast<std::size_t>(i)] == 0) continue;
      result.points_.push_back(points_[static_cast<std::size_t>(i)]);
      result.indices_.push_back(indices_[static_cast<std::size_t>(i)]);
    }
    result.begin_.push_back(static_cast<int>(result.points_.size()));
  }
  return result;
}

}  // namespace resight
