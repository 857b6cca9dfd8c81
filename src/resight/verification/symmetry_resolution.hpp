// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <span>
#include <vector>

#include "resight/appearance/lab_color.hpp"
#include "resight/geometry/rigid3.hpp"

namespace resight {

struct PreparedModel;

/// A surface point of the scene that a pose explains: where it lies in the object frame, and its colour.
struct ExplainedPoint {
  Eigen::Vector3f p_in_object = Eigen::Vector3f::Zero();
  LabColor color;
};

/// The turn of PreparedModel::turns (object_from_turned: the better pose is world_from_object * turn) under which the
/// print of the model is most like the scene's (pattern_similarity(), less for what the mean hues differ): depth alone
/// says nothing about it. The identity, unless another is better by .05, and for fewer than 20 points. A point
/// that is beside the model counts as mid-grey there. `chroma_weight`: of a and b beside l.
[[nodiscard]] Rigid3 resolve_symmetry(const PreparedModel& model, std::span<const ExplainedPoint> points,
                                      double chroma_weight);

}  // namespace resight
