// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <assimp/IOSystem.hpp>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "resight/io/internal/files.hpp"

namespace resight::io {

/// Fails for an OBJ file with faces of more than 1024 corners or with more than 4096 parts: Assimp takes time in the
/// square of their number.
[[nodiscard]] Result<void> check_obj(std::string_view text);

/// The text of an OBJ file as Assimp reads it: without a byte order mark, and a number such as ".5" gets its leading
/// zero, without which Assimp skips it.
[[nodiscard]] std::string normalize_obj(std::string text);

/// The statements of a material library that we use: `newmtl`, and `Kd` and `map_Kd` after it. Assimp crashes on
/// textures before the first material.
[[nodiscard]] std::string normalize_mtl(std::string_view text);

/// The files that Assimp may open: the mesh under its bare name, and regular files in its folder that it refers to. A
/// file that cannot be read is empty, because Assimp 5.2 reads beyond the end of some names of files that do not exist:
/// of "a://", "\\\\" and " " (FileSystemFilter::Cleanup()).
class MeshFiles final : public Assimp::IOSystem {
 public:
  /// Reads and normalises the mesh file.
  [[nodiscard]] static Result<std::unique_ptr<MeshFiles>> open(const fs::path& mesh);

  bool Exists(const char* /*name*/) const override { return true; }
  char getOsSeparator() const override { return '/'; }
  Assimp::IOStream* Open(const char* name, const char* mode) override;
  void Close(Assimp::IOStream* stream) override;
  /// Why the first file that could not be read is empty. Empty if there is none.
  [[nodiscard]] const std::string& failure() const { return failure_; }

 private:
  using Bytes = std::shared_ptr<const std::string>;
  MeshFiles(fs::path mesh, std::string bytes);
  /// Each file is read once.
  [[nodiscard]] Bytes find(const std::string& name) const;
  /// Where a file may be that the mesh calls `name`. Models that come from elsewhere name folders which do not exist
  /// here, and library files that were renamed with the mesh.
  [[nodiscard]] std::vector<std::string> places_of(std::string name) const;
  [[nodiscard]] Bytes read(const std::string& name) const;

  fs::path mesh_;
  bool is_obj_;
  mutable std::uintmax_t bytes_left_ = kMaxBinaryBytes;
  mutable std::map<std::string, Bytes> files_;
  mutable std::string failure_;
};

}  // namespace resight::io
