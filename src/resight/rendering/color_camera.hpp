// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <cstdint>

#include "resight/core/image.hpp"
#include "resight/core/options.hpp"

namespace resight {

/// How a colour camera adapts to the light. The defaults leave it as it is.
struct ExposureControl {
  double factor = 1;
  double metering = 0;
  double metering_target = 0.18;
  double white_balancing = 0;
  double red_gain = 1;
  double blue_gain = 1;
  void check() const { check_options("ExposureControl", *this); }
};

inline void declare(OptionVisitor& v, ExposureControl& o) {
  v.field("factor", o.factor, positive(), "Factor on the light of every view.");
  v.field("metering", o.metering, between(0, 1),
          "Share of the automatic exposure: 0 keeps the exposure, 1 brings the mean of each view to metering_target.");
  v.field("metering_target", o.metering_target, between(0.01, 1),
          "Mean of a metered view, as a share of the brightest light.", "18 % grey card");
  v.field("white_balancing", o.white_balancing, between(0, 1),
          "Share of the automatic white balance: 0 keeps the colours, 1 makes the mean of each view grey.",
          "grey world, Buchsbaum 1980");
  v.field("red_gain", o.red_gain, positive(), "Error of the white balance of red, relative to green.",
          "up to 20 % in warm light, Cheng et al. 2014");
  v.field("blue_gain", o.blue_gain, positive(), "Error of the white balance of blue, relative to green.",
          "up to 20 % in warm light, Cheng et al. 2014");
}

/// The image processing of a colour camera, in the order of its steps. Each step can be off (value in its text).
struct ColorCamera {
  ExposureControl exposure = {};
  double blur_px = 0;
  double motion_blur_px = 0;
  bool mosaic = false;
  double read_noise = 0;
  double shot_noise = 0;
  double noise_reduction = 0;
  double contrast = 0;
  double sharpening = 0;
  double saturation = 1;
  int jpeg_quality = 100;
  void check() const { check_options("ColorCamera", *this); }
};

inline void declare(OptionVisitor& v, ColorCamera& o) {
  v.group("exposure", o.exposure);
  v.field("blur_px", o.blur_px, between(0, 5), "Sigma of the blur of lens and pixel; 0: off.");
  v.field("motion_blur_px", o.motion_blur_px, between(0, 50),
          "Sigma of the path of the image while a view is exposed, per axis; 0: off.");
  v.field("mosaic", o.mosaic,
          "Each pixel measures one colour (Bayer pattern RGGB), and the others are interpolated linearly.");
  v.field("read_noise", o.read_noise, between(0, 1), "Sigma of the noise without light, as a share of full light.",
          "EMVA 1288");
  v.field("shot_noise", o.shot_noise, between(0, 1),
          "Sigma of the noise at full light, as a share of it; the variance is proportional to the light.",
          "EMVA 1288; 0.014 for 5000 electrons");
  v.field("noise_reduction", o.noise_reduction, between(0, 255),
          "Difference in grey levels below which neighbours are averaged (5 x 5 bilateral filter); 0: off.",
          "Tomasi and Manduchi 1998");
  v.field("contrast", o.contrast, between(0, 1),
          "Share of an S-shaped tone curve, applied after the gamma curve of sRGB; 0: off.");
  v.field("sharpening", o.sharpening, between(0, 5),
          "Factor on the difference between brightness and its blur of 1 px, which is added: overshoot at edges; 0: "
          "off.");
  v.field("saturation", o.saturation, between(0, 5), "Factor on the distance from grey; 1: off.");
  v.field("jpeg_quality", o.jpeg_quality, between(1, 100),
          "Quality of the compression (libjpeg's scale, colour at half resolution); 100: off.", "ITU-T T.81, Annex K");
}

/// Light per pixel and channel; 1 is full light, more is clipped by the camera.
using LightImage = Image<Eigen::Vector3f>;

/// The colour image that the camera delivers of linear light. `gains` are factors on the channels of this view. Same
/// bytes for any number of threads.
[[nodiscard]] Image<Rgb8> develop_color(const LightImage& light, const ColorCamera& camera,
                                        const Eigen::Vector3f& gains, std::uint64_t seed, int num_threads = 1);

}  // namespace resight
