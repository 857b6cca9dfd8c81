// SPDX-License-Identifier: Apache-2.0
#include "resight/simulation/baked_light.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "resight/core/random.hpp"

namespace resight {
namespace {

using Eigen::Vector2f;
using Eigen::Vector3f;

constexpr float kHighlight = 160;    // grey levels per specular 1: scanners expose for the matte parts
constexpr float kMargin_px = 0.75F;  // texels beside a face belong to it, because look-ups interpolate

class Scanner {
 public:
  Scanner(const ProceduralObject& object, std::uint64_t seed) : object_(object), mesh_(object.mesh) {
    Rng rng(seed);
    const auto azimuth = static_cast<float>(rng.uniform(0, 2 * std::numbers::pi));
    const auto elevation = static_cast<float>(rng.uniform(0.5, 1.1));
    lamp_ = {std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth), std::sin(elevation)};
    if (mesh_.normals.size() != mesh_.vertices.size()) compute_vertex_normals(mesh_);
    for (const Vector3f& v : mesh_.vertices) height_m_ = std::max(height_m_, v.z());
  }

  TriangleMesh scan() {
    if (mesh_.has_texture()) {
      bake_texture();
    } else {
      for (std::size_t i = 0; i < mesh_.colors.size(); ++i)
        mesh_.colors[i] = lit(mesh_.colors[i], light_at(mesh_.vertices[i], mesh_.normals[i]));
    }
    mesh_.normals = object_.mesh.normals;
    return std::move(mesh_);
  }

 private:
  struct Light {
    float factor = 0;
    float highlight = 0;  // grey levels
    float count = 0;
  };

  [[nodiscard]] Light light_at(const Vector3f& p, const Vector3f& normal) const {
    const Vector3f n = normal.normalized();
    const float low = p.z() / std::max(1e-3F, height_m_);  // little light comes from the table
    const float ambient = 0.5F * (0.75F + 0.25F * low) * (0.85F + 0.15F * n.z());
    // The scanner looks along the normal.
    const float half = std::max(0.0F, n.dot((lamp_ + n).normalized()));
    return {ambient + 0.6F * std::max(0.0F, n.dot(lamp_)),
            kHighlight * static_cast<float>(object_.material.specular) *
                std::pow(half, 4 * static_cast<float>(object_.material.shininess)),
            1};
  }

  static Rgb8 lit(Rgb8 c, const Light& light) {
    const auto apply = [&](std::uint8_t x) {
      const float value = static_cast<float>(x) * light.factor / light.count + light.highlight / light.count;
      return static_cast<std::uint8_t>(std::clamp(value + 0.5F, 0.0F, 255.0F));
    };
    return {apply(c.r), apply(c.g), apply(c.b)};
  }

  // Faces may share texels, which then get their mean light.
  void bake_texture() {
    Image<Light> light(mesh_.texture.width(), mesh_.texture.height());
    for (const auto& face : mesh_.faces) add_face(face, light);
    for (std::size_t i = 0; i < light.size(); ++i)
      if (light[i].count > 0) mesh_.texture[i] = lit(mesh_.texture[i], light[i]);
  }

  void add_face(const std::array<int, 3>& face, Image<Light>& light) const {
    const Eigen::Array2f size(static_cast<float>(light.width()), static_cast<float>(light.height()));
    std::array<Vector2f, 3> px;
    for (int i = 0; i < 3; ++i) px[i] = (mesh_.uvs[face[i]].array() * size - 0.5F).matrix();
    const Vector2f low = px[0].cwiseMin(px[1]).cwiseMin(px[2]);
    const Vector2f high = px[0].cwiseMax(px[1]).cwiseMax(px[2]);
    for (int v = static_cast<int>(std::floor(low.y())); v <= static_cast<int>(std::ceil(high.y())); ++v)
      for (int u = static_cast<int>(std::floor(low.x())); u <= static_cast<int>(std::ceil(high.x())); ++u) {
        if (!light.contains(u, v)) continue;
        const Vector3f weights = weights_of(px, {static_cast<float>(u), static_cast<float>(v)});
        if (!(weights.minCoeff() >= 0)) continue;
        Vector3f p = Vector3f::Zero();
        Vector3f n = Vector3f::Zero();
        for (int i = 0; i < 3; ++i) {
          p += weights[i] * mesh_.vertices[face[i]];
          n += weights[i] * mesh_.normals[face[i]];
        }
        const Light here = light_at(p, n);
        Light& sum = light(u, v);
        sum.factor += here.factor;
        sum.highlight += here.highlight;
        sum.count += 1;
      }
  }

  // Barycentric weights, clamped to the face for texels within the margin; negative beyond it.
  static Vector3f weights_of(const std::array<Vector2f, 3>& px, const Vector2f& at) {
    const auto cross = [](const Vector2f& a, const Vector2f& b) { return a.x() * b.y() - a.y() * b.x(); };
    const float area = cross(px[1] - px[0], px[2] - px[0]);
    Vector3f weights;
    for (int i = 0; i < 3; ++i) {
      const Vector2f& a = px[(i + 1) % 3];
      const Vector2f& b = px[(i + 2) % 3];
      weights[i] = cross(b - a, at - a) / area;
      const float distance_px = weights[i] * std::abs(area) / std::max(1e-6F, (b - a).norm());
      if (distance_px < -kMargin_px) return Vector3f::Constant(-1);
    }
    weights = weights.cwiseMax(0.0F);
    return weights / weights.sum();
  }

  const ProceduralObject& object_;
  TriangleMesh mesh_;
  Vector3f lamp_ = Vector3f::UnitZ();
  float height_m_ = 0;
};

}  // namespace

TriangleMesh bake_light(const ProceduralObject& object, std::uint64_t seed) { return Scanner(object, seed).scan(); }

}  // namespace resight
