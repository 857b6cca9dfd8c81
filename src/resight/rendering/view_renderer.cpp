// SPDX-License-Identifier: Apache-2.0
#include "resight/rendering/view_renderer.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "resight/core/check.hpp"
#include "resight/core/parallel.hpp"
#include "resight/core/srgb.hpp"
#include "resight/rendering/internal/lamp_shader.hpp"

namespace resight {
namespace {

constexpr float kNoReturn = std::numeric_limits<float>::quiet_NaN();

class RowRenderer {
 public:
  RowRenderer(const RaycastScene& scene, const Camera& camera, const Rigid3& world_from_camera,
              const RenderOptions& options)
      : scene_(scene),
        camera_(camera),
        options_(options),
        world_from_camera_(world_from_camera),
        camera_from_world_(world_from_camera.rotation.transpose().cast<float>()),
        lamp_(options.lighting.lamp_in_world_m.cast<float>()),
        lamp_shader_(scene, options.lighting) {}

  void render(int v, RenderedView& view) const {
    const int width = camera_.width;
    std::vector<Ray> rays(width);
    std::vector<RayHit> hits(width);
    for (int u = 0; u < width; ++u) {
      rays[u] = pixel_ray(camera_, world_from_camera_, static_cast<float>(u), static_cast<float>(v));
    }
    scene_.cast(rays, hits);
    for (int u = 0; u < width; ++u) {
      if (!hits[u].has_hit()) continue;
      view.depth_m(u, v) = hits[u].distance;
      view.labels(u, v) = hits[u].instance;
      view.normals_in_camera(u, v) = camera_from_world_ * towards_viewer(scene_.face_normal(hits[u]), rays[u]);
    }
    render_colors(v, view);
  }

 private:
  static Eigen::Vector3f towards_viewer(const Eigen::Vector3f& normal, const Ray& ray) {
    return normal.dot(ray.direction) > 0 ? Eigen::Vector3f(-normal) : normal;
  }

  void render_colors(int v, RenderedView& view) const {
    const int n = options_.samples_per_side;
    std::vector<Ray> rays(static_cast<std::size_t>(camera_.width) * n * n);
    std::vector<RayHit> hits(rays.size());
    const auto offset = [n](int i) { return (static_cast<float>(i) + 0.5F) / static_cast<float>(n) - 0.5F; };
    for (int u = 0, i = 0; u < camera_.width; ++u)
      for (int sv = 0; sv < n; ++sv)
        for (int su = 0; su < n; ++su, ++i)
          rays[i] = color_ray(static_cast<float>(u) + offset(su), static_cast<float>(v) + offset(sv));
    scene_.cast(rays, hits);
    for (int u = 0; u < camera_.width; ++u) {
      Eigen::Vector3f sum = Eigen::Vector3f::Zero();
      for (int i = u * n * n; i < (u + 1) * n * n; ++i) sum += shade(rays[i], hits[i], sample_of(u, v, i % (n * n)));
      sum /= static_cast<float>(n * n);
      if (options_.linear_light) {
        view.light(u, v) = sum;
        sum = sum.unaryExpr(&encode_srgb);
      }
      const auto round = [](float x) { return static_cast<std::uint8_t>(std::clamp(x + 0.5F, 0.0F, 255.0F)); };
      view.color(u, v) = {round(sum.x()), round(sum.y()), round(sum.z())};
    }
  }

  [[nodiscard]] LightSample sample_of(int u, int v, int index) const {
    return {static_cast<std::uint32_t>(v * camera_.width + u), index,
            options_.samples_per_side * options_.samples_per_side};
  }

  [[nodiscard]] Ray color_ray(float u, float v) const {
    if (options_.color_lens.k1 != 0 || options_.color_lens.k2 != 0) {
      const Eigen::Vector2f ideal = ideal_pixel(options_.color_lens, camera_, u, v).cast<float>();
      return pixel_ray(camera_, world_from_camera_, ideal.x(), ideal.y());
    }
    return pixel_ray(camera_, world_from_camera_, u, v);
  }

  // Encoded grey levels, or linear light.
  [[nodiscard]] Eigen::Vector3f shade(const Ray& ray, const RayHit& hit, const LightSample& sample) const {
    if (!hit.has_hit()) {
      const Rgb8 b = options_.background;
      return surface_light({static_cast<float>(b.r), static_cast<float>(b.g), static_cast<float>(b.b)});
    }
    const Eigen::Vector3f p = ray.origin + hit.distance * ray.direction;
    const Eigen::Vector3f normal = towards_viewer(scene_.shading_normal(hit), ray);
    // Side length of a sample on the surface, as geometric mean over both directions. On slanted surfaces, it blurs
    // less than the longer side would, and aliases less than the shorter one.
    const float cosine = std::max(0.1F, std::abs(normal.dot(ray.direction)) / ray.direction.norm());
    const float footprint_m =
        hit.distance / static_cast<float>(camera_.fx * options_.samples_per_side) / std::sqrt(cosine);
    const Eigen::Vector3f color = surface_light(scene_.color(hit, footprint_m));
    if (options_.lighting.lamps.empty()) return color * brightness(p, normal);
    const float white = options_.linear_light ? 1.0F : 255.0F;
    return lamp_shader_.shade({p, normal, -ray.direction.normalized()}, color, white, scene_.material(hit.instance),
                              sample);
  }

