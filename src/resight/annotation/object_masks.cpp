// SPDX-License-Identifier: Apache-2.0
#include "resight/annotation/object_masks.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "resight/geometry/splat_mesh.hpp"
#include "resight/rendering/raycast_scene.hpp"
#include "resight/rendering/view_renderer.hpp"

namespace resight {

struct ObjectMaskRenderer::Shape {
  RaycastScene scene;
};

namespace {

constexpr float kOcclusionMargin_m = 0.015F;  // As in the toolkit of BOP.
constexpr int kBorder_px = 3;
constexpr float kMinDepth_m = 1e-3F;

/// First and last columns and rows.
struct PixelBounds {
  int u0 = std::numeric_limits<int>::max();
  int v0 = std::numeric_limits<int>::max();
  int u1 = std::numeric_limits<int>::min();
  int v1 = std::numeric_limits<int>::min();

  void add(int u, int v) {
    u0 = std::min(u0, u);
    v0 = std::min(v0, v);
    u1 = std::max(u1, u);
    v1 = std::max(v1, v);
  }
  [[nodiscard]] bool empty() const { return u1 < u0; }
  [[nodiscard]] PixelRectangle rectangle() const {
    return empty() ? PixelRectangle{}
                   : PixelRectangle{.left = u0, .top = v0, .width = u1 - u0 + 1, .height = v1 - v0 + 1};
  }
};

/// Pixels that may show the object, up to one image beside the image.
PixelBounds find_bounds(const PointCloud& surface, const Camera& camera, const Rigid3& camera_from_object) {
  PixelBounds bounds;
  const Rigid3f to_camera(camera_from_object);
  for (const Eigen::Vector3f& point : surface.points) {
    const Eigen::Vector3d p = (to_camera * point).cast<double>();
    if (p.z() < kMinDepth_m) continue;
    const Eigen::Vector2d px = camera.project(p);
    bounds.add(static_cast<int>(std::clamp<double>(px.x(), -camera.width, 2.0 * camera.width)),
               static_cast<int>(std::clamp<double>(px.y(), -camera.height, 2.0 * camera.height)));
  }
  if (bounds.empty()) return bounds;
  return {bounds.u0 - kBorder_px, bounds.v0 - kBorder_px, bounds.u1 + kBorder_px, bounds.v1 + kBorder_px};
}

/// Casts a ray per pixel: fills the silhouette, and `depth_m` where it is in the image.
void cast_silhouette(const RaycastScene& scene, const PixelBounds& bounds, const RgbdFrame& frame,
                     const Rigid3& camera_from_object, ObjectMask& mask, Image<float>& depth_m) {
  if (bounds.empty()) return;  // All of it is behind the camera.
  const Rigid3f object_from_camera(camera_from_object.inverse());
  const Camera& camera = frame.camera;
  std::vector<Ray> rays(static_cast<std::size_t>(bounds.u1 - bounds.u0 + 1));
  std::vector<RayHit> hits(rays.size());
  PixelBounds found;
  for (int v = bounds.v0; v <= bounds.v1; ++v) {
    for (std::size_t i = 0; i < rays.size(); ++i)
      rays[i] = pixel_ray(camera, object_from_camera, static_cast<float>(bounds.u0 + static_cast<int>(i)),
                          static_cast<float>(v));
    scene.cast(rays, hits, kMinDepth_m);
    for (std::size_t i = 0; i < hits.size(); ++i) {
      if (!hits[i].has_hit()) continue;
      const int u = bounds.u0 + static_cast<int>(i);
      ++mask.num_pixels;
      found.add(u, v);
      if (!depth_m.contains(u, v)) continue;
      ++mask.num_in_image;
      if (!std::isnan(frame.depth_m(u, v))) ++mask.num_measured;
      mask.whole(u, v) = 255;
      depth_m(u, v) = hits[i].distance;
    }
  }
  mask.whole_box = found.rectangle();
}

void mark_visible(const RgbdFrame& frame, const Image<float>& depth_m, const Image<float>& nearest_m,
                  ObjectMask& mask) {
  PixelBounds found;
  for (int v = 0; v < depth_m.height(); ++v) {
    for (int u = 0; u < depth_m.width(); ++u) {
      if (mask.whole(u, v) == 0) continue;
      const float measured_m = frame.depth_m(u, v);
      const bool is_visible =
          std::isnan(measured_m) ? depth_m(u, v) <= nearest_m(u, v) : depth_m(u, v) <= measured_m + kOcclusionMargin_m;
      if (!is_visible) continue;
      mask.visible(u, v) = 255;
      ++mask.num_visible;
      found.add(u, v);
    }
  }
  mask.visible_box = found.rectangle();
}

}  // namespace

ObjectMaskRenderer::ObjectMaskRenderer(const ModelLibrary& library) : library_(library) {}
ObjectMaskRenderer::~ObjectMaskRenderer() = default;

const ObjectMaskRenderer::Shape& ObjectMaskRenderer::shape(int object) {
  std::unique_ptr<Shape>& known = shapes_[object];
  if (known) return *known;
  PointCloud surface = library_.objects[static_cast<std::size_t>(object)].surface;
  if (!surface.has_colors()) surface.colors.assign(surface.size(), Rgb8{128, 128, 128});
  known = std::make_unique<Shape>();
  known->scene.add_instance(known->scene.add_mesh(make_splat_mesh(surface)), Rigid3::identity());
  known->scene.commit();
  return *known;
}

std::vector<ObjectMask> ObjectMaskRenderer::render(std::span<const AnnotatedObject> objects, const RgbdFrame& frame) {
  const Camera& camera = frame.camera;
  const float infinity = std::numeric_limits<float>::infinity();
  Image<float> nearest_m(camera.width, camera.height, infinity);
  std::vector<ObjectMask> masks;
  std::vector<Image<float>> depths;
  for (const AnnotatedObject& object : objects) {
    const Rigid3 camera_from_object = frame.world_from_camera.inverse() * object.world_from_object;
    const PixelBounds bounds =
        find_bounds(library_.objects[static_cast<std::size_t>(object.object)].surface, camera, camera_from_object);
    ObjectMask mask;
    mask.object = object;
    mask.whole = Image<std::uint8_t>(camera.width, camera.height);
    mask.visible = mask.whole;
    Image<float> depth_m(camera.width, camera.height, infinity);
    cast_silhouette(shape(object.object).scene, bounds, frame, camera_from_object, mask, depth_m);
    if (mask.num_in_image == 0) continue;
    for (std::size_t i = 0; i < depth_m.size(); ++i) nearest_m[i] = std::min(nearest_m[i], depth_m[i]);
    masks.push_back(std::move(mask));
    depths.push_back(std::move(depth_m));
  }
  for (std::size_t i = 0; i < masks.size(); ++i) mark_visible(frame, depths[i], nearest_m, masks[i]);
  return masks;
}

}  // namespace resight
