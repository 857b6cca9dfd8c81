// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <span>
#include <vector>

#include "resight/geometry/rigid3.hpp"
#include "resight/geometry/triangle_mesh.hpp"
#include "resight/simulation/texture_canvas.hpp"

namespace resight {

inline constexpr double kMmPerM = 1000;

/// Collects the regions of a texture in rows from left to right. A border of repeated pixels separates each region from
/// its neighbours in a filtered look-up.
class TextureAtlas {
 public:
  TextureAtlas(int width_px, double px_per_mm);
  /// Reserves a region of the given size (mm on the surface), with fewer pixels if it is larger than the atlas is wide
  /// or 4,080 pixels high. Paint it before finish().
  [[nodiscard]] PixelRect allocate(double width_mm, double height_mm);
  /// Reserves a small region of one colour.
  [[nodiscard]] PixelRect solid(Rgb8 color);
  [[nodiscard]] TextureCanvas canvas(const PixelRect& region) { return {image_, region, px_per_mm_}; }
  /// Crops the image, repeats the borders, and converts the texture coordinates of the mesh from pixels to shares.
  void finish(TriangleMesh& mesh);

 private:
  void grow();

  double px_per_mm_;
  Image<Rgb8> image_;
  int x_ = 0;
  int y_ = 0;
  int row_height_ = 0;
  std::vector<PixelRect> regions_;
};

// Each part has vertices, normals and texture coordinates in pixels of the atlas (see TextureAtlas::finish()). Lengths
// are in metres. Regions appear upright from outside.

/// A box on z = 0, centred in x and y. Regions: front (-y), right (+x), back (+y), left (-x), top, bottom. The top
/// appears upright to a viewer of the front. `cells` is the number of squares along each edge.
struct BoxRegions {
  PixelRect front, right, back, left, top, bottom;
};
[[nodiscard]] TriangleMesh make_box_part(const Eigen::Vector3d& size, const BoxRegions& regions, int cells = 14);

/// A box with rounded edges. Each region is stretched over its side.
[[nodiscard]] TriangleMesh make_rounded_box_part(const Eigen::Vector3d& size, double radius, const BoxRegions& regions,
                                                 int cells = 20);

/// The surface of revolution of a profile (radius, z) about +z, from top to bottom as seen from outside. It is smooth
/// along the profile, so use one part per smooth piece. The region is wrapped around once, with its left border at the
/// back (+y).
[[nodiscard]] TriangleMesh make_lathe_part(std::span<const Eigen::Vector2d> profile, const PixelRect& region,
                                           int segments = 64);

/// A flat disc (or ring, with an inner radius) at height z that faces up or down. It shows the ellipse inscribed in the
/// region.
[[nodiscard]] TriangleMesh make_disc_part(double radius, double z, bool faces_up, const PixelRect& region,
                                          double inner_radius = 0.0, int segments = 64);

/// An ellipsoid about the origin.
[[nodiscard]] TriangleMesh make_ellipsoid_part(const Eigen::Vector3d& radii, const PixelRect& region,
                                               int segments = 32);

/// A tube of the given radius along a path. Flat caps close its ends.
[[nodiscard]] TriangleMesh make_tube_part(std::span<const Eigen::Vector3d> path, double radius, const PixelRect& region,
                                          int segments = 16);

/// A polygon (x, y; counter-clockwise seen from above) extruded from z = 0 to `height`. The side region is wrapped
/// around once.
[[nodiscard]] TriangleMesh make_prism_part(std::span<const Eigen::Vector2d> polygon, double height,
                                           const PixelRect& side, const PixelRect& top, const PixelRect& bottom);

/// Moves a part; scales a part along the axes (factors > 0).
[[nodiscard]] TriangleMesh moved(TriangleMesh part, const Rigid3& target_from_part);
[[nodiscard]] TriangleMesh scaled(TriangleMesh part, const Eigen::Vector3d& factors);

/// Replaces the texture by a uniform vertex colour.
void make_plain(TriangleMesh& mesh, Rgb8 color);

/// Moves the mesh so that its bounding box stands on z = 0, centred in x and y.
void stand_on_origin(TriangleMesh& mesh);

}  // namespace resight
