// SPDX-License-Identifier: Apache-2.0
#include "resight/io/internal/polygon.hpp"

#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace resight {
namespace {

using testing::ElementsAre;
using Corners = std::vector<Eigen::Vector3f>;
using Triangle = std::array<int, 3>;

/// The area on the side of the normal minus that on the other side, and their sum.
std::pair<double, double> areas(const Corners& polygon, const Eigen::Vector3f& normal) {
  double net = 0;
  double total = 0;
  for (const auto& [a, b, c] : io::triangulate(polygon)) {
    const double area = (polygon[b] - polygon[a]).cross(polygon[c] - polygon[a]).dot(normal) / 2;
    net += area;
    total += std::abs(area);
  }
  return {net, total};
}

TEST(Polygon, AConvexOneIsAFan) {
  EXPECT_THAT(io::triangulate(Corners{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}), ElementsAre(Triangle{0, 1, 2}));
  EXPECT_THAT(io::triangulate(Corners{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}),
              ElementsAre(Triangle{0, 1, 2}, Triangle{0, 2, 3}));
  EXPECT_THAT(io::triangulate(Corners{{5, 0, 0}, {5, 0, 1}, {5, 1, 2}, {5, 2, 1}, {5, 1, 0}}),
              ElementsAre(Triangle{0, 1, 2}, Triangle{0, 2, 3}, Triangle{0, 3, 4}));
}

TEST(Polygon, AConcaveOneIsCutInside) {
  const Corners arrow = {{0, 0, 0}, {1, 0, 0}, {0.2F, 0.2F, 0}, {0, 1, 0}};
  const Corners letter_l = {{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, 1, 0}, {1, 2, 0}, {0, 2, 0}};
  // A square with a square hole, which a bridge joins to the outer ring.
  const Corners frame = {{0, 0, 0}, {3, 0, 0}, {3, 3, 0}, {0, 3, 0}, {0, 0, 0},
                         {1, 1, 0}, {1, 2, 0}, {2, 2, 0}, {2, 1, 0}, {1, 1, 0}};
  for (const auto& [shape, area] : {std::pair{arrow, 0.2}, {letter_l, 3.0}, {frame, 8.0}})
    for (std::size_t start = 0; start < shape.size(); ++start) {
      Corners polygon = shape;
      std::rotate(polygon.begin(), polygon.begin() + static_cast<std::ptrdiff_t>(start), polygon.end());
      const auto [net, total] = areas(polygon, {0, 0, 1});
      EXPECT_NEAR(net, area, 1e-6) << start;
      EXPECT_NEAR(total, area, 1e-6) << start;
    }
}

/// A ring of 500 corners outside and 500 inside, open on one side: most corners are reflex, and few are ears.
TEST(Polygon, ALargeConcaveOneIsCutInside) {
  constexpr int kHalf = 500;
  Corners polygon;
  const auto add = [&](float radius, int i) {
    const float angle = static_cast<float>(i) / kHalf * 6;
    polygon.emplace_back(radius * std::cos(angle), radius * std::sin(angle), 2.0F);
  };
  for (int i = 0; i < kHalf; ++i) add(1.0F, i);
  for (int i = kHalf; i-- > 0;) add(0.8F, i);
  const auto [net, total] = areas(polygon, {0, 0, 1});
  EXPECT_NEAR(net, 3 * (1 - 0.64), 0.01);
  EXPECT_NEAR(total, net, 1e-5);
}

TEST(Polygon, AnyNumbersGiveTriangles) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  constexpr float kMax = std::numeric_limits<float>::max();
  const Corners crossed = {{0, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, 1, 0}};
  for (const Corners& polygon : {crossed, Corners(5, {kNan, 0, 0}), Corners(6, {1, 1, 1}),
                                 Corners{{kMax, 0, 0}, {-kMax, kMax, 0}, {0, -kMax, kMax}, {kMax, kMax, kMax}}})
    EXPECT_EQ(io::triangulate(polygon).size(), polygon.size() - 2);
}

}  // namespace
}  // namespace resight
