// SPDX-License-Identifier: Apache-2.0
#include "resight/viewer/binary_content.hpp"

#include <bit>
#include <cmath>
#include <cstdint>

namespace resight {
namespace {

static_assert(std::endian::native == std::endian::little, "contents are sent as they are in memory");

template <typename T>
void append_values(std::string& bytes, const T* values, std::size_t count) {
  bytes.append(reinterpret_cast<const char*>(values), count * sizeof(T));
}

}  // namespace

std::string encode_depth(const Image<float>& depth_m) {
  std::string bytes;
  append_values(bytes, depth_m.data().data(), depth_m.size());
  return bytes;
}

std::string encode_cloud(const PointCloud& cloud) {
  const std::uint32_t header[] = {static_cast<std::uint32_t>(cloud.size()),
                                  (cloud.has_normals() ? 1U : 0U) | (cloud.has_colors() ? 2U : 0U)};
  std::string bytes;
  append_values(bytes, header, 2);
  for (const Eigen::Vector3f& point : cloud.points) append_values(bytes, point.data(), 3);
  if (cloud.has_normals()) {
    for (const Eigen::Vector3f& normal : cloud.normals)
      for (const float value : normal) bytes.push_back(static_cast<char>(std::lround(127 * value)));
  }
  if (cloud.has_colors()) append_values(bytes, cloud.colors.data(), cloud.size());
  return bytes;
}

}  // namespace resight
