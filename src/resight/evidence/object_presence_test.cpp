// SPDX-License-Identifier: Apache-2.0
#include "resight/evidence/object_presence.hpp"

#include <gtest/gtest.h>

#include "resight/models/testing/square_world.hpp"

namespace resight {
namespace {

using test::make_plate;
using test::plate_at;
using test::see_nothing;
using test::see_plates;

TEST(AssessPresence, AnObjectThatIsThereIsPresent) {
  const Rigid3 pose = plate_at(0, 0, 1);
  const ObjectPresence presence = assess_presence(make_plate("p").surface, pose, see_plates({pose}));
  EXPECT_TRUE(presence.is_informative);
  EXPECT_FALSE(presence.is_gone);
  EXPECT_GT(presence.count[static_cast<int>(Evidence::kPresent)], 2000);
}

TEST(AssessPresence, FreeSpaceMeansGone) {
  const ObjectPresence presence = assess_presence(make_plate("p").surface, plate_at(0, 0, 1), see_plates({}));
  EXPECT_TRUE(presence.is_gone);
  EXPECT_DOUBLE_EQ(presence.gone_share, 1.0);
}

TEST(AssessPresence, BehindSomethingNothingIsKnown) {
  const ObjectPresence presence =
      assess_presence(make_plate("p").surface, plate_at(0, 0, 1), see_plates({plate_at(0, 0, 0.6)}));
  EXPECT_FALSE(presence.is_informative);
  EXPECT_FALSE(presence.is_gone);
  EXPECT_GT(presence.count[static_cast<int>(Evidence::kOccluded)], 2000);
}

TEST(AssessPresence, NoReturnIsNoEvidence) {
  const ObjectPresence presence = assess_presence(make_plate("p").surface, plate_at(0, 0, 1), see_nothing());
  EXPECT_FALSE(presence.is_gone);
  EXPECT_EQ(presence.count[static_cast<int>(Evidence::kSeenThrough)], 0);
  EXPECT_GT(presence.count[static_cast<int>(Evidence::kUnobserved)], 2000);
}

TEST(AssessPresence, OutsideTheViewNothingIsKnown) {
  EXPECT_FALSE(assess_presence(make_plate("p").surface, plate_at(5, 0, 1), see_plates({})).is_informative);
  EXPECT_FALSE(assess_presence(make_plate("p").surface, plate_at(0, 0, -1), see_plates({})).is_informative);
}

TEST(AssessPresence, ABackFaceIsNotAsked) {
  PointCloud turned = make_plate("p").surface;
  for (Eigen::Vector3f& n : turned.normals) n = -n;
  const ObjectPresence presence = assess_presence(turned, plate_at(0, 0, 1), see_plates({}));
  EXPECT_EQ(presence.count[0] + presence.count[1] + presence.count[2] + presence.count[3], 0);
}

TEST(AssessPresence, RefusesNonsense) {
  PresenceOptions options;
  options.margin.base_m = -1;
  EXPECT_THROW((void)assess_presence({}, {}, see_plates({}), options), std::invalid_argument);
}

}  // namespace
}  // namespace resight
