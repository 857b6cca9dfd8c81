// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "resight/core/options.hpp"
#include "resight/rendering/residual_distortion.hpp"

namespace resight {

/// Errors of a depth camera that are not independent from pixel to pixel: calibration errors, which are the same in
/// every view, and noise and holes that are correlated over neighbouring pixels. Each effect is off by default.
struct DepthErrors {
  double shift_u_px = 0;
  double shift_v_px = 0;
  ResidualDistortion lens = {};
  double disparity_offset_px = 0;
  double disparity_noise_px = 0;
  double disparity_noise_cell_px = 6;
  double outline_noise_px = 0;
  double outline_noise_cell_px = 5;
  double edge_band_px = 0;
  double edge_loss = 0.7;
  double grazing_start_deg = 90;
  double highlight_loss = 0;
  double dark_loss = 0;
  double dark_level = 0.12;
  double hole_cell_px = 4;
  void check() const { check_options("DepthErrors", *this); }
};

inline void declare(OptionVisitor& v, DepthErrors& o) {
  v.field("shift_u_px", o.shift_u_px, between(-10, 10),
          "Columns by which depth is shifted against colour: the error of their extrinsic calibration.",
          "1 to 2 px after factory calibration, Herrera et al. 2012");
  v.field("shift_v_px", o.shift_v_px, between(-10, 10), "Rows by which depth is shifted against colour.",
          "Herrera et al. 2012");
  v.group("lens", o.lens);
  v.field("disparity_offset_px", o.disparity_offset_px, between(-2, 2),
          "Constant error of the disparity. The error of depth grows with the square of depth: 0.05 px of a Kinect are "
          "1.3 mm at 1 m and 11 mm at 3 m.",
          "Khoshelham and Elberink 2012; Smisek et al. 2011");
  v.field("disparity_noise_px", o.disparity_noise_px, between(0, 2),
          "Sigma of the correlated noise of the disparity; 0: off.",
          "0.06 px from the 4 cm at 5 m of Khoshelham and Elberink 2012");
  v.field("disparity_noise_cell_px", o.disparity_noise_cell_px, between(1, 200),
          "Distance of the independent values between which that noise is interpolated: the size of the matched "
          "window.",
          "9 x 9 or 9 x 7 px, Konolige and Mihelich 2012");
  v.field("outline_noise_px", o.outline_noise_px, between(0, 10),
          "Sigma of the correlated displacement of what a pixel measures, which makes outlines ragged; 0: off.");
  v.field("outline_noise_cell_px", o.outline_noise_cell_px, between(1, 200),
          "Distance of the independent values between which that displacement is interpolated.");
  v.field("edge_band_px", o.edge_band_px, between(0, 50),
          "Distance from a depth discontinuity up to which returns are lost; 0: off.");
  v.field("edge_loss", o.edge_loss, between(0, 1),
          "Probability of no return at the discontinuity. It falls to 0 at the end of the band.");
  v.field("grazing_start_deg", o.grazing_start_deg, between(0, 90),
          "Incidence from which returns are lost. The probability rises to 1 at SensorOptions.max_incidence_deg. 90: "
          "off.");
  v.field("highlight_loss", o.highlight_loss, between(0, 10),
          "Probability of no return per strength of the projector's highlight on a glossy surface; 0: off.");
  v.field("dark_loss", o.dark_loss, between(0, 1), "Probability of no return from a black surface; 0: off.");
  v.field("dark_level", o.dark_level, between(0.001, 1),
          "Share of white from which a surface is bright enough. Below, the probability of no return rises linearly.");
  v.field("hole_cell_px", o.hole_cell_px, between(1, 200), "Size of the holes.");
}

}  // namespace resight
