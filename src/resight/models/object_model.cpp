// SPDX-License-Identifier: Apache-2.0
#include "resight/models/object_model.hpp"

#include <algorithm>

#include "resight/core/check.hpp"

namespace resight {

int ModelLibrary::find(const std::string& name) const {
  for (std::size_t i = 0; i < objects.size(); ++i)
    if (objects[i].name == name) return static_cast<int>(i);
  return -1;
}

float ModelLibrary::largest_diameter_m() const {
  float largest_m = 0;
  for (const ObjectModel& object : objects) largest_m = std::max(largest_m, object.diameter_m);
  return largest_m;
}

const ObjectModel& ModelLibrary::object(int index) const {
  require(index >= 0 && static_cast<std::size_t>(index) < objects.size(),
          "object " + std::to_string(index) + " is not in the library, which has " + std::to_string(objects.size()));
  return objects[static_cast<std::size_t>(index)];
}

}  // namespace resight
