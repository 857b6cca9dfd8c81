// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <map>
#include <memory>
#include <span>
#include <vector>

#include "resight/annotation/annotation_document.hpp"
#include "resight/core/image.hpp"
#include "resight/models/object_model.hpp"
#include "resight/sensor/rgbd_frame.hpp"

namespace resight {

/// A rectangle of pixels, which may exceed the image; empty if its size is 0.
struct PixelRectangle {
  int left = 0;
  int top = 0;
  int width = 0;
  int height = 0;
};

/// An annotated object in one view, as BOP's scene_gt_info.json describes it.
struct ObjectMask {
  AnnotatedObject object;
  Image<std::uint8_t> whole;    ///< Silhouette, also where it is occluded; of the size of the image.
  Image<std::uint8_t> visible;  ///< Pixels of it that are not occluded.
  PixelRectangle whole_box;     ///< Of the silhouette, also beyond the image.
  PixelRectangle visible_box;
  int num_pixels = 0;  ///< Of the silhouette, also beyond the image.
  int num_in_image = 0;
  int num_measured = 0;  ///< Of the silhouette, with depth.
  int num_visible = 0;
  /// Visible over all pixels of the silhouette (visib_fract of BOP).
  [[nodiscard]] double visible_share() const {
    return num_pixels > 0 ? static_cast<double>(num_visible) / num_pixels : 0;
  }
};

/// Renders the masks of annotated objects. Meshes of objects are made when they are first needed.
class ObjectMaskRenderer {
 public:
  /// `library` must outlive it.
  explicit ObjectMaskRenderer(const ModelLibrary& library);
  ~ObjectMaskRenderer();
  /// The masks of all objects of which at least one pixel is in the image, in the given order. A pixel is visible if
  /// the measured depth is at most 15 mm nearer than the object, as in BOP; without a measurement, if no other of the
  /// objects is before it.
  [[nodiscard]] std::vector<ObjectMask> render(std::span<const AnnotatedObject> objects, const RgbdFrame& frame);

 private:
  struct Shape;
  [[nodiscard]] const Shape& shape(int object);
  const ModelLibrary& library_;
  std::map<int, std::unique_ptr<Shape>> shapes_;
};

}  // namespace resight
