// SPDX-License-Identifier: Apache-2.0
#include "resight/verification/lab_color.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace resight {
namespace {

struct Known {
  Rgb8 rgb;
  double l, a, b;  // CIELAB (D65, 2 degrees), unscaled.
};

TEST(ToLab, AgreesWithPublishedValues) {
  const std::vector<Known> known = {{{0, 0, 0}, 0, 0, 0},
                                    {{255, 255, 255}, 100, 0, 0},
                                    {{255, 0, 0}, 53.24, 80.09, 67.20},
                                    {{0, 255, 0}, 87.73, -86.18, 83.18},
                                    {{0, 0, 255}, 32.30, 79.19, -107.86},
                                    {{119, 119, 119}, 50.03, 0, 0},
                                    {{10, 10, 10}, 2.74, 0, 0},
                                    {{255, 255, 0}, 97.14, -21.55, 94.48}};
  for (const Known& k : known) {
    const LabColor lab = to_lab(k.rgb);
    EXPECT_NEAR(50 * lab.l + 50, k.l, 0.05);
    EXPECT_NEAR(128 * lab.a, k.a, 0.1);
    EXPECT_NEAR(128 * lab.b, k.b, 0.1);
  }
}

TEST(FitExposure, RecoversGainAndShiftWithinItsLimits) {
  std::vector<float> model;
  std::vector<float> scene;
  for (int i = 0; i < 100; ++i) {
    model.push_back(0.005F * static_cast<float>(i) - 0.2F);
    scene.push_back(1.2F * model.back() - 0.15F);
  }
  const ExposureMap map = fit_exposure(model, scene, 0.3F, 1.5F);
  EXPECT_NEAR(map.gain, 1.2, 1e-4);
  EXPECT_NEAR(map.offset, -0.15, 1e-4);
  const std::vector<float> black(100, -0.9F);
  const std::vector<float> white(100, 0.9F);
  EXPECT_NEAR(fit_exposure(black, white, 0.3F, 1.5F)(-0.9F), -0.6, 1e-5);
  for (float& l : scene) l *= 10;
  EXPECT_NEAR(fit_exposure(model, scene, 0.3F, 1.5F).gain, 1.5, 1e-6);
}

TEST(FitExposure, LeavesFewSamplesAlone) {
  const std::vector<float> few(9, 0.5F);
  const std::vector<float> many(100, 0.1F);
  const ExposureMap map = fit_exposure(few, many, 0.3F, 1.5F);
  EXPECT_EQ(map.gain, 1);
  EXPECT_EQ(map.offset, 0);
}

}  // namespace
}  // namespace resight
