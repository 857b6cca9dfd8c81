// SPDX-License-Identifier: Apache-2.0
#include "resight/io/internal/mesh_files.hpp"

#include <algorithm>

namespace resight::io {

MeshFiles::Bytes MeshFiles::find(const std::string& name) {
  std::string failure;
  for (const std::string& place : places_of(name)) {
    const Result<Bytes>& read = read_once(place);
    if (read) return *read;
    if (failure.empty()) failure = read.error().message;
  }
  if (failure_.empty()) failure_ = failure;
  return std::make_shared<const std::string>();
}

void MeshFiles::set(const std::string& name, std::string bytes) {
  files_.insert_or_assign(name, std::make_shared<const std::string>(std::move(bytes)));
}

void MeshFiles::add_warning(std::vector<std::string>& warnings) const {
  if (!failure_.empty()) warnings.push_back(mesh_.string() + ": a file that it names is left out: " + failure_);
}

std::vector<std::string> MeshFiles::places_of(const std::string& name) const {
  std::string path = name;
  std::ranges::replace(path, '\\', '/');
  std::vector<std::string> places = {name, path, path.substr(path.rfind('/') + 1)};
  if (extension_of(mesh_) == "obj") places.push_back(mesh_.stem().string() + ".mtl");
  return places;
}

const Result<MeshFiles::Bytes>& MeshFiles::read_once(const std::string& place) {
  if (const auto it = files_.find(place); it != files_.end()) return it->second;
  const auto file = path_below(mesh_.parent_path(), place);
  auto bytes = file ? read_file(*file, bytes_left_) : Result<std::string>(file.error());
  if (!bytes) return files_.emplace(place, bytes.error()).first->second;
  bytes_left_ -= bytes->size();
  return files_.emplace(place, std::make_shared<const std::string>(*std::move(bytes))).first->second;
}

}  // namespace resight::io
