// SPDX-License-Identifier: Apache-2.0
#include "resight/modelling/internal/track_view.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "resight/core/parallel.hpp"
#include "resight/rendering/view_renderer.hpp"
#include "resight/sensor/crop_view.hpp"

namespace resight {
namespace {

constexpr int kCropMargin_px = 24;
constexpr int kMinWidth_px = 320;  // So that all views have the same number of levels.
// The model may not move an approximately aligned view farther than this; it would have slid along a symmetry.
constexpr double kMaxShift_m = 0.015;
constexpr double kMaxRotation_rad = 0.12;

// Neutral lighting, because the mesh has the observed colours.
Lighting flat_light() {
  Lighting light;
  light.ambient = 1;
  light.diffuse = 0;
  return light;
}

// A model of one side is open at the bottom. This removes rendered back faces, where no surface was observed.
void drop_insides(const RaycastScene& scene, const Camera& camera, const Rigid3& object_from_camera,
                  Image<float>& depth_m) {
  const Rigid3f pose(object_from_camera);
  for (int v = 0; v < depth_m.height(); ++v)
    for (int u = 0; u < depth_m.width(); ++u) {
      if (std::isnan(depth_m(u, v))) continue;
      const Ray ray = pixel_ray(camera, pose, static_cast<float>(u), static_cast<float>(v));
      const RayHit hit = scene.cast(ray);
      if (!hit.has_hit() || scene.face_normal(hit).dot(ray.direction) > 0)
        depth_m(u, v) = std::numeric_limits<float>::quiet_NaN();
    }
}

}  // namespace

TrainingView crop_for_tracking(const TrainingView& view) {
  TrainingView part;
  int margin_px = kCropMargin_px;
  do {
    part = crop_to_object(view, margin_px);
    margin_px += kCropMargin_px;
  } while (!part.mask.empty() && part.mask.width() < std::min(kMinWidth_px, view.mask.width()));
  return part;
}

TrackView make_track_view(const TrainingView& view, const TrackObjectOptions& options) {
  TrainingView part = crop_for_tracking(view);
  const PreparedView prepared = prepare_view(std::move(part.frame));
  return {make_alignment_view(prepared, options.view, &part.mask),
          ViewFeatures(extract_sift(prepared, options.features.sift, &part.mask))};
}

std::vector<TrackView> make_track_views(std::span<const TrainingView> views, std::span<const int> chosen,
                                        const TrackObjectOptions& options) {
  std::vector<std::optional<TrackView>> made(chosen.size());
  parallel_for(made.size(), options.num_threads,
               [&](std::size_t k) { made[k].emplace(make_track_view(views[chosen[k]], options)); });
  std::vector<TrackView> parts;
  for (std::optional<TrackView>& part : made) parts.push_back(std::move(*part));
  return parts;
}

struct ModelTarget::Impl {
  RaycastScene scene;
  TrackObjectOptions options;
};

ModelTarget::ModelTarget(TriangleMesh mesh, const TrackObjectOptions& options) : impl_(std::make_unique<Impl>()) {
  impl_->options = options;
  impl_->scene.add_instance(impl_->scene.add_mesh(std::move(mesh)), Rigid3::identity());
  impl_->scene.commit();
}
ModelTarget::~ModelTarget() = default;

AlignedView ModelTarget::align(const AlignmentView& view, const Camera& camera, const Rigid3& object_from_camera,
                               bool is_known) const {
  RenderOptions render;
  render.samples_per_side = 1;
  render.lighting = flat_light();
  RenderedView rendered = render_scene(impl_->scene, camera, object_from_camera, render);
  drop_insides(impl_->scene, camera, object_from_camera, rendered.depth_m);
  RgbdFrame frame;
  frame.camera = camera;
  frame.color = std::move(rendered.color);
  frame.depth_m = std::move(rendered.depth_m);
  const AlignmentView target = make_alignment_view(prepare_view(std::move(frame)), impl_->options.view);
  const std::vector<AlignmentTarget> targets{{&target, object_from_camera}};
  AlignViewOptions align = impl_->options.align;
  align.num_threads = 1;
  if (is_known) {
    align.prior_sigma_m = impl_->options.features.sigma_m;
    align.prior_sigma_rad = impl_->options.features.sigma_rad;
  }
  return align_view(view, targets, object_from_camera, align);
}

void refine_on_model(std::vector<TrainingView>& views, const TrackObjectOptions& options, int rounds) {
  FuseViewsOptions fuse = options.fuse;
  fuse.num_threads = options.num_threads;
  for (int round = 0; round < rounds; ++round) {
    TriangleMesh mesh = fuse_views(views, fuse);
    if (mesh.empty()) return;
    const ModelTarget model(std::move(mesh), options);
    parallel_for(views.size(), options.num_threads, [&](std::size_t i) {
      TrainingView part = crop_for_tracking(views[i]);
      if (part.mask.empty()) return;
      const Rigid3 before = part.frame.world_from_camera;
      const Camera camera = part.frame.camera;
      const PreparedView prepared = prepare_view(std::move(part.frame));
      const AlignedView aligned =
          model.align(make_alignment_view(prepared, options.view, &part.mask), camera, before, true);
      const Rigid3 step = before.inverse() * aligned.world_from_camera;
      const double rotation_rad = rotation_angle_rad(step.rotation, Eigen::Matrix3d::Identity());
      // Rotation and translation of the camera are coupled; the displacement of the object's surface counts.
      const Eigen::Vector3d object = before.inverse().translation;
      if (aligned.overlap < options.plausible.min_overlap || rotation_rad > kMaxRotation_rad ||
          (step * object - object).norm() > kMaxShift_m)
        return;
      views[i].frame.world_from_camera = aligned.world_from_camera;
    });
  }
}

}  // namespace resight
