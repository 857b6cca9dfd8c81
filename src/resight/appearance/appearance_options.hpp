// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>

#include "resight/appearance/photometric_fit.hpp"
#include "resight/core/options.hpp"

namespace resight {

/// How colours of a model and of the scene are compared.
struct AppearanceOptions {
  bool use_color = true;
  double sigma_l = 0.4;
  double sigma_ab = 0.2;
  double sigma_saturation = 0;
  double chroma_weight = 2;
  std::optional<double> pattern_radius_m{};
  PhotometricLimits light{};
};

inline void declare(OptionVisitor& v, AppearanceOptions& o) {
  v.field("use_color", o.use_color, "Off: models and scene are compared by shape alone.");
  v.only_if(o.use_color, "use_color", "true", [&] {
    v.field(
        "sigma_l", o.sigma_l, between(1e-3, 1000),
        "Standard deviation of lightness, (L* - 50) / 50, of each of two colours that are compared, after the model's "
        "are adapted to the light.",
        "ours; V4R: 0.6");
    v.field("sigma_ab", o.sigma_ab, between(1e-3, 1000),
            "Standard deviation of chromaticity, a* / 128 and b* / 128, of each of two colours.", "ours; V4R: 0.6");
    v.field(
        "sigma_saturation", o.sigma_saturation, between(0, 2),
        "Standard deviation of saturation, as a share of it: adds to sigma_ab where the model is colourful, because "
        "cameras and gloss scale saturation. 0: the tolerance is that of grey.",
        "ours");
    v.field("chroma_weight", o.chroma_weight, positive(),
            "Weight of a* and b* beside L* where patterns of colours are compared: light changes L* more.", "ours");
    v.field("pattern_radius_m", o.pattern_radius_m, positive(),
            "Verification compares the patterns of untextured models after both colours are averaged over the surface "
            "within this radius, relative to their mean within three radii: noise, sharpening, small highlights and "
            "light that changes slowly are no texture. off: as they are.",
            "ours");
    v.group("light", o.light);
  });
}

}  // namespace resight
