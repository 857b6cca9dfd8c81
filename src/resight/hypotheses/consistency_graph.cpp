// SPDX-License-Identifier: Apache-2.0
#include "resight/hypotheses/consistency_graph.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

namespace resight {
namespace {

constexpr std::size_t kBlock = 64;

// The correspondences as a structure of arrays, padded to whole blocks with points that agree with none.
struct Columns {
  explicit Columns(std::span<const Correspondence> correspondences);
  std::array<std::vector<float>, 3> model;
  std::array<std::vector<float>, 3> scene;
  std::array<std::vector<float>, 3> model_normal;
  std::array<std::vector<float>, 3> scene_normal;
  std::vector<std::int32_t> model_key;  // Equal keys = same keypoint.
  std::vector<std::int32_t> scene_key;
};

std::int32_t keypoint_key(int feature, FeatureType type, std::size_t index) {
  if (feature < 0) return -1 - static_cast<std::int32_t>(index);  // Unknown: equal to no other.
  return 2 * feature + (type == FeatureType::kShot ? 1 : 0);
}

Columns::Columns(std::span<const Correspondence> correspondences) {
  const std::size_t n = correspondences.size();
  const std::size_t padded = (n + kBlock - 1) / kBlock * kBlock;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    model[axis].assign(padded, NAN);  // NaN distances fail the comparisons below.
    scene[axis].assign(padded, NAN);
    model_normal[axis].assign(padded, 0);
    scene_normal[axis].assign(padded, 0);
  }
  model_key.assign(padded, 0);
  scene_key.assign(padded, 0);
  for (std::size_t i = 0; i < n; ++i) {
    const Correspondence& c = correspondences[i];
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto row = static_cast<Eigen::Index>(axis);
      model[axis][i] = c.model_point[row];
      scene[axis][i] = c.scene_point[row];
      model_normal[axis][i] = c.model_normal[row];
      scene_normal[axis][i] = c.scene_normal[row];
    }
    model_key[i] = keypoint_key(c.model_feature, c.type, i);
    scene_key[i] = keypoint_key(c.scene_feature, c.type, i);
  }
}

using AxisPointers = std::array<const float*, 3>;

AxisPointers pointers(const std::array<std::vector<float>, 3>& columns, std::size_t begin) {
  return {columns[0].data() + begin, columns[1].data() + begin, columns[2].data() + begin};
}

// Tests correspondence i against each of the block that starts at `begin`. Branch-free for vectorisation: the whole
// graph takes n^2 / 2 tests.
void test_block(const Columns& columns, std::size_t i, std::size_t begin, const ConsistencyOptions& options,
                std::array<std::int32_t, kBlock>& agrees) {
  const auto [mx, my, mz] = pointers(columns.model, begin);
  const auto [sx, sy, sz] = pointers(columns.scene, begin);
  const auto [mnx, mny, mnz] = pointers(columns.model_normal, begin);
  const auto [snx, sny, snz] = pointers(columns.scene_normal, begin);
  const auto [mix, miy, miz] = pointers(columns.model, i);
  const auto [six, siy, siz] = pointers(columns.scene, i);
  const auto [mnix, mniy, mniz] = pointers(columns.model_normal, i);
  const auto [snix, sniy, sniz] = pointers(columns.scene_normal, i);
  const float m[3] = {*mix, *miy, *miz};
  const float s[3] = {*six, *siy, *siz};
  const float mn[3] = {*mnix, *mniy, *mniz};
  const float sn[3] = {*snix, *sniy, *sniz};
  const std::int32_t* model_key = columns.model_key.data() + begin;
  const std::int32_t* scene_key = columns.scene_key.data() + begin;
  const std::int32_t own_model_key = columns.model_key[i];
  const std::int32_t own_scene_key = columns.scene_key[i];
  const auto max_difference = static_cast<float>(options.max_distance_difference_m);
  const auto max_dot_difference = static_cast<float>(options.max_dot_difference);
  const auto min_distance = static_cast<float>(options.min_distance_m);
  for (std::size_t j = 0; j < kBlock; ++j) {
    const float mdx = mx[j] - m[0];
    const float mdy = my[j] - m[1];
    const float mdz = mz[j] - m[2];
    const float sdx = sx[j] - s[0];
    const float sdy = sy[j] - s[1];
    const float sdz = sz[j] - s[2];
    const float model_distance = std::sqrt(mdx * mdx + mdy * mdy + mdz * mdz);
    const float scene_distance = std::sqrt(sdx * sdx + sdy * sdy + sdz * sdz);
    const float model_dot = mnx[j] * mn[0] + mny[j] * mn[1] + mnz[j] * mn[2];
    const float scene_dot = snx[j] * sn[0] + sny[j] * sn[1] + snz[j] * sn[2];
    agrees[j] = static_cast<std::int32_t>(std::abs(model_distance - scene_distance) < max_difference) &
                static_cast<std::int32_t>(model_distance >= min_distance) &
                static_cast<std::int32_t>(scene_distance >= min_distance) &
                static_cast<std::int32_t>(!(std::abs(model_dot - scene_dot) > max_dot_difference)) &
                static_cast<std::int32_t>(model_key[j] != own_model_key) &
                static_cast<std::int32_t>(scene_key[j] != own_scene_key);
  }
}

