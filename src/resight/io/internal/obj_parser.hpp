// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "resight/core/image.hpp"
#include "resight/core/result.hpp"

/// OBJ files and their material libraries. Assimp 5.2 crashes on damaged ones. tinyobjloader 2.0 checks no index,
/// counts corners in a byte and takes words for zero: whoever guards it must parse the file first.
namespace resight::io {

/// Numbers in the lists of ObjContent; -1: none.
struct ObjCorner {
  int position = -1;
  int uv = -1;
  int normal = -1;
};

struct ObjFace {
  int num_corners = 0;
  int material = -1;  ///< -1: none.
};

struct ObjMaterial {
  std::string name;
  std::optional<Rgb8> color;  ///< Kd.
  std::string texture;        ///< The file of map_Kd; empty: none.
};

/// What we use of an OBJ file. All numbers lie within their lists.
struct ObjContent {
  std::vector<Eigen::Vector3f> positions;
  std::vector<Eigen::Vector3f> colors;  ///< Of the positions, in [0, 1]. Empty unless all have one.
  std::vector<Eigen::Vector2f> uvs;     ///< v points up.
  std::vector<Eigen::Vector3f> normals;
  std::vector<ObjCorner> corners;  ///< Of the faces, one after the other.
  std::vector<ObjFace> faces;
  std::vector<ObjMaterial> materials;  ///< Those that faces use, without definitions.
  std::vector<std::string> libraries;  ///< Names of the files that define them.
};

/// Fails for a vertex without three finite numbers, a corner without a vertex, a face of more than 1024 corners, and
/// more than 4096 materials or libraries. A uv or normal that does not exist is none.
[[nodiscard]] Result<ObjContent> parse_obj(std::string text);

/// Fills in what material libraries say. Of several definitions, the last one counts.
void define_materials(std::span<const std::shared_ptr<const std::string>> libraries,
                      std::vector<ObjMaterial>& materials);

}  // namespace resight::io
