// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <png.h>

#include <bit>
#include <cstring>

#include "resight/io/internal/guarded_calls.hpp"
#include "resight/io/internal/image_decoder.hpp"

namespace resight::io {
namespace {

class PngDecoder final : public ImageDecoder {
 public:
  explicit PngDecoder(std::string_view bytes) : rest_(bytes) {}
  PngDecoder(const PngDecoder&) = delete;
  PngDecoder& operator=(const PngDecoder&) = delete;
  ~PngDecoder() override { png_destroy_read_struct(&png_, &info_, nullptr); }

  Result<ImageHeader> read_header() override {
    const auto done = calls_.run([this] { start(); });
    if (!done) return done.error();
    ImageHeader header;
    header.width = static_cast<int>(png_get_image_width(png_, info_));
    header.height = static_cast<int>(png_get_image_height(png_, info_));
    header.num_channels = is_palette() ? 3 : png_get_channels(png_, info_);
    header.channel_bytes = png_get_bit_depth(png_, info_) == 16 ? 2 : 1;
    return header;
  }

  Result<void> read_pixels(PixelLayout layout, std::uint8_t* pixels) override {
    return calls_.run([&] {
      choose_layout(layout);
      const int num_passes = png_set_interlace_handling(png_);
      png_read_update_info(png_, info_);
      const std::size_t row_bytes = png_get_rowbytes(png_, info_);
      const png_uint_32 height = png_get_image_height(png_, info_);
      for (int pass = 0; pass < num_passes; ++pass)
        for (png_uint_32 v = 0; v < height; ++v) png_read_row(png_, pixels + v * row_bytes, nullptr);
      png_read_end(png_, nullptr);  // the last checksum
    });
  }

 private:
  /// The pixels need no other chunks, which libpng would hold in memory.
  void start() {
    png_ = png_create_read_struct(PNG_LIBPNG_VER_STRING, this, on_error, [](png_structp, png_const_charp) {});
    if (png_ != nullptr) info_ = png_create_info_struct(png_);
    if (info_ == nullptr) {
      calls_.set_fault("the memory does not suffice for the image");
      calls_.leave();
    }
    png_set_user_limits(png_, PNG_UINT_31_MAX, PNG_UINT_31_MAX);  // Callers have their own.
    png_set_keep_unknown_chunks(png_, PNG_HANDLE_CHUNK_NEVER, nullptr, -1);
    png_set_read_fn(png_, this, read);
    png_read_info(png_, info_);
  }

  void choose_layout(PixelLayout layout) {
    if (is_palette()) {
      png_set_palette_to_rgb(png_);
      png_set_strip_alpha(png_);
    }
    if (png_get_color_type(png_, info_) == PNG_COLOR_TYPE_GRAY) png_set_expand_gray_1_2_4_to_8(png_);
    if (layout == PixelLayout::kRgb8) {
      png_set_strip_16(png_);
      png_set_strip_alpha(png_);
      png_set_gray_to_rgb(png_);
    } else if (std::endian::native == std::endian::little) {
      png_set_swap(png_);
    }
  }

  [[nodiscard]] bool is_palette() const { return png_get_color_type(png_, info_) == PNG_COLOR_TYPE_PALETTE; }

  [[noreturn]] static void on_error(png_structp png, png_const_charp what) {
    auto& self = *static_cast<PngDecoder*>(png_get_error_ptr(png));
    self.calls_.set_fault(self.is_cut_off_ ? "the image is cut off"
                                           : fmt::format("the image cannot be decoded ({})", what));
    self.calls_.leave();
  }

  static void read(png_structp png, png_bytep target, std::size_t num_bytes) {
    auto& self = *static_cast<PngDecoder*>(png_get_io_ptr(png));
    self.is_cut_off_ = num_bytes > self.rest_.size();
    if (self.is_cut_off_) png_error(png, "cut off");
    std::memcpy(target, self.rest_.data(), num_bytes);
    self.rest_.remove_prefix(num_bytes);
  }

  std::string_view rest_;
  bool is_cut_off_ = false;
  GuardedCalls calls_;
  png_structp png_ = nullptr;
  png_infop info_ = nullptr;
};

}  // namespace

std::unique_ptr<ImageDecoder> make_png_decoder(std::string_view bytes) { return std::make_unique<PngDecoder>(bytes); }

}  // namespace resight::io
