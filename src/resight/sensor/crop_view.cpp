// SPDX-License-Identifier: Apache-2.0
#include "resight/sensor/crop_view.hpp"

#include <algorithm>

#include "resight/core/check.hpp"

namespace resight {
namespace {

struct Box {  // In pixels; excludes column u1 and row v1.
  int u0 = 0;
  int v0 = 0;
  int u1 = 0;
  int v1 = 0;
};

Box find_object(const Image<std::uint8_t>& mask) {
  Box box{mask.width(), mask.height(), 0, 0};
  for (int v = 0; v < mask.height(); ++v)
    for (int u = 0; u < mask.width(); ++u) {
      if (mask(u, v) == 0) continue;
      box = {std::min(box.u0, u), std::min(box.v0, v), std::max(box.u1, u + 1), std::max(box.v1, v + 1)};
    }
  return box;
}

template <typename T>
Image<T> crop(const Image<T>& image, const Box& box) {
  Image<T> part(box.u1 - box.u0, box.v1 - box.v0);
  for (int v = box.v0; v < box.v1; ++v) {
    const auto row = image.row(v).subspan(static_cast<std::size_t>(box.u0), static_cast<std::size_t>(part.width()));
    std::ranges::copy(row, part.row(v - box.v0).begin());
  }
  return part;
}

}  // namespace

TrainingView crop_to_object(const TrainingView& view, int margin_px) {
  check_not_negative("margin_px", margin_px);
  TrainingView part;
  part.frame.name = view.frame.name;
  part.frame.world_from_camera = view.frame.world_from_camera;
  Box box = find_object(view.mask);
  if (box.u1 <= box.u0) return part;
  box = {std::max(box.u0 - margin_px, 0), std::max(box.v0 - margin_px, 0),
         std::min(box.u1 + margin_px, view.mask.width()), std::min(box.v1 + margin_px, view.mask.height())};
  part.frame.camera = view.frame.camera;
  part.frame.camera.width = box.u1 - box.u0;
  part.frame.camera.height = box.v1 - box.v0;
  part.frame.camera.cx -= box.u0;
  part.frame.camera.cy -= box.v0;
  part.frame.color = crop(view.frame.color, box);
  part.frame.depth_m = crop(view.frame.depth_m, box);
  part.mask = crop(view.mask, box);
  return part;
}

}  // namespace resight
