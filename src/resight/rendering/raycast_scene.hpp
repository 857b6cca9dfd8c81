// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <memory>
#include <span>
#include <vector>

#include "resight/core/image.hpp"
#include "resight/geometry/rigid3.hpp"
#include "resight/geometry/triangle_mesh.hpp"

namespace resight {

/// A ray in the world. `direction` need not be a unit vector: distances are counted in its length, so a direction with
/// z = 1 in the camera frame yields depths.
struct Ray {
  Eigen::Vector3f origin = Eigen::Vector3f::Zero();
  Eigen::Vector3f direction = Eigen::Vector3f::UnitZ();
};

/// Where a ray meets a surface first.
struct RayHit {
  float distance = 0;  ///< In lengths of the ray's direction.
  int instance = -1;   ///< -1 = nothing was hit.
  int face = -1;
  float b0 = 0;  ///< Barycentric weights of the face's first and second vertex, as for surface_color().
  float b1 = 0;
  [[nodiscard]] bool has_hit() const { return instance >= 0; }
};

/// Instanced meshes in a world, cast with rays (Embree). Build: add meshes and instances, then commit(). After a change
/// of poses or visibility commit() again; that costs about 0.1 ms, whatever the number of triangles. Casting is
/// thread-safe.
class RaycastScene {
 public:
  RaycastScene();
  ~RaycastScene();
  RaycastScene(RaycastScene&&) noexcept;
  RaycastScene& operator=(RaycastScene&&) noexcept;

  /// Adds a mesh, which is shared by its instances; its number. Throws std::invalid_argument for a mesh without faces,
  /// with a face index out of range, or with vertices that are not finite.
  int add_mesh(std::shared_ptr<const TriangleMesh> mesh);
  int add_mesh(TriangleMesh mesh) { return add_mesh(std::make_shared<const TriangleMesh>(std::move(mesh))); }
  /// Places a mesh; the number of the instance, counted from 0.
  int add_instance(int mesh, const Rigid3& world_from_mesh);
  void set_pose(int instance, const Rigid3& world_from_mesh);
  void set_visible(int instance, bool visible);
  /// Makes all changes effective. Must be called before casting.
  void commit();

  [[nodiscard]] int num_instances() const;
  [[nodiscard]] bool is_visible(int instance) const;
  [[nodiscard]] const Rigid3& pose(int instance) const;
  [[nodiscard]] const TriangleMesh& mesh(int instance) const;

  /// First hit of each ray beyond `min_distance` (both sides of a face count); `hits` has the length of `rays`.
  void cast(std::span<const Ray> rays, std::span<RayHit> hits, float min_distance = 0.0F) const;
  [[nodiscard]] RayHit cast(const Ray& ray, float min_distance = 0.0F) const;
  /// True if anything lies on the ray between the two distances.
  [[nodiscard]] bool is_blocked(const Ray& ray, float min_distance, float max_distance) const;

  /// Unit normal of the face that was hit, world frame, outward by the winding of the face.
  [[nodiscard]] Eigen::Vector3f face_normal(const RayHit& hit) const;
  /// Unit normal for shading: interpolated over the face where the mesh has vertex normals, else face_normal().
  [[nodiscard]] Eigen::Vector3f shading_normal(const RayHit& hit) const;
  /// Colour (0..255 a channel) of the surface, averaged over about `footprint_m` metres of it: the texture is read from
  /// a pyramid, trilinearly, so that prints far away do not alias. A footprint of 0 is surface_color().
  [[nodiscard]] Eigen::Vector3f color(const RayHit& hit, float footprint_m = 0.0F) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace resight
