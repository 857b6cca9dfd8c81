// SPDX-License-Identifier: Apache-2.0
#include "resight/models/object_model.hpp"

#include <gtest/gtest.h>

#include <stdexcept>
#include <tuple>

#include "resight/models/testing/square_world.hpp"

namespace resight {
namespace {

TEST(ModelLibrary, ObjectsAreFoundByNameAndByIndex) {
  ModelLibrary library;
  library.objects = {test::make_plate("a"), test::make_plate("b")};
  EXPECT_EQ(library.find("b"), 1);
  EXPECT_EQ(library.find("c"), -1);
  EXPECT_EQ(library.object(1).name, "b");
  EXPECT_THROW(std::ignore = library.object(2), std::invalid_argument);
  EXPECT_THROW(std::ignore = library.object(-1), std::invalid_argument);
}

}  // namespace
}  // namespace resight
