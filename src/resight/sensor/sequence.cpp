// SPDX-License-Identifier: Apache-2.0
#include "resight/sensor/sequence.hpp"

namespace resight {

Result<Rigid3> Sequence::read_pose(int view) const {
  const Result<RgbdFrame> frame = read_view(view);
  if (!frame) return frame.error();
  return frame->world_from_camera;
}

Result<std::vector<GroundTruthObject>> Sequence::read_ground_truth(int) const {
  return std::vector<GroundTruthObject>{};
}

std::vector<std::string> view_names(const Sequence& sequence) {
  std::vector<std::string> names;
  for (int v = 0; v < sequence.num_views(); ++v) names.push_back(sequence.view_name(v));
  return names;
}

}  // namespace resight
