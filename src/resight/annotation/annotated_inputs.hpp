// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "resight/models/object_model.hpp"
#include "resight/sensor/sequence.hpp"

namespace resight {

/// What a project belongs to, wherever the files are: names and poses (to 1e-6) of all views, cameras and pixels of up
/// to 8 of them (depth to 0.1 mm), and names, numbers and surface sizes of the models. Fails if a view cannot be read.
struct AnnotatedInputs {
  std::string digest;
  std::string earlier_digest;  ///< Of projects begun before rotations and pixels counted.
};
[[nodiscard]] Result<AnnotatedInputs> identify_inputs(const Sequence& sequence, const ModelLibrary& library);

/// Up to 8 views, from the first to the last one, whose pixels tell whether a sequence is the same. A sequence of 1,000
/// views opens in less than 2 s.
[[nodiscard]] std::vector<int> views_that_identify(int num_views);

}  // namespace resight
