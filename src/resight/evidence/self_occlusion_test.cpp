// SPDX-License-Identifier: Apache-2.0
#include "resight/evidence/self_occlusion.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

namespace resight {
namespace {

constexpr float kFocal_px = 500;
constexpr float kSpacing_m = 0.005F;

ProjectedPoint project(float x, float y, float z, float viewing_cosine = 1) {
  return {kFocal_px * x / z + 320, kFocal_px * y / z + 240, z, viewing_cosine};
}

TEST(SelfOcclusion, AFrontBoardHidesTheBoardBehindIt) {
  std::vector<ProjectedPoint> points;
  for (int i = -10; i <= 10; ++i)
    for (int j = -10; j <= 10; ++j) {
      points.push_back(project(kSpacing_m * static_cast<float>(i), kSpacing_m * static_cast<float>(j), 0.8F));
      points.push_back(project(kSpacing_m * static_cast<float>(i) + 0.05F, kSpacing_m * static_cast<float>(j), 0.9F));
    }
  const SelfOcclusion self(points, kFocal_px, kSpacing_m);
  const float edge_u = project(0.05F, 0, 0.8F).u;
  int num_hidden = 0;
  for (const ProjectedPoint& p : points) {
    if (p.z > 0.85F && std::abs(p.u - edge_u) < 7) continue;  // About a cell.
    EXPECT_EQ(self.hides(p), p.z > 0.85F && p.u < edge_u);
    num_hidden += self.hides(p) ? 1 : 0;
  }
  EXPECT_GT(num_hidden, 100);
}

TEST(SelfOcclusion, AnObliquePlaneDoesNotHideItself) {
  for (const float angle_deg : {0.0F, 45.0F, 70.0F, 80.0F}) {
    const float angle = angle_deg * std::numbers::pi_v<float> / 180;
    std::vector<ProjectedPoint> points;
    for (int i = -15; i <= 15; ++i)
      for (int j = -15; j <= 15; ++j) {
        const float along = kSpacing_m * static_cast<float>(i);
        const float x = along * std::cos(angle), y = kSpacing_m * static_cast<float>(j);
        const float z = 1 + along * std::sin(angle);
        const float cosine = (std::cos(angle) * z - std::sin(angle) * x) / std::sqrt(x * x + y * y + z * z);
        points.push_back(project(x, y, z, cosine));
      }
    const SelfOcclusion self(points, kFocal_px, kSpacing_m);
    for (const ProjectedPoint& p : points) EXPECT_FALSE(self.hides(p)) << angle_deg;
  }
}

TEST(SelfOcclusion, PointsBehindTheCameraNeitherHideNorAreHidden) {
  const std::vector<ProjectedPoint> points{project(0, 0, 1), {.u = 320, .v = 240, .z = -1}};
  const SelfOcclusion self(points, kFocal_px, kSpacing_m);
  for (const ProjectedPoint& p : points) EXPECT_FALSE(self.hides(p));
  const std::vector<ProjectedPoint> none{{.z = -1}};
  EXPECT_FALSE(SelfOcclusion(none, kFocal_px, kSpacing_m).hides(none.front()));
  EXPECT_NO_THROW(SelfOcclusion({}, kFocal_px, kSpacing_m));
}

TEST(SelfOcclusion, PointsFarApartNeedNoLargeBuffer) {  // One point close to the camera, at a position of 10^7 px.
  const std::vector<ProjectedPoint> points{project(20, 10, 0.0011F), project(0, 0, 1), project(0, 0, 1.2F)};
  const SelfOcclusion self(points, kFocal_px, kSpacing_m);
  EXPECT_FALSE(self.hides(points[0]));
}

}  // namespace
}  // namespace resight
