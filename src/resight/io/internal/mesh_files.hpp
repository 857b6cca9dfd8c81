// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "resight/io/internal/files.hpp"

namespace resight::io {

/// The files that a mesh refers to: regular files below its folder, in total not more than kMaxBinaryBytes. One that
/// cannot be read is empty.
class MeshFiles {
 public:
  using Bytes = std::shared_ptr<const std::string>;
  explicit MeshFiles(fs::path mesh) : mesh_(std::move(mesh)) {}

  /// The file that the mesh calls `name`. Each file is read once.
  [[nodiscard]] Bytes find(const std::string& name);
  /// Makes these bytes the file of that name.
  void set(const std::string& name, std::string bytes);
  /// A warning about the first file that could not be read, if there is one.
  void add_warning(std::vector<std::string>& warnings) const;
  /// Why that file could not be read; empty if there is none.
  [[nodiscard]] const std::string& failure() const { return failure_; }

 private:
  /// Where a file may be that the mesh calls `name`. Models that come from elsewhere name folders which do not exist
  /// here, and library files that were renamed with the mesh.
  [[nodiscard]] std::vector<std::string> places_of(const std::string& name) const;
  [[nodiscard]] const Result<Bytes>& read_once(const std::string& place);

  fs::path mesh_;
  std::uintmax_t bytes_left_ = kMaxBinaryBytes;
  std::map<std::string, Result<Bytes>> files_;  ///< By place.
  std::string failure_;
};

}  // namespace resight::io
