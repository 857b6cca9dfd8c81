// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "resight/simulation/procedural_objects.hpp"
#include "resight/simulation/texture_designs.hpp"

namespace resight {

// Families of objects, each with its parameters.

/// A printed box that stands upright.
[[nodiscard]] ProceduralObject make_package(const std::string& name, const Eigen::Vector3d& size_m,
                                            const TextureStyle& style, const std::string& kind = "textured");
/// A flat package on its back, with the front on top.
[[nodiscard]] ProceduralObject make_lying_package(const std::string& name, const Eigen::Vector3d& size_m,
                                                  const TextureStyle& style);
/// A book on its back cover, with the spine to the left (-x).
[[nodiscard]] ProceduralObject make_book(const std::string& name, const Eigen::Vector3d& size_m,
                                         const TextureStyle& style);
/// A carton with a gable.
[[nodiscard]] ProceduralObject make_carton(const std::string& name, double width_m, double box_height_m,
                                           double roof_height_m, const TextureStyle& style);

/// A tin with a label around it, steel rims and lids.
[[nodiscard]] ProceduralObject make_can(const std::string& name, double radius_m, double height_m,
                                        const TextureStyle& style, const std::string& kind = "textured");

/// A bottle: foot, label, shoulder, neck, cap. `flatness` scales its depth (y).
struct BottleShape {
  double radius_m, label_top_m, shoulder_top_m, neck_radius_m, cap_radius_m, height_m, flatness = 1.0;
};
[[nodiscard]] ProceduralObject make_bottle(const std::string& name, const BottleShape& s, Rgb8 glass,
                                           const TextureStyle& style);

struct CupShape {
  double bottom_radius_m, top_radius_m, height_m, wall_m;
};
/// Outside, rim, inside and bottom of a cup or bowl. `outside` is wrapped around it.
[[nodiscard]] TriangleMesh make_cup_part(const CupShape& s, const PixelRect& outside, const PixelRect& inside);
/// The handle of a cup, which starts at distance x_m from its axis.
[[nodiscard]] TriangleMesh make_handle(double x_m, double center_z_m, double reach_m, double half_height_m,
                                       double radius_m, const PixelRect& region);

/// An untextured block.
[[nodiscard]] ProceduralObject make_plain_block(const std::string& name, const Eigen::Vector3d& size, double radius,
                                                Rgb8 color);

/// Symmetries of an upright body of revolution that is the same upside down.
[[nodiscard]] ObjectSymmetries cylinder_symmetries(double height_m);
/// The three half turns of a block on z = 0.
[[nodiscard]] ObjectSymmetries block_symmetries(double height_m);

}  // namespace resight
