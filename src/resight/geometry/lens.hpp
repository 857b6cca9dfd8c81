// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <array>
#include <optional>
#include <span>
#include <string_view>

#include "resight/core/result.hpp"

namespace resight {

/// How a lens bends rays: the models of OpenCV and ROS. Maps ideal to distorted coordinates (x/z, y/z).
class LensDistortion {
 public:
  /// No distortion.
  LensDistortion() = default;
  /// `model`: plumb_bob or rational_polynomial (k1 k2 p1 p2 [k3 [k4 k5 k6]]), equidistant (k1 k2 k3 k4, also fisheye
  /// and kannala_brandt4), or a name of librealsense: Brown Conrady is plumb_bob; of Modified and Inverse Brown
  /// Conrady, the tangential part acts on what the radial part has bent (rs2_project_point_to_pixel). Empty: by the
  /// number of coefficients. Fails for other models, unless all coefficients are 0.
  [[nodiscard]] static Result<LensDistortion> make(std::string_view model, std::span<const double> coefficients);

  [[nodiscard]] bool is_none() const { return kind_ == Kind::kNone; }
  /// The distorted place of an ideal point. None where the model folds back, beyond the field of view of the lens.
  [[nodiscard]] std::optional<Eigen::Vector2d> distort(const Eigen::Vector2d& ideal) const;
  friend bool operator==(const LensDistortion&, const LensDistortion&) = default;

 private:
  enum class Kind { kNone, kPolynomial, kModifiedPolynomial, kEquidistant };
  Kind kind_ = Kind::kNone;
  std::array<double, 8> k_{};  ///< In the order of make().
};

}  // namespace resight
