// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <memory>
#include <string_view>

#include "resight/core/result.hpp"

namespace resight::io {

/// How the pixels of an image are stored.
struct ImageHeader {
  int width = 0;
  int height = 0;
  int num_channels = 1;   ///< Grey, grey and alpha, RGB (also for a palette and CMYK), or RGB and alpha.
  int channel_bytes = 1;  ///< 1 or 2, in the byte order of the machine.
};

enum class PixelLayout {
  kStored,  ///< As the header says.
  kRgb8,    ///< Three channels of 8 bits. Grey is copied to all of them; alpha is dropped.
};

/// Decodes one image, without any output of the library behind it. Errors say what is wrong, but not with which file.
class ImageDecoder {
 public:
  virtual ~ImageDecoder() = default;
  /// Reads the size without memory for the pixels. The first call.
  [[nodiscard]] virtual Result<ImageHeader> read_header() = 0;
  /// Reads the pixels row by row without gaps. The second and last call; `pixels` has room for all of them.
  [[nodiscard]] virtual Result<void> read_pixels(PixelLayout layout, std::uint8_t* pixels) = 0;
};

/// `bytes` must outlive the decoder.
[[nodiscard]] std::unique_ptr<ImageDecoder> make_png_decoder(std::string_view bytes);
[[nodiscard]] std::unique_ptr<ImageDecoder> make_jpeg_decoder(std::string_view bytes);
/// The decoder for the content, whatever the name of the file is. Fails if it is neither PNG nor JPEG.
[[nodiscard]] Result<std::unique_ptr<ImageDecoder>> make_image_decoder(std::string_view bytes);

}  // namespace resight::io
