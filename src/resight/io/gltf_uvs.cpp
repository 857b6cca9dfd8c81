// SPDX-License-Identifier: Apache-2.0
#include "resight/io/internal/gltf_uvs.hpp"

#include <Eigen/Geometry>
#include <array>
#include <cstring>
#include <optional>
#include <vector>

#include "resight/io/internal/json.hpp"

namespace resight::io {
namespace {

/// RFC 4648; ends at the first other character, such as the padding.
std::string decode_base64(std::string_view text) {
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  std::uint32_t bits = 0;
  int num_bits = 0;
  for (const char c : text) {
    const std::size_t digit = kDigits.find(c);
    if (digit == kDigits.npos) break;
    bits = bits << 6 | static_cast<std::uint32_t>(digit);
    num_bits += 6;
    if (num_bits < 8) continue;
    num_bits -= 8;
    bytes += static_cast<char>(bits >> num_bits & 0xFF);
  }
  return bytes;
}

/// None if the numbers of the transform are damaged.
std::optional<Eigen::Affine2d> to_affine(const nlohmann::json& transform) {
  const auto numbers = [&](const char* key, double missing) {
    const nlohmann::json& value = member(transform, key);
    return value.is_null() ? std::vector<double>(2, missing) : as_numbers(value).value_or(std::vector<double>());
  };
  const std::vector<double> offset = numbers("offset", 0);
  const std::vector<double> scale = numbers("scale", 1);
  const nlohmann::json& rotation = member(transform, "rotation");
  const auto rotation_rad = rotation.is_null() ? 0.0 : as_number(rotation);
  if (offset.size() != 2 || scale.size() != 2 || !rotation_rad) return std::nullopt;
  // It is counter-clockwise in the image, where v points down.
  return Eigen::Translation2d(offset[0], offset[1]) * Eigen::Rotation2Dd(-*rotation_rad) *
         Eigen::Scaling(scale[0], scale[1]);
}

template <typename T>
Eigen::Vector2d load_uv(const char* bytes, double unit) {
  std::array<T, 2> uv;
  std::memcpy(uv.data(), bytes, sizeof(uv));
  return {uv[0] / unit, uv[1] / unit};
}

Eigen::Vector2d load_uv(const char* bytes, const GltfNumberType& type) {
  if (type.number == kGltfUint8.number) return load_uv<std::uint8_t>(bytes, 255);
  if (type.number == kGltfUint16.number) return load_uv<std::uint16_t>(bytes, 65535);
  return load_uv<float>(bytes, 1);
}

}  // namespace

Result<void> GltfUvs::convert(const GltfUvSource& source, const nlohmann::json& transform) {
  const std::string_view bytes = buffer(source.buffer);
  const std::int64_t end = source.begin + (source.num - 1) * source.stride + 2 * source.type.bytes;
  if (source.num > 0 && end > static_cast<std::int64_t>(bytes.size()))
    return Error{"texture coordinates end beyond their buffer (cut off?)"};
  const auto affine = to_affine(transform);
  if (!affine) return Error{"the numbers of KHR_texture_transform are damaged"};
  for (std::int64_t i = 0; i < source.num; ++i) {
    const char* uv = bytes.data() + source.begin + i * source.stride;
    const Eigen::Vector2f converted = (*affine * load_uv(uv, source.type)).cast<float>();
    converted_.append(reinterpret_cast<const char*>(converted.data()), 2 * sizeof(float));
  }
  return {};
}

std::string_view GltfUvs::buffer(std::size_t index) {
  if (const auto it = buffers_.find(index); it != buffers_.end()) return *it->second;
  const nlohmann::json& buffers = member(document_, "buffers");
  if (!buffers.is_array() || index >= buffers.size()) return {};
  const auto uri = as_text(member(buffers[index], "uri"));
  if (!uri) return index == 0 ? binary_ : std::string_view();
  constexpr std::string_view kBase64 = ";base64,";
  const std::size_t at = uri->starts_with("data:") ? uri->find(kBase64) : uri->npos;
  auto bytes =
      at == uri->npos
          ? find_(*uri)
          : std::make_shared<const std::string>(decode_base64(std::string_view(*uri).substr(at + kBase64.size())));
  return *buffers_.emplace(index, std::move(bytes)).first->second;
}

}  // namespace resight::io
