// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <utility>
#include <vector>

#include "resight/models/object_model.hpp"

namespace resight {

/// Pairs of objects that no view tells apart: equal in shape and colour, each in its own frame. Of the points of either
/// object, 95 % have a point of the other within two voxels (ModelLibrary::surface_voxel_m), of a colour that differs
/// by at most 32 of 255 in each channel. Indices into the library, the smaller one first.
[[nodiscard]] std::vector<std::pair<std::size_t, std::size_t>> find_equal_objects(const ModelLibrary& library);

}  // namespace resight