std::uint64_t pack(const std::array<std::int32_t, kBlock>& flags) {
  std::uint64_t word = 0;
  for (std::size_t j = 0; j < kBlock; ++j) word |= static_cast<std::uint64_t>(flags[j]) << j;
  return word;
}

}  // namespace

BitGraph::BitGraph(int num_vertices)
    : num_vertices_(num_vertices),
      num_words_((num_vertices + 63) / 64),
      bits_(static_cast<std::size_t>(num_vertices) * static_cast<std::size_t>(num_words_), 0) {}

int BitGraph::degree(int vertex) const {
  int count = 0;
  for (const std::uint64_t word : row(vertex)) count += std::popcount(word);
  return count;
}

void BitGraph::add_edge(int a, int b) {
  const auto set = [&](int from, int to) {
    bits_[static_cast<std::size_t>(from) * static_cast<std::size_t>(num_words_) + static_cast<std::size_t>(to) / 64] |=
        std::uint64_t{1} << (static_cast<unsigned>(to) % 64);
  };
  set(a, b);
  set(b, a);
}

BitGraph BitGraph::subgraph(std::span<const int> vertices) const {
  BitGraph result(static_cast<int>(vertices.size()));
  for (std::size_t i = 0; i < vertices.size(); ++i)
    for (std::size_t j = i + 1; j < vertices.size(); ++j)
      if (has_edge(vertices[i], vertices[j])) result.add_edge(static_cast<int>(i), static_cast<int>(j));
  return result;
}

BitGraph build_consistency_graph(std::span<const Correspondence> correspondences, const ConsistencyOptions& options) {
  const std::size_t n = correspondences.size();
  const Columns columns(correspondences);
  BitGraph graph(static_cast<int>(n));
  std::array<std::int32_t, kBlock> agrees{};
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t block = i / kBlock; block * kBlock < n; ++block) {
      test_block(columns, i, block * kBlock, options, agrees);
      std::uint64_t word = pack(agrees);
      if (block == i / kBlock) word &= ~std::uint64_t{0} << (i % kBlock);  // Earlier pairs are already done.
      for (; word != 0; word &= word - 1)
        graph.add_edge(static_cast<int>(i), static_cast<int>(block * kBlock) + std::countr_zero(word));
    }
  }
  return graph;
}

Degeneracy degeneracy_order(const BitGraph& graph) {
  const int n = graph.num_vertices();
  Degeneracy result;
  result.core.assign(static_cast<std::size_t>(n), 0);
  std::vector<int> degree(static_cast<std::size_t>(n));
  std::vector<std::vector<int>> bucket(static_cast<std::size_t>(n) + 1);
  for (int v = n - 1; v >= 0; --v) {
    degree[static_cast<std::size_t>(v)] = graph.degree(v);
    bucket[static_cast<std::size_t>(degree[static_cast<std::size_t>(v)])].push_back(v);
  }
  std::vector<std::uint8_t> peeled(static_cast<std::size_t>(n), 0);
  int core = 0;
  std::size_t lowest = 0;
  while (result.order.size() < static_cast<std::size_t>(n)) {
    while (bucket[lowest].empty()) ++lowest;
    const int v = bucket[lowest].back();
    bucket[lowest].pop_back();
    const auto index = static_cast<std::size_t>(v);
    // Stale entry: the vertex has moved down since.
    if (peeled[index] != 0 || degree[index] != static_cast<int>(lowest)) continue;
    peeled[index] = 1;
    core = std::max(core, degree[index]);
    result.core[index] = core;
    result.order.push_back(v);
    for (int w = 0; w < graph.num_words(); ++w) {
      for (std::uint64_t word = graph.row(v)[static_cast<std::size_t>(w)]; word != 0; word &= word - 1) {
        const auto u = static_cast<std::size_t>(w * 64 + std::countr_zero(word));
        if (peeled[u] != 0) continue;
        bucket[static_cast<std::size_t>(--degree[u])].push_back(static_cast<int>(u));
      }
    }
    if (lowest > 0) --lowest;
  }
  return result;
}

}  // namespace resight
