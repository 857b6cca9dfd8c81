// SPDX-License-Identifier: Apache-2.0
#include "resight/simulation/seeded_objects.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "resight/simulation/baked_light.hpp"

namespace resight {
namespace {

Eigen::Vector3f extent(const TriangleMesh& mesh) {
  Eigen::Vector3f low = mesh.vertices.front();
  Eigen::Vector3f high = low;
  for (const Eigen::Vector3f& v : mesh.vertices) {
    low = low.cwiseMin(v);
    high = high.cwiseMax(v);
  }
  return high - low;
}

TEST(SeededObjects, SeedsShareNoName) {
  const SeededObjectNames one = seeded_object_names(1);
  const SeededObjectNames two = seeded_object_names(2);
  std::set<std::string> names(one.known.begin(), one.known.end());
  names.insert(one.unknown.begin(), one.unknown.end());
  EXPECT_EQ(names.size(), one.known.size() + one.unknown.size());
  EXPECT_GE(one.known.size(), 24U);
  EXPECT_GE(one.unknown.size(), 8U);
  for (const std::string& name : two.known) EXPECT_FALSE(names.contains(name)) << name;
  for (const std::string& name : two.unknown) EXPECT_FALSE(names.contains(name)) << name;
}

TEST(SeededObjects, AreSoundAndOfManyKinds) {
  const SeededObjectNames names = seeded_object_names(1);
  int plain = 0, symmetric = 0, glossy = 0, clear = 0, thin = 0, small = 0, twins = 0;
  for (const std::string& name : names.known) {
    const auto object = make_seeded_object(1, name);
    ASSERT_TRUE(object.ok()) << object.error().message;
    EXPECT_EQ(object->name, name);
    const Eigen::Vector3f size = extent(object->mesh);
    EXPECT_GT(size.minCoeff(), 0.008) << name;
    EXPECT_LT(size.maxCoeff(), 0.32) << name;
    float lowest = 1;
    for (const Eigen::Vector3f& v : object->mesh.vertices) {
      ASSERT_TRUE(v.allFinite()) << name;
      lowest = std::min(lowest, v.z());
    }
    EXPECT_NEAR(lowest, 0, 1e-4) << name;
    plain += object->kind == "plain" ? 1 : 0;
    twins += object->kind == "twin" ? 1 : 0;
    symmetric += object->symmetries.none() ? 0 : 1;
    glossy += object->material.specular > 0.3 ? 1 : 0;
    clear += object->material.depth_return < 0.5 ? 1 : 0;
    thin += size.minCoeff() < 0.04 ? 1 : 0;
    small += size.maxCoeff() < 0.065 ? 1 : 0;
  }
  EXPECT_GE(plain, 4);
  EXPECT_GE(symmetric, 4);
  EXPECT_GE(glossy, 5);
  EXPECT_GE(clear, 1);
  EXPECT_GE(thin, 2);
  EXPECT_GE(small, 1);
  EXPECT_EQ(twins, 2);
}

TEST(SeededObjects, FollowTheSeedAndNothingElse) {
  const SeededObjectNames names = seeded_object_names(7);
  const auto a = make_seeded_object(7, names.known[3]);
  const auto b = make_seeded_object(7, names.known[3]);
  ASSERT_TRUE(a.ok() && b.ok());
  EXPECT_EQ(a->mesh.vertices, b->mesh.vertices);
  EXPECT_EQ(a->mesh.texture, b->mesh.texture);
  const auto other = make_seeded_object(8, seeded_object_names(8).known[3]);
  ASSERT_TRUE(other.ok());
  EXPECT_NE(extent(a->mesh), extent(other->mesh));
  EXPECT_FALSE(make_seeded_object(8, names.known[3]).ok());
}

TEST(SeededObjects, WideCupsFitTheirTexture) {
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    const SeededObjectNames names = seeded_object_names(seed);
    for (const auto* list : {&names.known, &names.unknown})
      for (const std::string& name : *list)
        if (name.starts_with("cup")) {
          EXPECT_NO_THROW((void)make_seeded_object(seed, name)) << name << " of " << seed;
        }
  }
}

TEST(SeededObjects, TwinsAndLookAlikesShareOneProperty) {
  const SeededObjectNames names = seeded_object_names(3);
  const auto object = [&](const std::string& name) { return *make_seeded_object(3, name); };
  const ProceduralObject box = object(names.known[0]);
  const ProceduralObject twin = object(names.known[1]);
  EXPECT_EQ(box.mesh.vertices, twin.mesh.vertices);
  EXPECT_NE(box.mesh.texture, twin.mesh.texture);
  EXPECT_EQ(object(names.known[2]).mesh.vertices, object(names.unknown[0]).mesh.vertices);
  EXPECT_NE(object(names.known[3]).mesh.vertices, object(names.unknown[1]).mesh.vertices);
}

TEST(BakedLight, BrightensOneSideAndKeepsTheShape) {
  const SeededObjectNames names = seeded_object_names(3);
  for (const std::size_t i : {0, 20, 24}) {
    const ProceduralObject object = *make_seeded_object(3, names.known[i]);
    const TriangleMesh baked = bake_light(object, 5);
    EXPECT_EQ(baked.vertices, object.mesh.vertices);
    double lowest = 10, highest = 0;
    for (std::size_t f = 0; f < baked.faces.size(); f += 7) {
      const Rgb8 before = surface_color(object.mesh, static_cast<int>(f), 0.33F, 0.33F);
      const Rgb8 after = surface_color(baked, static_cast<int>(f), 0.33F, 0.33F);
      if (before.r + before.g + before.b < 150) continue;
      const double ratio = static_cast<double>(after.r + after.g + after.b) / (before.r + before.g + before.b);
      lowest = std::min(lowest, ratio);
      highest = std::max(highest, ratio);
    }
    EXPECT_LT(lowest, 0.7) << object.name;
    EXPECT_GT(highest, 0.85) << object.name;
  }
}

}  // namespace
}  // namespace resight
