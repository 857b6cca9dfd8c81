// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "resight/core/random.hpp"
#include "resight/simulation/texture_canvas.hpp"

namespace resight {

/// Style of an object's texture: colours, words, and a seed for random elements.
struct TextureStyle {
  std::string brand;    ///< Large letters.
  std::string product;  ///< Smaller letters.
  double hue_deg = 0;
  std::uint64_t seed = 1;

  [[nodiscard]] Rgb8 base() const { return hsv_color(hue_deg, 0.75, 0.75); }
  [[nodiscard]] Rgb8 dark() const { return hsv_color(hue_deg + 15, 0.8, 0.3); }
  [[nodiscard]] Rgb8 light() const { return hsv_color(hue_deg + 30, 0.15, 0.97); }
  [[nodiscard]] Rgb8 accent() const { return hsv_color(hue_deg + 165, 0.8, 0.9); }
  /// An independent random stream for each part of the texture.
  [[nodiscard]] Rng stream(std::uint64_t part) const { return Rng::stream(seed, part); }
};

/// Draw faces of a package, each filling its canvas. `part` distinguishes faces of the same kind.
void print_front(TextureCanvas canvas, const TextureStyle& style, std::uint64_t part);
void print_back(TextureCanvas canvas, const TextureStyle& style, std::uint64_t part);
void print_side(TextureCanvas canvas, const TextureStyle& style, std::uint64_t part);
void print_lid(TextureCanvas canvas, const TextureStyle& style, std::uint64_t part);
/// Draws a label that surrounds an object: front, table of contents, picture, bar code.
void print_label(TextureCanvas canvas, const TextureStyle& style, std::uint64_t part);

/// Draw elements of textures.
void print_blobs(TextureCanvas canvas, Rng rng, double hue_deg, int count, double min_radius_mm, double max_radius_mm);
void print_emblem(TextureCanvas canvas, Rng rng, double x, double y, double radius_mm, double hue_deg);
void print_paragraph(TextureCanvas canvas, Rng rng, double x, double y, double width, double height, double letter_mm,
                     Rgb8 color);
void print_barcode(TextureCanvas canvas, Rng rng, double x, double y, double width, double height);
/// Draws specks and soft variations of brightness over the whole canvas (paper, cloth, plaster).
void print_grain(TextureCanvas canvas, Rng rng, Rgb8 color, int count, double min_radius_mm, double max_radius_mm);
/// Draws planks with growth rings.
void print_wood(TextureCanvas canvas, Rng rng, Rgb8 light, Rgb8 dark, double plank_mm);

/// A pronounceable word without meaning.
[[nodiscard]] std::string make_word(Rng& rng, int syllables);

}  // namespace resight
