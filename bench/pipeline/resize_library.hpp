// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <utility>

#include "resight/models/object_model.hpp"

namespace resight {

/// Shortens the library to its first `count` objects, or repeats its objects under other names. It must not be empty.
inline void resize_library(ModelLibrary& library, std::size_t count) {
  const std::size_t num_given = library.objects.size();
  int max_id = 0;
  for (const ObjectModel& object : library.objects) max_id = std::max(max_id, object.bop_id);
  while (library.objects.size() > count) library.objects.pop_back();
  for (std::size_t i = num_given; i < count; ++i) {
    ObjectModel object = library.objects[i % num_given];
    object.name = fmt::format("{}_{}", object.name, i);
    object.bop_id = ++max_id;
    library.objects.push_back(std::move(object));
  }
}

}  // namespace resight
