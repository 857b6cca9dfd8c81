// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <span>
#include <string_view>

#include "resight/core/image.hpp"

namespace resight {

/// A rectangle of pixels.
struct PixelRect {
  int x = 0;
  int y = 0;
  int width = 0;
  int height = 0;
};

/// Draws anti-aliased shapes into a rectangle of an image. Coordinates are millimetres on the surface, with the origin
/// at the top left of the rectangle and y down. Nothing is drawn outside the rectangle.
class TextureCanvas {
 public:
  /// `image` must outlive the canvas.
  TextureCanvas(Image<Rgb8>& image, PixelRect rect, double px_per_mm);

  [[nodiscard]] double width() const { return rect_.width / scale_; }    ///< mm
  [[nodiscard]] double height() const { return rect_.height / scale_; }  ///< mm
  /// A canvas for a part of this one, in mm.
  [[nodiscard]] TextureCanvas part(double x, double y, double width, double height) const;

  void fill(Rgb8 color);
  /// Fills the canvas with a vertical gradient from `top` to `bottom`.
  void gradient(Rgb8 top, Rgb8 bottom);
  void rect(double x, double y, double width, double height, Rgb8 color);
  void rounded_rect(double x, double y, double width, double height, double radius, Rgb8 color);
  void disc(double x, double y, double radius, Rgb8 color);
  void ring(double x, double y, double radius, double thickness, Rgb8 color);
  void ellipse(double x, double y, double radius_x, double radius_y, double angle_rad, Rgb8 color);
  /// Draws a line with round ends.
  void line(double x0, double y0, double x1, double y1, double thickness, Rgb8 color);
  /// Fills any simple polygon.
  void polygon(std::span<const Eigen::Vector2d> corners, Rgb8 color);
  void star(double x, double y, double outer_radius, double inner_radius, int points, double angle_rad, Rgb8 color);
  /// Draws parallel stripes over the whole canvas with a period in mm. Half of each period is coloured.
  void stripes(double period, double angle_rad, Rgb8 color);
  /// Draws capital letters, digits and .-+!%& in a stroke font; other characters are blanks. The top left is at (x, y),
  /// and the text is `height` mm high.
  void text(double x, double y, double height, double stroke, std::string_view text, Rgb8 color);
  /// Draws a text as large as fits into the box, centred.
  void text_in_box(double x, double y, double width, double height, std::string_view text, Rgb8 color,
                   double stroke_share = 0.16);

 private:
  template <typename SignedDistance>
  void paint(double x0, double y0, double x1, double y1, Rgb8 color, SignedDistance&& distance_mm);
  Image<Rgb8>* image_;
  PixelRect rect_;
  double scale_;
};

/// Width of text() relative to its height.
[[nodiscard]] double text_width(std::string_view text);

/// Converts hue (degrees), saturation and value (0..1) to a colour.
[[nodiscard]] Rgb8 hsv_color(double hue_deg, double saturation, double value);

}  // namespace resight
