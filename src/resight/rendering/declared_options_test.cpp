// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "resight/rendering/color_camera.hpp"
#include "resight/rendering/depth_errors.hpp"
#include "resight/rendering/surface_material.hpp"

namespace resight {
namespace {

class MissingFields final : public OptionVisitor {
 public:
  int num_missing = 0;

 protected:
  void visit(const OptionDeclaration& /*option*/) override {}
  void end_struct(int num_declared, int num_fields) override { num_missing += num_fields - num_declared; }
};

template <typename Options>
int count_missing() {
  Options options;
  MissingFields visitor;
  visitor.visit_struct(options);
  return visitor.num_missing;
}

TEST(RenderingOptions, DeclareAllFields) {
  EXPECT_EQ(count_missing<DepthErrors>(), 0);
  EXPECT_EQ(count_missing<ColorCamera>(), 0);
  EXPECT_EQ(count_missing<SurfaceMaterial>(), 0);
}

}  // namespace
}  // namespace resight
