// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <map>
#include <string>
#include <vector>

#include "resight/viewer/viewer_scene.hpp"

namespace resight {

/// The objects of a scene under one numbering: first those of the library, or of the list of models, in its order, then
/// others that results name.
class ObjectTable {
 public:
  struct Object {
    std::string name;
    int bop_id = 0;
  };
  explicit ObjectTable(const ViewerScene& scene);
  /// Number of the object; a new name gets the next one.
  int add(const std::string& name, int bop_id);
  /// Number of the object, or -1.
  [[nodiscard]] int find(const std::string& name) const;
  [[nodiscard]] const std::vector<Object>& objects() const { return objects_; }

 private:
  std::vector<Object> objects_;
  std::map<std::string, int> numbers_;
};

}  // namespace resight
