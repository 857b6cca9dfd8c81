// SPDX-License-Identifier: Apache-2.0
#include "resight/simulation/procedural_objects.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "resight/core/hash.hpp"
#include "resight/core/random.hpp"
#include "resight/geometry/kd_tree.hpp"
#include "resight/rendering/raycast_scene.hpp"
#include "resight/simulation/room.hpp"

namespace resight {
namespace {

const std::vector<ProceduralObject>& objects() {
  static const std::vector<ProceduralObject> all = procedural_objects(2);
  return all;
}

std::uint64_t hash_of(const TriangleMesh& mesh) {
  const auto bytes = [](const auto& items, std::uint64_t seed) {
    const auto* data = reinterpret_cast<const std::uint8_t*>(items.data());
    return hash_bytes({data, items.size() * sizeof(items[0])}, seed);
  };
  return bytes(mesh.texture.data(),
               bytes(mesh.colors, bytes(mesh.faces, bytes(mesh.uvs, bytes(mesh.vertices, kHashSeed)))));
}

struct Bounds {
  Eigen::Vector3f low, high;
};
Bounds bounds_of(const TriangleMesh& mesh) {
  Bounds b{mesh.vertices.front(), mesh.vertices.front()};
  for (const auto& v : mesh.vertices) {
    b.low = b.low.cwiseMin(v);
    b.high = b.high.cwiseMax(v);
  }
  return b;
}

TEST(ProceduralObjects, AreManyRealisticAndStandOnTheirOrigin) {
  ASSERT_GE(objects().size(), 20U);
  ASSERT_EQ(objects().size(), procedural_object_names().size());
  for (std::size_t i = 0; i < objects().size(); ++i) {
    const ProceduralObject& o = objects()[i];
    SCOPED_TRACE(o.name);
    EXPECT_EQ(o.name, procedural_object_names()[i]);
    const Bounds b = bounds_of(o.mesh);
    EXPECT_NEAR(b.low.z(), 0, 1e-5);
    const float size = (b.high - b.low).maxCoeff();
    EXPECT_GT(size, 0.05F);
    EXPECT_LE(size, 0.31F);
    EXPECT_LT((b.low + b.high).head<2>().norm(), 0.05F);  // handles extend to one side
    EXPECT_GE(o.mesh.faces.size(), 1400U);
    EXPECT_LE(o.mesh.faces.size(), 20000U);
    EXPECT_EQ(o.mesh.normals.size(), o.mesh.vertices.size());
    EXPECT_EQ(o.kind == "plain", o.mesh.texture.empty());
    if (o.mesh.has_texture()) {
      EXPECT_GE(o.mesh.texture.width(), 256);
      for (const auto& uv : o.mesh.uvs) EXPECT_TRUE(uv.minCoeff() > 0 && uv.maxCoeff() < 1);
    } else {
      EXPECT_EQ(o.mesh.colors.size(), o.mesh.vertices.size());
    }
  }
}

TEST(ProceduralObjects, AreTheSameEachTimeAndAllDifferent) {
  std::set<std::uint64_t> hashes;
  for (const ProceduralObject& o : objects()) {
    const auto again = make_procedural_object(o.name);
    ASSERT_TRUE(again.ok());
    EXPECT_EQ(hash_of(o.mesh), hash_of(again->mesh)) << o.name;
    hashes.insert(hash_of(o.mesh));
  }
  EXPECT_EQ(hashes.size(), objects().size());
}

TEST(ProceduralObjects, TwinsDifferOnlyInPrint) {
  for (const auto& [a, b] : {std::pair{"cereal_red", "cereal_blue"}, std::pair{"soup_tomato", "soup_pea"}}) {
    const auto first = make_procedural_object(a);
    const auto second = make_procedural_object(b);
    EXPECT_EQ(first->mesh.vertices, second->mesh.vertices);
    ASSERT_EQ(first->mesh.texture.size(), second->mesh.texture.size());
    std::size_t different = 0;
    for (std::size_t i = 0; i < first->mesh.texture.size(); ++i) {
      const Rgb8 p = first->mesh.texture[i], q = second->mesh.texture[i];
      different += std::abs(p.r - q.r) + std::abs(p.g - q.g) + std::abs(p.b - q.b) > 60;
    }
    EXPECT_GT(different, first->mesh.texture.size() / 3);
  }
}

// Rays from all around hit front faces first: the visible surface is closed and its faces are wound outwards.
void expect_outward(const TriangleMesh& mesh) {
  RaycastScene scene;
  scene.add_instance(scene.add_mesh(mesh), Rigid3::identity());
  scene.commit();
  const Bounds b = bounds_of(mesh);
  const Eigen::Vector3f center = 0.5F * (b.low + b.high);
  const float radius = (b.high - b.low).norm();
  Rng rng(11);
  int hits = 0;
  int back_faces = 0;
  int wrong_shading = 0;
  for (int i = 0; i < 4000; ++i) {
    const Eigen::Vector3f from = Eigen::Vector3d{rng.normal(), rng.normal(), rng.normal()}.normalized().cast<float>();
    const Eigen::Vector3f target =
        center +
        0.3F * radius * Eigen::Vector3d{rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1)}.cast<float>();
    const Ray ray{center + 2 * radius * from, target - (center + 2 * radius * from)};
    const RayHit hit = scene.cast(ray);
    if (!hit.has_hit()) continue;
    ++hits;
    const Eigen::Vector3f direction = ray.direction.normalized();
    back_faces += scene.face_normal(hit).dot(direction) > 1e-3F;
    wrong_shading += scene.shading_normal(hit).dot(scene.face_normal(hit)) < 0.5F;
  }
  EXPECT_GT(hits, 800);
  EXPECT_EQ(back_faces, 0);
  EXPECT_LE(wrong_shading, hits / 100);
}

TEST(ProceduralObjects, AreClosedAndWoundOutwards) {
  for (const ProceduralObject& o : objects()) {
    SCOPED_TRACE(o.name);
    expect_outward(o.mesh);
  }
  for (const std::string& name : distractor_names()) {
    SCOPED_TRACE(name);
    expect_outward(make_distractor(name)->mesh);
  }
}

TEST(ProceduralObjects, SymmetriesMapThemOntoThemselves) {
  int symmetric = 0;
  for (const ProceduralObject& o : objects()) {
    if (o.symmetries.none()) continue;
    ++symmetric;
    SCOPED_TRACE(o.name);
    EXPECT_EQ(o.kind, "plain");
    EXPECT_EQ(std::set<int>({o.mesh.colors.front().r}), [&] {
      std::set<int> reds;
      for (const Rgb8 c : o.mesh.colors) reds.insert(c.r);
      return reds;
    }());
    RaycastScene scene;
    scene.add_instance(scene.add_mesh(o.mesh), Rigid3::identity());
    scene.commit();
    const Bounds b = bounds_of(o.mesh);
    Rng rng(12);
    int compared = 0;
    for (const Rigid3& motion : enumerate_symmetries(o.symmetries, 1.0)) {
      // Equal rays before and after the motion have equal lengths.
      for (int i = 0; i < 60; ++i) {
        const Eigen::Vector3d origin = Eigen::Vector3d{rng.normal(), rng.normal(), rng.normal()}.normalized();
        const Eigen::Vector3d target =
            (0.5F * (b.low + b.high)).cast<double>() + 0.02 * Eigen::Vector3d{rng.normal(), rng.normal(), rng.normal()};
        const Eigen::Vector3d direction = target - origin;
        const RayHit one = scene.cast({origin.cast<float>(), direction.cast<float>()});
        const RayHit other = scene.cast({(motion * origin).cast<float>(), (motion.rotation * direction).cast<float>()});
        if (!one.has_hit() || !other.has_hit()) continue;
        // on the other side, a ray through the rim of the bowl may miss it, because polygons have 64 sides
        compared += std::abs(one.distance - other.distance) < 1e-3F;
        EXPECT_LT(std::abs(one.distance - other.distance), 0.1F);
      }
    }
    EXPECT_GT(compared, 150);
  }
  EXPECT_GE(symmetric, 4);
}

TEST(ProceduralObjects, ThoseCalledAsymmetricAreNot) {
  // A half turn about z changes the shape of the mug (handle) and the texture of the cereal box.
  const auto mug = make_procedural_object("plain_mug");
  EXPECT_TRUE(mug->symmetries.none());
  const KdTree tree(mug->mesh.vertices);
  float farthest = 0;
  for (const auto& v : mug->mesh.vertices)
    farthest = std::max(farthest, tree.nearest({-v.x(), -v.y(), v.z()}).distance_sq);
  EXPECT_GT(std::sqrt(farthest), 0.01F);
}

TEST(ProceduralObjects, UnknownNamesAreErrorsThatListTheKnown) {
  const auto object = make_procedural_object("unobtainium");
  ASSERT_FALSE(object.ok());
  EXPECT_NE(object.error().message.find("cereal_red"), std::string::npos);
  EXPECT_FALSE(make_distractor("cereal_red").ok());
  EXPECT_FALSE(make_furniture("throne", {1, 1, 1}, 1).ok());
  EXPECT_THROW(static_cast<void>(make_furniture("table", {1, 0, 1}, 1)), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(make_furniture("table", {1, 11, 1}, 1)), std::invalid_argument);
}

TEST(Furniture, HasItsSizeAndLevels) {
  for (const std::string& kind : furniture_kinds()) {
    SCOPED_TRACE(kind);
    const Eigen::Vector3d size(0.8, 0.4, 0.6);
    const auto furniture = make_furniture(kind, size, 5);
    ASSERT_TRUE(furniture.ok());
    const Bounds b = bounds_of(furniture->mesh);
    EXPECT_LT((b.high - b.low - size.cast<float>()).cwiseAbs().maxCoeff(), 0.02F);
    EXPECT_NEAR(b.low.z(), 0, 1e-6);
    for (const double level : furniture->level_heights_m) EXPECT_LE(level, size.z() + 1e-9);
  }
}

bool is_textured(const TriangleMesh& mesh) {
  return !mesh.texture.empty() && std::ranges::all_of(mesh.uvs, [](const Eigen::Vector2f& uv) {
    return uv.minCoeff() >= 0 && uv.maxCoeff() <= 1;
  });
}

TEST(Furniture, OfAnySizeOfAScriptHasATexture) {
  for (const std::string& kind : furniture_kinds())
    for (const Eigen::Vector3d& size :
         {Eigen::Vector3d(3, 0.5, 2.5), Eigen::Vector3d(1, 0.7, 10), Eigen::Vector3d(10, 10, 10),
          Eigen::Vector3d(0.001, 0.001, 0.001), Eigen::Vector3d(1, 0.01, 0.01)}) {
      SCOPED_TRACE(kind);
      const auto furniture = make_furniture(kind, size, 5);
      ASSERT_TRUE(furniture.ok());
      EXPECT_TRUE(is_textured(furniture->mesh)) << size.transpose();
    }
  for (const Eigen::Vector3d& size : {Eigen::Vector3d(5, 5, 5), Eigen::Vector3d(0.001, 0.001, 1000)})
    EXPECT_TRUE(is_textured(make_room(size, 5))) << size.transpose();
}

}  // namespace
}  // namespace resight
