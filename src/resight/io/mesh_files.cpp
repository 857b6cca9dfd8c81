// SPDX-License-Identifier: Apache-2.0
#include "resight/io/internal/mesh_files.hpp"

#include <algorithm>

namespace resight::io {

MeshFiles::Bytes MeshFiles::find(const std::string& name) {
  const auto [it, is_new] = files_.try_emplace(name);
  if (is_new) it->second = read(name);
  return it->second;
}

void MeshFiles::set(const std::string& name, std::string bytes) {
  files_[name] = std::make_shared<const std::string>(std::move(bytes));
}

void MeshFiles::add_warning(std::vector<std::string>& warnings) const {
  if (!failure_.empty()) warnings.push_back(mesh_.string() + ": a file that it names is left out: " + failure_);
}

std::vector<std::string> MeshFiles::places_of(std::string name) const {
  std::ranges::replace(name, '\\', '/');
  std::vector<std::string> places = {name, name.substr(name.rfind('/') + 1)};
  if (extension_of(mesh_) == "obj") places.push_back(mesh_.stem().string() + ".mtl");
  return places;
}

MeshFiles::Bytes MeshFiles::read(const std::string& name) {
  std::string failure;
  for (const std::string& place : places_of(name)) {
    const auto file = path_below(mesh_.parent_path(), place);
    auto bytes = file ? read_file(*file, bytes_left_) : Result<std::string>(file.error());
    if (bytes) {
      bytes_left_ -= bytes->size();
      return std::make_shared<const std::string>(*std::move(bytes));
    }
    if (failure.empty()) failure = bytes.error().message;
  }
  if (failure_.empty()) failure_ = failure;
  return std::make_shared<const std::string>();
}

}  // namespace resight::io
