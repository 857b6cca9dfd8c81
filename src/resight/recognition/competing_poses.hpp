// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>

#include "resight/models/object_model.hpp"
#include "resight/recognition/detections.hpp"

namespace resight {

/// How likely it is that an object is where an accepted hypothesis places it, and that it has the pose of it.
struct PlaceScore {
  double place = 0;  ///< Probability that the hypothesis or a competing pose is right.
  double pose = 1;   ///< Probability that it is the hypothesis, given that.
};

/// The score of the accepted hypothesis `accepted`, given that competing poses may be right instead: a cup fits nearly
/// as well with its handle on the other side. Competing poses are those of its object that it suppressed
/// (HypothesisEvidence::suppressed_by), more than 5 cm or 30 deg from it. Two that are nearer to each other than that
/// count as one, with the higher score. The likeliest pose of each twin competes, too: of another object that explains
/// as much as well, within 0.01 in fit and each similarity. At most one of all poses is right. With the odds o = score
/// / (1 - score) of each, and their sum S: place = S / (1 + S), pose = o / S.
[[nodiscard]] PlaceScore score_place(const VerifiedHypotheses& verified, std::size_t accepted,
                                     const ModelLibrary& library);

}  // namespace resight
