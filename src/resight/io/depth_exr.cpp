// SPDX-License-Identifier: Apache-2.0
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputFile.h>
#include <fmt/format.h>

#include <cstring>
#include <exception>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "resight/io/images.hpp"
#include "resight/io/internal/depth_arrays.hpp"
#include "resight/sensor/rgbd_frame.hpp"

namespace resight::io {
namespace {

/// The bytes of a file, for OpenEXR. It reports errors by exceptions.
class ByteStream : public Imf::IStream {
 public:
  explicit ByteStream(std::string_view bytes) : IStream("depth"), bytes_(bytes) {}
  bool read(char* target, int count) override {
    if (count < 0 || static_cast<std::uint64_t>(count) > bytes_.size() - position_)
      throw std::runtime_error("the file ends too early");
    std::memcpy(target, bytes_.data() + position_, static_cast<std::size_t>(count));
    position_ += static_cast<std::uint64_t>(count);
    return position_ < bytes_.size();
  }
  std::uint64_t tellg() override { return position_; }
  void seekg(std::uint64_t position) override {
    if (position > bytes_.size()) throw std::runtime_error("the file ends too early");
    position_ = position;
  }

 private:
  std::string_view bytes_;
  std::uint64_t position_ = 0;
};

template <typename Number>
Number read_little_endian(std::string_view bytes, std::size_t at) {
  Number number = 0;
  std::memcpy(&number, bytes.data() + at, sizeof(number));
  return number;
}

bool is_channel_list(std::string_view value) {
  constexpr std::size_t kTypeAndSampling = 16;
  while (!value.empty() && value.front() != '\0') {
    const std::size_t end_of_name = value.find('\0');
    if (end_of_name == value.npos || value.size() - end_of_name < 1 + kTypeAndSampling) return false;
    value.remove_prefix(end_of_name + 1 + kTypeAndSampling);
  }
  return value.size() == 1;
}

bool is_preview(std::string_view value) {
  constexpr std::size_t kWidthAndHeight = 8;
  if (value.size() < kWidthAndHeight) return false;
  const auto width = std::uint64_t{read_little_endian<std::uint32_t>(value, 0)};
  const auto height = std::uint64_t{read_little_endian<std::uint32_t>(value, 4)};
  return width * height == (value.size() - kWidthAndHeight) / 4 && value.size() % 4 == 0;
}

bool is_text_list(std::string_view value) {
  while (value.size() >= 4) {
    const auto size = read_little_endian<std::uint32_t>(value, 0);
    if (size > value.size() - 4) return false;
    value.remove_prefix(4 + size);
  }
  return value.empty();
}

/// Whether a value is as large as OpenEXR reads it. For most types, it does not look at the size that the file
/// declares, and would take the rest of the value for further attributes.
bool has_sound_size(std::string_view type, std::string_view value) {
  constexpr std::pair<std::string_view, std::size_t> kSizes[] = {{"box2f", 16},
                                                                 {"box2i", 16},
                                                                 {"chromaticities", 32},
                                                                 {"compression", 1},
                                                                 {"deepImageState", 1},
                                                                 {"double", 8},
                                                                 {"envmap", 1},
                                                                 {"float", 4},
                                                                 {"int", 4},
                                                                 {"keycode", 28},
                                                                 {"lineOrder", 1},
                                                                 {"m33d", 72},
                                                                 {"m33f", 36},
                                                                 {"m44d", 128},
                                                                 {"m44f", 64},
                                                                 {"rational", 8},
                                                                 {"tiledesc", 9},
                                                                 {"timecode", 8},
                                                                 {"v2d", 16},
                                                                 {"v2f", 8},
                                                                 {"v2i", 8},
                                                                 {"v3d", 24},
                                                                 {"v3f", 12},
                                                                 {"v3i", 12}};
  for (const auto& [name, size] : kSizes)
    if (type == name) return value.size() == size;
  if (type == "chlist") return is_channel_list(value);
  if (type == "preview") return is_preview(value);
  if (type == "stringvector") return is_text_list(value);
  return type != "floatvector" || value.size() % 4 == 0;
}

/// Whether the attributes of the first header lie within the file. OpenEXR allocates what they declare.
bool has_sound_header(std::string_view bytes) {
  constexpr std::size_t kMagicAndVersion = 8;
  std::size_t at = kMagicAndVersion;
  while (at < bytes.size() && bytes[at] != '\0') {
    const std::size_t end_of_name = bytes.find('\0', at);
    const std::size_t end_of_type = end_of_name == bytes.npos ? bytes.npos : bytes.find('\0', end_of_name + 1);
    if (end_of_type == bytes.npos || bytes.size() - end_of_type < 5) return false;
    const auto size = read_little_endian<std::uint32_t>(bytes, end_of_type + 1);
    at = end_of_type + 5;
    if (size > bytes.size() - at) return false;
    const std::string_view type = bytes.substr(end_of_name + 1, end_of_type - end_of_name - 1);
    if (!has_sound_size(type, bytes.substr(at, size))) return false;
    at += size;
  }
  return at < bytes.size();
}

/// OpenEXR reads the headers of all parts, of which has_sound_header() knows the first.
bool has_several_parts(std::string_view bytes) {
  constexpr unsigned char kMultipart = 0x10;
  return (static_cast<unsigned char>(bytes[5]) & kMultipart) != 0;
}

/// One called Z or depth; otherwise all but the transparency, which must be equal.
std::vector<std::string> find_depth_channels(const Imf::ChannelList& channels) {
  for (const char* name : {"Z", "depth"})
    if (channels.findChannel(name) != nullptr) return {name};
  std::vector<std::string> names;
  for (auto it = channels.begin(); it != channels.end(); ++it)
    if (std::string_view(it.name()) != "A") names.emplace_back(it.name());
  return names;
}

/// Bit by bit: NaN equals NaN.
bool is_same_image(const Image<float>& a, const Image<float>& b) {
  return std::memcmp(a.data().data(), b.data().data(), a.size() * sizeof(float)) == 0;
}

Result<Image<float>> read_depth_channels(ByteStream& stream, std::string_view name, bool has_unit) {
  const auto fail = [&](std::string_view what) { return Error{fmt::format("{}: {}", name, what)}; };
  Imf::InputFile file(stream, 0);
  const Imath::Box2i window = file.header().dataWindow();
  const std::int64_t width = std::int64_t{window.max.x} - window.min.x + 1;
  const std::int64_t height = std::int64_t{window.max.y} - window.min.y + 1;
  if (width < 1 || height < 1 || width > kMaxImageSide_px || height > kMaxImageSide_px ||
      width * height > kMaxViewPixels)
    return fail(fmt::format("the image size {}x{} is out of range", width, height));
  constexpr std::size_t kNumColors = 3;
  const Error no_depth = fail("holds no channel of depth (one called Z or depth, a single one, or equal colours)");
  const std::vector<std::string> channels = find_depth_channels(file.header().channels());
  if (channels.empty() || channels.size() > kNumColors) return no_depth;
  std::vector<Image<float>> values;
  for (std::size_t i = 0; i < channels.size(); ++i)
    values.emplace_back(static_cast<int>(width), static_cast<int>(height), std::numeric_limits<float>::quiet_NaN());
  Imf::FrameBuffer buffer;
  for (std::size_t i = 0; i < channels.size(); ++i) {
    const Imf::Channel& found = file.header().channels()[channels[i]];
    if (found.type == Imf::UINT && !has_unit)
      return fail("holds whole numbers, whose unit is not known: give --depth-scale METRES per unit");
    if (found.xSampling != 1 || found.ySampling != 1)
      return fail("its channel of depth has fewer pixels than the image");
    buffer.insert(channels[i], Imf::Slice::Make(Imf::FLOAT, values[i].data().data(), window));
  }
  file.setFrameBuffer(buffer);
  file.readPixels(window.min.y, window.max.y);
  for (const Image<float>& other : values)
    if (!is_same_image(other, values.front())) return no_depth;
  return std::move(values.front());
}

}  // namespace

Result<Image<float>> parse_depth_exr(std::string_view bytes, std::string_view name,
                                     std::optional<double> metres_per_unit) {
  try {
    if (!has_sound_header(bytes)) return Error{fmt::format("{}: is cut off, or no OpenEXR image", name)};
    if (has_several_parts(bytes)) return Error{fmt::format("{}: has several parts; expected one image", name)};
    ByteStream stream(bytes);
    auto depth_m = read_depth_channels(stream, name, metres_per_unit.has_value());
    if (!depth_m) return depth_m;
    const double scale = metres_per_unit.value_or(1);
    for (float& z_m : depth_m->data()) z_m = depth_or_none(scale * z_m);
    return depth_m;
  } catch (const std::exception&) {
    return Error{fmt::format("{}: cannot be decoded as an OpenEXR image (damaged?)", name)};
  }
}

}  // namespace resight::io
