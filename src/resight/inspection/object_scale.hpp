// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "resight/core/result.hpp"
#include "resight/inspection/finding.hpp"
#include "resight/models/object_model.hpp"
#include "resight/sensor/sequence.hpp"

namespace resight {

/// How large an object appears in one view.
struct ObjectScale {
  int object = 0;
  int view = 0;
  double log_scale = 0;  ///< Natural logarithm of its size in the view over that of its model.
  int num_matches = 0;   ///< Matches of features that agree with the pose at this scale.
};

/// Sizes of known objects in the views of a sequence.
struct ObjectScales {
  std::vector<ObjectScale> found;  ///< By view, then object.
  int num_views = 0;               ///< Searched ones.
  int num_objects = 0;             ///< Those with features that can be found.
  /// Fewer objects may be found by chance.
  [[nodiscard]] bool is_measured() const { return found.size() >= 3; }
};

struct MeasureObjectScalesOptions {
  int max_views = 12;  ///< Searched ones, spread over the sequence.
  int num_threads = 1;
};

/// Finds objects by matched SIFT features at any scale: poses are fitted to the matches at the scales at which the
/// distances between them are those of the model. The units of depth and models do not matter. Untextured objects are
/// not found. Fails with the error of the first view that cannot be read.
[[nodiscard]] Result<ObjectScales> measure_object_scales(const Sequence& sequence, const ModelLibrary& library,
                                                         const MeasureObjectScalesOptions& options = {});

/// Objects that are not as large as their models: all of them, which is the unit of the depth or of the models, or
/// single ones.
[[nodiscard]] std::vector<Finding> find_scale_faults(const ObjectScales& scales, const ModelLibrary& library);

/// One line: how large the objects are beside their models; or, if is_measured() is false, what is not known.
[[nodiscard]] std::string describe_scales(const ObjectScales& scales);

}  // namespace resight
