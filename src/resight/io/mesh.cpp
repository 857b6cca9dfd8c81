// SPDX-License-Identifier: Apache-2.0
#include "resight/io/mesh.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "resight/core/check.hpp"
#include "resight/geometry/limits.hpp"
#include "resight/io/internal/files.hpp"
#include "resight/io/internal/mesh_parts.hpp"

namespace resight {
namespace {

/// The area of a closed box or ball is at most 3.2 times its squared diagonal; the rest is for what has many thin
/// parts.
constexpr double kMaxAreaPerSizeSq = 100;
/// The same for the largest object that is allowed: 250 m2 for 5 m.
constexpr double kMaxAreaPerLargestSizeSq = 10;

/// Suggests the unit that would make the size plausible, as a hint for the error message.
std::string guess_unit(double size_m, double metres_per_unit) {
  const double size_units = size_m / metres_per_unit;
  if (metres_per_unit == 0.001 && size_m < 0.005)
    return "looks like metres, not millimetres as in a BOP models folder (--mesh-unit m)";
  if (metres_per_unit == 1.0 && size_units >= 5 && size_units <= 5000) return "looks like millimetres (--mesh-unit mm)";
  return "check its unit";
}

double total_area_sq_m(const TriangleMesh& mesh) {
  double area_sq_m = 0;
  for (const auto& f : mesh.faces) {
    const Eigen::Vector3d a = mesh.vertices[f[0]].cast<double>();
    area_sq_m += (mesh.vertices[f[1]].cast<double>() - a).cross(mesh.vertices[f[2]].cast<double>() - a).norm() / 2;
  }
  return area_sq_m;
}

double diagonal_m(std::span<const Eigen::Vector3f> points_m) {
  Eigen::AlignedBox3f box;
  for (const Eigen::Vector3f& p : points_m) box.extend(p);
  return box.isEmpty() ? 0 : box.diagonal().cast<double>().norm();
}

/// Surfaces are sampled by area: faces on top of each other would make a small file fill the memory.
Result<void> check_area(const TriangleMesh& mesh, const ReadMeshOptions& options, const std::filesystem::path& file) {
  const double area_sq_m = total_area_sq_m(mesh);
  if (!(area_sq_m > 0)) return io::file_error(file, "has no surface: its faces are lines and points");
  const double size_m = diagonal_m(mesh.vertices);
  const double limit_sq_m =
      std::min(kMaxAreaPerSizeSq * size_m * size_m, kMaxAreaPerLargestSizeSq * options.max_size_m * options.max_size_m);
  if (area_sq_m <= limit_sq_m) return {};
  return io::file_error(
      file, fmt::format("its faces have an area of {:.4g} m2, too much for an object that is {:.3g} m large (at most "
                        "{:.4g} m2): do they lie on top of each other?",
                        area_sq_m, size_m, limit_sq_m));
}

}  // namespace

void ReadMeshOptions::check() const {
  check_positive("ReadMeshOptions.metres_per_unit", metres_per_unit);
  check_not_negative("ReadMeshOptions.min_size_m", min_size_m);
  require(max_size_m > min_size_m, "ReadMeshOptions.max_size_m must be more than min_size_m");
}

bool is_mesh_file(const std::filesystem::path& file) {
  const std::string extension = io::extension_of(file);
  return extension == "ply" || extension == "obj" || extension == "glb" || extension == "gltf" || extension == "stl";
}

Result<void> check_near_origin(const Eigen::AlignedBox3f& box_m, const std::filesystem::path& file) {
  if (box_m.isEmpty() || box_m.min().cwiseAbs().cwiseMax(box_m.max().cwiseAbs()).maxCoeff() <= kMaxObjectCoordinate_m)
    return {};
  return io::file_error(file, fmt::format("the object is {:.4g} m away from its origin (at most {} m): move it there",
                                          box_m.center().norm(), kMaxObjectCoordinate_m));
}

Result<void> check_size(std::span<const Eigen::Vector3f> points_m, const ReadMeshOptions& options,
                        const std::filesystem::path& file) {
  Eigen::AlignedBox3f box;
  for (const Eigen::Vector3f& p : points_m) box.extend(p);
  const double size_m = box.isEmpty() ? 0 : box.diagonal().cast<double>().norm();
  if (!(size_m >= options.min_size_m && size_m <= options.max_size_m))
    return io::file_error(
        file, fmt::format("the object is {:.4g} m large (expected {} to {} m): {}", size_m, options.min_size_m,
                          options.max_size_m, guess_unit(size_m, options.metres_per_unit)));
  return check_near_origin(box, file);
}

Result<MeshFile> read_mesh(const std::filesystem::path& file, const ReadMeshOptions& options) {
  options.check();
  if (!is_mesh_file(file))
    return io::file_error(file, "is not a supported mesh file (expected ply, obj, glb, gltf or stl)");
  auto imported = io::import_mesh_parts(file);
  if (!imported) return imported.error();
  io::JoinedMesh joined = io::join_parts(std::move(imported->parts));
  MeshFile result{std::move(joined.mesh), std::move(imported->warnings)};
  if (!joined.loss.empty())
    result.warnings.push_back(file.string() + ": its textures became vertex colours: " + joined.loss);
  TriangleMesh& mesh = result.mesh;
  for (Eigen::Vector3f& p : mesh.vertices) {
    if (options.metres_per_unit != 1.0) p = (p.cast<double>() * options.metres_per_unit).cast<float>();
    if (!p.allFinite()) return io::file_error(file, "holds vertices that are not finite");
  }
  for (Eigen::Vector2f& uv : mesh.uvs)
    if (!uv.allFinite()) uv.setZero();
  if (const auto done = check_size(mesh.vertices, options, file); !done) return done.error();
  if (const auto done = check_area(mesh, options, file); !done) return done.error();
  const auto is_unit = [](const Eigen::Vector3f& n) { return std::abs(n.squaredNorm() - 1) < 1e-3F; };
  if (mesh.normals.empty() || !std::ranges::all_of(mesh.normals, is_unit)) compute_vertex_normals(mesh);
  return result;
}

}  // namespace resight
