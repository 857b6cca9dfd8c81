// SPDX-License-Identifier: Apache-2.0
#include "resight/verification/appearance_check.hpp"

#include <gtest/gtest.h>

#include <utility>

#include "resight/models/testing/square_world.hpp"
#include "resight/recognition/recognizer_config.hpp"

namespace resight {
namespace {

using test::kHalfSide_m;
using test::make_plate;
using test::plate_at;
using test::see_nothing;

// Stripes, fields and a corner: no rotation or mirror image of the texture is like it.
Rgb8 print_at(double x, double y) {
  if (x > 0.04 && y > 0.02) return {250, 240, 60};
  if (y < -0.05) return {30, 40, 160};
  return static_cast<int>(std::floor(x / 0.03)) % 2 == 0 ? Rgb8{200, 30, 30} : Rgb8{230, 230, 225};
}

ObjectModel make_printed_plate() {
  ObjectModel plate = make_plate("printed");
  for (std::size_t i = 0; i < plate.surface.size(); ++i)
    plate.surface.colors[i] = print_at(plate.surface.points[i].x(), plate.surface.points[i].y());
  return plate;
}

// The plate, in half the light, so near that the sensor measures nothing.
RgbdFrame see_print_without_depth(const Rigid3& world_from_plate) {
  RgbdFrame frame = see_nothing();
  for (int v = 0; v < frame.camera.height; ++v) {
    for (int u = 0; u < frame.camera.width; ++u) {
      const Eigen::Vector3d p =
          frame.camera.unproject(u, v, world_from_plate.translation.z()) - world_from_plate.translation;
      if (std::abs(p.x()) > kHalfSide_m || std::abs(p.y()) > kHalfSide_m) continue;
      const Rgb8 color = print_at(p.x(), p.y());
      const auto dim = [](std::uint8_t c) { return static_cast<std::uint8_t>(0.73 * c); };
      frame.color(u, v) = {dim(color.r), dim(color.g), dim(color.b)};
    }
  }
  return frame;
}

class ColorConfirmation : public ::testing::Test {
 protected:
  [[nodiscard]] double share(const Rigid3& pose, const RgbdFrame& frame) const {
    return color_confirmed_share(plate_, pose, frame, options_);
  }
  ObjectModel plate_ = make_printed_plate();
  VerifyOptions options_ = RecognizerConfig::from_preset("default").verify;
  Rigid3 near_ = plate_at(0, 0, 0.4);
};

TEST_F(ColorConfirmation, TextureIsSeenWithoutDepth) { EXPECT_GT(share(near_, see_print_without_depth(near_)), 0.95); }

TEST_F(ColorConfirmation, InAGreyViewLightnessAloneCounts) {
  RgbdFrame frame = see_print_without_depth(near_);
  for (Rgb8& c : frame.color.data()) c = to_grey(c);
  EXPECT_GT(share(near_, frame), 0.95);
  const Rigid3 turned = near_ * Rigid3::from_axis_angle(Eigen::Vector3d::UnitZ(), 3.14159);
  EXPECT_EQ(share(turned, frame), 0);
}

TEST_F(ColorConfirmation, OnlyWhatIsInTheImageCounts) {
  const Rigid3 half_outside = plate_at(0.4 * 79.5 / 130, 0, 0.4);
  EXPECT_NEAR(share(half_outside, see_print_without_depth(half_outside)), 0.5, 0.05);
}

TEST_F(ColorConfirmation, AnotherTextureIsNone) {
  const Rigid3 turned = near_ * Rigid3::from_axis_angle(Eigen::Vector3d::UnitZ(), 3.14159);
  EXPECT_EQ(share(turned, see_print_without_depth(near_)), 0);
  EXPECT_EQ(share(near_, see_nothing()), 0) << "grey all over";
  RgbdFrame speckled = see_print_without_depth(near_);  // A third of it shines through.
  for (int v = 0; v < speckled.camera.height; ++v)
    for (int u = 0; u < speckled.camera.width; ++u)
      if (const int k = (u * 7 + v * 11) % 6; k < 4) speckled.color(u, v) = k < 2 ? Rgb8{0, 0, 0} : Rgb8{255, 255, 255};
  EXPECT_EQ(share(near_, speckled), 0);
}

TEST_F(ColorConfirmation, TheSameTextureOfAnotherChromaticityIsNone) {
  RgbdFrame frame = see_print_without_depth(near_);
  for (std::size_t i = 0; i < frame.color.size(); ++i) std::swap(frame.color[i].r, frame.color[i].g);
  EXPECT_EQ(share(near_, frame), 0);
}

// A ball of one colour, lit from one side.
TEST_F(ColorConfirmation, ShadingIsNoTexture) {
  constexpr float kRadius_m = 0.08F;
  ObjectModel ball;
  RgbdFrame frame = see_nothing();
  const Rigid3f camera_from_ball(near_);
  for (int i = 0; i < 4000; ++i) {  // Spirals from pole to pole.
    const float z = -1 + 2 * (static_cast<float>(i) + 0.5F) / 4000;
    const float angle = 2.4F * static_cast<float>(i);
    const float r = std::sqrt(1 - z * z);
    const Eigen::Vector3f n(r * std::cos(angle), r * std::sin(angle), z);
    ball.surface.points.push_back(kRadius_m * n);
    ball.surface.normals.push_back(n);
    ball.surface.colors.push_back({150, 150, 150});
    const Eigen::Vector3f p = camera_from_ball * ball.surface.points.back();
    const Eigen::Vector2d pixel = frame.camera.project(p.cast<double>());
    const auto grey = static_cast<std::uint8_t>(150 * std::exp(0.45F * (n.x() + 0.4F * n.y())));
    if (n.dot(p) < 0)
      frame.color(static_cast<int>(std::lround(pixel.x())), static_cast<int>(std::lround(pixel.y()))) = {grey, grey,
                                                                                                         grey};
  }
  ball.diameter_m = 2 * kRadius_m;
  EXPECT_EQ(color_confirmed_share(ball, near_, frame, options_), 0);
}

TEST_F(ColorConfirmation, ColorsThatAreSwitchedOffConfirmNothing) {
  options_.appearance.use_color = false;
  EXPECT_EQ(share(near_, see_print_without_depth(near_)), 0);
}

TEST_F(ColorConfirmation, WhereThereIsDepthColorsAreNotAsked) {
  RgbdFrame frame = see_print_without_depth(near_);
  frame.depth_m = Image<float>(frame.camera.width, frame.camera.height, 0.4F);
  EXPECT_EQ(share(near_, frame), 0);
}

TEST_F(ColorConfirmation, UntexturedOrOfUnknownColoursOrBackFacingIsNotConfirmed) {
  const RgbdFrame frame = see_print_without_depth(near_);
  RgbdFrame red = frame;
  for (std::size_t i = 0; i < red.color.size(); ++i) red.color[i] = {200, 30, 30};
  EXPECT_EQ(color_confirmed_share(make_plate("plain"), near_, red, options_), 0);
  ObjectModel unknown_colors = plate_;
  unknown_colors.surface.colors.clear();
  EXPECT_EQ(color_confirmed_share(unknown_colors, near_, frame, options_), 0);
  EXPECT_EQ(share(plate_at(0, 0, -0.4), frame), 0);
  EXPECT_EQ(share(near_ * Rigid3::from_axis_angle(Eigen::Vector3d::UnitY(), 3.14159), frame), 0);
}

}  // namespace
}  // namespace resight
