// SPDX-License-Identifier: Apache-2.0
#include "resight/models/object_model.hpp"

namespace resight {

int ModelLibrary::find(const std::string& name) const {
  for (std::size_t i = 0; i < objects.size(); ++i)
    if (objects[i].name == name) return static_cast<int>(i);
  return -1;
}

}  // namespace resight
