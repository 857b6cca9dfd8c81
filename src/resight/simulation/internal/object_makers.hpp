// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "resight/simulation/procedural_objects.hpp"

namespace resight {

/// An object with the function that draws it.
struct ObjectMaker {
  std::string name;
  std::function<ProceduralObject()> make;
};

// Makers by family. procedural_object_names() lists them in this order.
[[nodiscard]] std::vector<ObjectMaker> package_makers();  ///< Boxes, cartons, books.
[[nodiscard]] std::vector<ObjectMaker> round_makers();    ///< Cans, bottles, crockery.
[[nodiscard]] std::vector<ObjectMaker> toy_makers();      ///< Toys and untextured objects.

}  // namespace resight
