// SPDX-License-Identifier: Apache-2.0
#include "resight/annotation/annotated_inputs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "resight/annotation/internal/hash_values.hpp"
#include "resight/core/hash.hpp"

namespace resight {
namespace {

constexpr int kMaxReadViews = 8;
constexpr float kDepthSteps_per_m = 1e4F;

/// Six digits: the last ones depend on the compiler. Whole numbers have no negative zero.
long long rounded_micro(double value) { return std::llround(1e6 * value); }

std::uint64_t hash_rounded_pose(const Rigid3& world_from_camera, std::uint64_t seed) {
  const Eigen::Matrix4d pose = world_from_camera.matrix();
  std::string text;
  for (const double value : pose.reshaped()) text += fmt::format("{} ", rounded_micro(value));
  return hash_text(text, seed);
}

std::uint64_t hash_pixels(const RgbdFrame& frame, std::uint64_t seed) {
  const Camera& camera = frame.camera;
  seed = hash_text(fmt::format("{} {} {:.4f} {:.4f} {:.4f} {:.4f}\n", camera.width, camera.height, camera.fx, camera.fy,
                               camera.cx, camera.cy),
                   seed);
  std::vector<std::int32_t> steps;
  for (const float z : frame.depth_m.data())
    steps.push_back(std::isnan(z) ? 0 : static_cast<std::int32_t>(std::lround(kDepthSteps_per_m * z)));
  return annotation::hash_values(frame.color.data(), annotation::hash_values<std::int32_t>(steps, seed));
}

}  // namespace

std::vector<int> views_that_identify(int num_views) {
  std::vector<int> views(static_cast<std::size_t>(std::min(kMaxReadViews, num_views)));
  for (std::size_t i = 1; i < views.size(); ++i)
    views[i] = static_cast<int>(i) * (num_views - 1) / (static_cast<int>(views.size()) - 1);
  return views;
}

Result<AnnotatedInputs> identify_inputs(const Sequence& sequence, const ModelLibrary& library) {
  std::uint64_t views = kHashSeed;
  std::uint64_t earlier = kHashSeed;
  for (int v = 0; v < sequence.num_views(); ++v) {
    const auto pose = sequence.read_pose(v);
    if (!pose) return pose.error();
    const std::string name = sequence.view_name(v);
    const Eigen::Vector3d& t = pose->translation;
    views = hash_rounded_pose(*pose, hash_text(name + "\n", views));
    earlier = hash_text(fmt::format("{} {:.6f} {:.6f} {:.6f}\n", name, t.x(), t.y(), t.z()), earlier);
  }
  for (const int v : views_that_identify(sequence.num_views())) {
    const auto frame = sequence.read_view(v);
    if (!frame) return frame.error();
    views = hash_pixels(*frame, views);
  }
  std::uint64_t models = kHashSeed;
  for (const ObjectModel& model : library.objects)
    models = hash_text(fmt::format("{} {} {}\n", model.name, model.bop_id, model.surface.size()), models);
  const auto digest = [&](std::uint64_t of_views) {
    return fmt::format("{} views {:016x}, {} models {:016x}", sequence.num_views(), of_views, library.objects.size(),
                       models);
  };
  return AnnotatedInputs{.digest = digest(views), .earlier_digest = digest(earlier)};
}

}  // namespace resight
