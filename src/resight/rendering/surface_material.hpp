// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "resight/core/options.hpp"

namespace resight {

/// How a surface reflects light, besides its colour. The default is matte, and every ray of a depth camera returns.
struct SurfaceMaterial {
  double specular = 0;
  double shininess = 40;
  double depth_return = 1;
  void check() const { check_options("SurfaceMaterial", *this); }
};

inline void declare(OptionVisitor& v, SurfaceMaterial& o) {
  v.field("specular", o.specular, between(0, 4),
          "Brightness of the highlight of a white lamp of intensity 1, relative to a white surface. 0: matte.",
          "Blinn 1977");
  v.field("shininess", o.shininess, between(1, 2000),
          "Exponent of the highlight. 10 is satin, 200 is glazed ceramic or glass.", "Blinn 1977");
  v.field("depth_return", o.depth_return, between(0, 1),
          "Share of the surface that a depth camera measures. Glass and clear plastic return almost nothing.");
}

}  // namespace resight
