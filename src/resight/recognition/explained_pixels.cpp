// SPDX-License-Identifier: Apache-2.0
#include "resight/recognition/explained_pixels.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace resight {
namespace {

constexpr double kMaxGoneShare = 0.1;  // A pose that sees more free space may be wrong.
constexpr float kMinDepth_m = 0.1F;    // Nearer points are beside or behind the camera.

class Marker {
 public:
  Marker(const RgbdFrame& frame, float tolerance_m, float spacing_m)
      : frame_(frame),
        tolerance_m_(tolerance_m),
        point_radius_m_(0.5 * spacing_m),
        mask_(frame.camera.width, frame.camera.height, 0) {}

  void mark(const PointCloud& surface, const Rigid3f& camera_from_object) {
    for (std::size_t i = 0; i < surface.size(); ++i) {
      const Eigen::Vector3f p = camera_from_object * surface.points[i];
      if (p.z() > kMinDepth_m && (camera_from_object.rotation * surface.normals[i]).dot(p) < 0) mark_around(p);
    }
  }
  [[nodiscard]] Image<std::uint8_t> take() { return std::move(mask_); }

 private:
  void mark_around(const Eigen::Vector3f& p) {
    const std::optional<Pixel> pixel = frame_.camera.pixel_of(p.cast<double>());
    if (!pixel) return;
    const int radius = 1 + static_cast<int>(point_radius_m_ * frame_.camera.fx / static_cast<double>(p.z()));
    const auto [u, v] = *pixel;
    for (int y = std::max(0, v - radius); y <= std::min(frame_.camera.height - 1, v + radius); ++y)
      for (int x = std::max(0, u - radius); x <= std::min(frame_.camera.width - 1, u + radius); ++x)
        if (std::abs(frame_.depth_m(x, y) - p.z()) < tolerance_m_) mask_(x, y) = 255;  // false for NaN
  }

  const RgbdFrame& frame_;
  float tolerance_m_;
  double point_radius_m_;
  Image<std::uint8_t> mask_;
};

}  // namespace

Image<std::uint8_t> find_explained_pixels(const RgbdFrame& frame, std::span<const TrackedObject> tracked,
                                          const ModelLibrary& library, const PresenceOptions& presence) {
  Marker marker(frame, static_cast<float>(presence.margin.base_m), library.surface_voxel_m);
  for (const TrackedObject& object : tracked) {
    const PointCloud& surface = library.objects[static_cast<std::size_t>(object.object)].surface;
    const ObjectPresence seen = assess_presence(surface, object.world_from_object, frame, presence);
    if (!seen.is_informative || seen.gone_share > kMaxGoneShare) continue;
    marker.mark(surface, Rigid3f(frame.world_from_camera.inverse() * object.world_from_object));
  }
  return marker.take();
}

}  // namespace resight
