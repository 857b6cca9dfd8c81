// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <array>
#include <vector>

#include "resight/io/internal/guarded_calls.hpp"
#include "resight/io/internal/image_decoder.hpp"
#include "resight/io/internal/libjpeg.hpp"

namespace resight::io {
namespace {

constexpr int kMaxScans = 100;        ///< Each one costs the time of the whole image. Encoders make about ten.
constexpr int kMaxPaddingBytes = 16;  ///< Before a marker. Some webcams write a few that do not belong there.

/// Inverted CMYK, as Adobe's programs write it, to RGB without a colour profile.
void cmyk_to_rgb(const std::vector<std::uint8_t>& cmyk, std::uint8_t* rgb) {
  for (std::size_t i = 0; i < cmyk.size(); i += 4) {
    const int k = cmyk[i + 3];
    for (std::size_t c = 0; c < 3; ++c) *rgb++ = static_cast<std::uint8_t>(k - ((255 - cmyk[i + c]) * k >> 8));
  }
}

class JpegDecoder final : public ImageDecoder {
 public:
  explicit JpegDecoder(std::string_view bytes) : bytes_(bytes) {
    jpeg_.err = jpeg_std_error(&errors_);
    jpeg_.client_data = this;
    errors_.error_exit = on_error;
    errors_.emit_message = on_message;
    progress_.progress_monitor = on_progress;
  }
  JpegDecoder(const JpegDecoder&) = delete;
  JpegDecoder& operator=(const JpegDecoder&) = delete;
  ~JpegDecoder() override { jpeg_destroy_decompress(&jpeg_); }

  Result<ImageHeader> read_header() override {
    const auto done = calls_.run([this] {
      jpeg_create_decompress(&jpeg_);
      jpeg_mem_src(&jpeg_, reinterpret_cast<const unsigned char*>(bytes_.data()), bytes_.size());
      jpeg_read_header(&jpeg_, TRUE);
    });
    if (!done) return done.error();
    ImageHeader header;
    header.width = static_cast<int>(jpeg_.image_width);
    header.height = static_cast<int>(jpeg_.image_height);
    header.num_channels = jpeg_.num_components == 1 ? 1 : 3;
    return header;
  }

  Result<void> read_pixels(PixelLayout layout, std::uint8_t* pixels) override {
    const bool is_cmyk = jpeg_.num_components == 4;
    const bool stays_grey = jpeg_.num_components == 1 && layout == PixelLayout::kStored;
    jpeg_.out_color_space = is_cmyk ? JCS_CMYK : stays_grey ? JCS_GRAYSCALE : JCS_RGB;
    jpeg_.progress = &progress_;
    const std::size_t row_bytes = std::size_t{jpeg_.image_width} * (stays_grey ? 1 : 3);
    std::vector<std::uint8_t> cmyk(is_cmyk ? std::size_t{jpeg_.image_width} * 4 : 0);
    return calls_.run([&] {
      jpeg_start_decompress(&jpeg_);
      for (std::uint8_t* row = pixels; jpeg_.output_scanline < jpeg_.output_height; row += row_bytes) {
        JSAMPROW target = is_cmyk ? cmyk.data() : row;
        jpeg_read_scanlines(&jpeg_, &target, 1);
        if (is_cmyk) cmyk_to_rgb(cmyk, row);
      }
      jpeg_finish_decompress(&jpeg_);  // reads up to the end mark
    });
  }

 private:
  static GuardedCalls& calls_of(j_common_ptr jpeg) { return static_cast<JpegDecoder*>(jpeg->client_data)->calls_; }

  static std::string message_of(j_common_ptr jpeg) {
    std::array<char, JMSG_LENGTH_MAX> message{};
    jpeg->err->format_message(jpeg, message.data());
    return message.data();
  }

  [[noreturn]] static void on_error(j_common_ptr jpeg) {
    calls_of(jpeg).set_fault(fmt::format("the image cannot be decoded ({})", message_of(jpeg)));
    calls_of(jpeg).leave();
  }

  /// libjpeg goes on with invented pixels after what it calls a warning.
  static void on_message(j_common_ptr jpeg, int level) {
    if (level >= 0) return;  // no warning
    if (jpeg->err->msg_code == JWRN_JPEG_EOF) {
      calls_of(jpeg).set_fault("the image is cut off");
      calls_of(jpeg).leave();
    }
    if (!means_damage(jpeg)) return;
    calls_of(jpeg).set_fault(fmt::format("the image is damaged ({})", message_of(jpeg)));
    calls_of(jpeg).leave();
  }

  /// Whether a warning is about the data of pixels. The others are about details of the header, which change no pixel.
  static bool means_damage(j_common_ptr jpeg) {
    switch (jpeg->err->msg_code) {
      case JWRN_ARITH_BAD_CODE:
      case JWRN_BOGUS_PROGRESSION:
      case JWRN_HIT_MARKER:
      case JWRN_HUFF_BAD_CODE:
      case JWRN_MUST_RESYNC:
        return true;
      case JWRN_EXTRANEOUS_DATA:
        return reinterpret_cast<j_decompress_ptr>(jpeg)->input_scan_number > 0 &&
               jpeg->err->msg_parm.i[0] > kMaxPaddingBytes;
      default:
        return false;
    }
  }

  static void on_progress(j_common_ptr jpeg) {
    if (reinterpret_cast<j_decompress_ptr>(jpeg)->input_scan_number <= kMaxScans) return;
    calls_of(jpeg).set_fault(fmt::format("the image has more than {} scans", kMaxScans));
    calls_of(jpeg).leave();
  }

  std::string_view bytes_;
  GuardedCalls calls_;
  jpeg_error_mgr errors_{};
  jpeg_progress_mgr progress_{};
  jpeg_decompress_struct jpeg_{};
};

}  // namespace

std::unique_ptr<ImageDecoder> make_jpeg_decoder(std::string_view bytes) { return std::make_unique<JpegDecoder>(bytes); }

}  // namespace resight::io
