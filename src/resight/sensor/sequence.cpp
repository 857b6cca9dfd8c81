// SPDX-License-Identifier: Apache-2.0
#include "resight/sensor/sequence.hpp"

namespace resight {

Result<std::vector<GroundTruthObject>> Sequence::read_ground_truth(int) const {
  return std::vector<GroundTruthObject>{};
}

}  // namespace resight
