// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <memory>
#include <span>

#include "resight/geometry/rigid3.hpp"
#include "resight/geometry/triangle_mesh.hpp"
#include "resight/rendering/surface_material.hpp"

namespace resight {

/// A ray in the world frame. `direction` need not be a unit vector: distances are multiples of its length, so a
/// direction with z = 1 in the camera frame gives depths.
struct Ray {
  Eigen::Vector3f origin = Eigen::Vector3f::Zero();
  Eigen::Vector3f direction = Eigen::Vector3f::UnitZ();
};

/// The first intersection of a ray with a surface.
struct RayHit {
  float distance = 0;  ///< In units of the length of the ray direction.
  int instance = -1;   ///< -1 if nothing was hit.
  int face = -1;
  float b0 = 0;  ///< Barycentric weights of the first and second vertex of the face, as in surface_color().
  float b1 = 0;
  [[nodiscard]] bool has_hit() const { return instance >= 0; }
};

/// A world of instanced meshes for ray casting (Embree). Add meshes and instances, then call commit(). Call it again
/// after changes of poses or visibility; this takes about 0.1 ms, independent of the number of triangles. Casting is
/// thread-safe.
class RaycastScene {
 public:
  RaycastScene();
  ~RaycastScene();
  RaycastScene(RaycastScene&&) noexcept;
  RaycastScene& operator=(RaycastScene&&) noexcept;

  /// Adds a mesh that its instances share. Returns its number. Throws std::invalid_argument for a mesh without faces,
  /// with a face index out of range, or with vertices that are not finite.
  int add_mesh(std::shared_ptr<const TriangleMesh> mesh);
  int add_mesh(TriangleMesh mesh) { return add_mesh(std::make_shared<const TriangleMesh>(std::move(mesh))); }
  /// Adds an instance of a mesh. Returns its number, counted from 0.
  int add_instance(int mesh, const Rigid3& world_from_mesh);
  /// Both take effect with the next commit(). Throw std::invalid_argument for an unknown instance or a pose that is not
  /// rigid.
  void set_pose(int instance, const Rigid3& world_from_mesh);
  void set_visible(int instance, bool visible);
  /// Takes effect at once. Throws std::invalid_argument for an unknown instance or an invalid material.
  void set_material(int instance, const SurfaceMaterial& material);
  /// Applies all changes. Must be called before casting.
  void commit();

  [[nodiscard]] int num_instances() const;
  [[nodiscard]] bool is_visible(int instance) const;
  [[nodiscard]] const Rigid3& pose(int instance) const;
  [[nodiscard]] const TriangleMesh& mesh(int instance) const;
  [[nodiscard]] const SurfaceMaterial& material(int instance) const;

  /// Finds the first hit of each ray beyond `min_distance`, on either side of a face. `hits` must be as long as `rays`.
  void cast(std::span<const Ray> rays, std::span<RayHit> hits, float min_distance = 0.0F) const;
  [[nodiscard]] RayHit cast(const Ray& ray, float min_distance = 0.0F) const;
  /// Whether anything lies on the ray between the two distances.
  [[nodiscard]] bool is_blocked(const Ray& ray, float min_distance, float max_distance) const;

  /// Unit normal of the hit face in the world frame, outward by the winding of the face.
  [[nodiscard]] Eigen::Vector3f face_normal(const RayHit& hit) const;
  /// Unit normal for shading: interpolated over the face if the mesh has vertex normals, else face_normal().
  [[nodiscard]] Eigen::Vector3f shading_normal(const RayHit& hit) const;
  /// Surface colour (0..255 per channel), averaged over about `footprint_m` metres. The texture is sampled trilinearly
  /// from a pyramid, which avoids aliasing at a distance. A footprint of 0 gives surface_color().
  [[nodiscard]] Eigen::Vector3f color(const RayHit& hit, float footprint_m = 0.0F) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace resight