  [[nodiscard]] Eigen::Vector3f surface_light(const Eigen::Vector3f& color) const {
    return options_.linear_light ? Eigen::Vector3f(color.unaryExpr(&decode_srgb)) : color;
  }

  [[nodiscard]] float brightness(const Eigen::Vector3f& p, const Eigen::Vector3f& normal) const {
    const Lighting& light = options_.lighting;
    const Eigen::Vector3f to_lamp = lamp_ - p;
    const float distance = to_lamp.norm();
    float lamp_share = std::max(0.0F, normal.dot(to_lamp) / distance);
    if (light.shadows && lamp_share > 0 &&
        scene_.is_blocked({p, to_lamp / distance}, kLampShadowGap_m, distance - kLampShadowGap_m)) {
      lamp_share = 0;
    }
    return static_cast<float>(light.ambient) * (0.85F + 0.15F * normal.z()) +
           static_cast<float>(light.diffuse) * lamp_share;
  }

  const RaycastScene& scene_;
  const Camera& camera_;
  const RenderOptions& options_;
  Rigid3f world_from_camera_;
  Eigen::Matrix3f camera_from_world_;
  Eigen::Vector3f lamp_;
  LampShader lamp_shader_;
};

}  // namespace

void Lighting::check() const {
  require(lamp_in_world_m.allFinite(), "Lighting.lamp_in_world_m must be finite");
  check_not_negative("Lighting.ambient", ambient);
  check_not_negative("Lighting.diffuse", diffuse);
  require(ambient_color.allFinite() && ambient_color.minCoeff() >= 0, "Lighting.ambient_color must be >= 0");
  for (const Lamp& lamp : lamps) {
    require(lamp.position_in_world_m.allFinite(), "Lamp.position_in_world_m must be finite");
    require(lamp.intensity.allFinite() && lamp.intensity.minCoeff() >= 0, "Lamp.intensity must be >= 0");
    check_not_negative("Lamp.radius_m", lamp.radius_m);
  }
}

void RenderOptions::check() const {
  check_in_range("RenderOptions.samples_per_side", samples_per_side, 1, 8);
  check_in_range("RenderOptions.num_threads", num_threads, 1, 4096);
  lighting.check();
  color_lens.check();
}

Ray pixel_ray(const Camera& camera, const Rigid3f& world_from_camera, float u, float v) {
  const Eigen::Vector3f direction_in_camera((u - static_cast<float>(camera.cx)) / static_cast<float>(camera.fx),
                                            (v - static_cast<float>(camera.cy)) / static_cast<float>(camera.fy), 1.0F);
  return {world_from_camera.translation, world_from_camera.rotation * direction_in_camera};
}

RenderedView render_scene(const RaycastScene& scene, const Camera& camera, const Rigid3& world_from_camera,
                          const RenderOptions& options) {
  options.check();
  require(camera.is_valid(), "render_scene: invalid camera");
  require(world_from_camera.is_rigid(), "render_scene: the camera pose is not a rigid motion");
  const int w = camera.width;
  const int h = camera.height;
  RenderedView view{Image<Rgb8>(w, h),
                    Image<float>(w, h, kNoReturn),
                    Image<int>(w, h, -1),
                    Image<Eigen::Vector3f>(w, h, Eigen::Vector3f::Constant(kNoReturn)),
                    {}};
  if (options.linear_light) view.light = Image<Eigen::Vector3f>(w, h, Eigen::Vector3f::Zero());
  const RowRenderer renderer(scene, camera, world_from_camera, options);
  parallel_for_blocks(static_cast<std::size_t>(h), 8, options.num_threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) renderer.render(static_cast<int>(v), view);
  });
  return view;
}

Rigid3 look_at(const Eigen::Vector3d& eye, const Eigen::Vector3d& target, const Eigen::Vector3d& up) {
  const Eigen::Vector3d forward = (target - eye).normalized();
  const Eigen::Vector3d right = forward.cross(up);
  require(forward.allFinite() && right.norm() > 1e-6 * up.norm(),
          "look_at: eye and target coincide or lie along the up direction");
  Rigid3 world_from_camera;
  world_from_camera.rotation.col(0) = right.normalized();
  world_from_camera.rotation.col(1) = forward.cross(right.normalized());
  world_from_camera.rotation.col(2) = forward;
  world_from_camera.translation = eye;
  return world_from_camera;
}

}  // namespace resight
