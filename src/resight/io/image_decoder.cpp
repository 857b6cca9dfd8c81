// SPDX-License-Identifier: Apache-2.0
#include "resight/io/internal/image_decoder.hpp"

namespace resight::io {

Result<std::unique_ptr<ImageDecoder>> make_image_decoder(std::string_view bytes) {
  if (bytes.starts_with("\x89PNG\r\n\x1a\n")) return make_png_decoder(bytes);
  if (bytes.starts_with("\xff\xd8")) return make_jpeg_decoder(bytes);
  return Error{"is not a supported image (expected PNG or JPEG)"};
}

}  // namespace resight::io
