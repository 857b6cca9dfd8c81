// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <span>

#include "resight/appearance/lab_color.hpp"
#include "resight/geometry/rigid3.hpp"

namespace resight {

struct PreparedModel;

/// A surface point of the scene that a pose explains: where it lies in the object frame, and its colour.
struct ExplainedPoint {
  Eigen::Vector3f p_in_object = Eigen::Vector3f::Zero();
  LabColor color;
};

/// The symmetry motion (PreparedModel::symmetry_motions) under which the textures of model and scene agree best:
/// pattern_similarity() minus the weighted squared difference of the mean chromaticities. The better pose is
/// world_from_object * motion. Depth cannot tell these poses apart. Returns the identity unless another motion is
/// better by more than 0.05, and for fewer than 20 points. Points beside the model count as mid-grey.
/// `chroma_weight`: weight of a and b relative to l.
[[nodiscard]] Rigid3 resolve_symmetry(const PreparedModel& model, std::span<const ExplainedPoint> points,
                                      double chroma_weight);

}  // namespace resight
