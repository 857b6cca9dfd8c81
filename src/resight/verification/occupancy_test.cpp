// SPDX-License-Identifier: Apache-2.0
#include "resight/verification/occupancy.hpp"

#include <gtest/gtest.h>

#include <set>
#include <tuple>

#include "resight/core/random.hpp"
#include "resight/geometry/voxel_key.hpp"
#include "resight/verification/testing/analytic_scene.hpp"

namespace resight {
namespace {

using namespace analytic;

std::set<std::tuple<int, int, int>> voxels_of(const PlacedModel& model, float voxel_m) {
  std::set<std::tuple<int, int, int>> voxels;
  for (const Eigen::Vector3f& p : transform(model.world_from_object, *model.surface_in_object).points) {
    const Eigen::Vector3i v = voxel_index(p, 1 / voxel_m);
    voxels.emplace(v.x(), v.y(), v.z());
  }
  return voxels;
}

TEST(CountSharedVoxels, AgreesWithSetsWhereNormalsDoNotMatter) {
  PointCloud sphere = sample_surface({Shape::kSphere, {0.1, 0.1, 0.1}, plain({}), {}}, 0.003);
  sphere.normals.clear();
  Rng rng(1);
  std::vector<PlacedModel> models;
  for (int i = 0; i < 6; ++i)
    models.push_back({&sphere, Rigid3::from_translation(
                                   {rng.uniform(-0.06, 0.06), rng.uniform(-0.06, 0.06), rng.uniform(-0.06, 0.06)})});
  const std::vector<SharedVoxels> pairs = count_shared_voxels(models, 0.005, 1);
  int checked = 0;
  for (int a = 0; a < 6; ++a)
    for (int b = a + 1; b < 6; ++b) {
      const auto voxels_a = voxels_of(models[a], 0.005F);
      const auto voxels_b = voxels_of(models[b], 0.005F);
      int expected = 0;
      for (const auto& v : voxels_a) expected += static_cast<int>(voxels_b.count(v));
      int found = 0;
      for (const SharedVoxels& pair : pairs)
        if (pair.a == a && pair.b == b) found = pair.count;
      EXPECT_EQ(found, expected);
      if (expected > 0) ++checked;
    }
  EXPECT_GT(checked, 5);
}

TEST(CountSharedVoxels, ContactIsNoPenetration) {
  const PointCloud box = sample_surface({Shape::kBox, {0.1, 0.1, 0.1}, plain({}), {}}, 0.003);
  const auto shared = [&](double shift) {
    const std::vector<PlacedModel> models = {{&box, Rigid3::from_translation({0.0011, 0.0012, 0.0013})},
                                             {&box, Rigid3::from_translation({0.0011 + shift, 0.0012, 0.0013})}};
    const auto pairs = count_shared_voxels(models, 0.005, 2);
    return pairs.empty() ? 0 : pairs[0].count;
  };
  const int same = shared(0);
  EXPECT_GT(same, 2000);
  EXPECT_LT(shared(0.1), 0.06 * same);  // Face to face: only the rims.
  EXPECT_GT(shared(0.05), 0.3 * same);  // Half into each other: the sides coincide.
  EXPECT_EQ(shared(0.2), 0);
}

}  // namespace
}  // namespace resight
