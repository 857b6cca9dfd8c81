// SPDX-License-Identifier: Apache-2.0
#include "resight/rendering/raycast_scene.hpp"

#include <embree3/rtcore.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <string>

#include "resight/core/check.hpp"
#include "resight/rendering/internal/texture_pyramid.hpp"

namespace resight {
namespace {

constexpr std::size_t kPacketSize = 8;

void check_mesh(const TriangleMesh& mesh) {
  require(!mesh.faces.empty(), "RaycastScene::add_mesh: the mesh has no faces");
  const int count = static_cast<int>(mesh.vertices.size());
  for (const auto& f : mesh.faces)
    for (const int v : f) require(v >= 0 && v < count, "RaycastScene::add_mesh: a face index is out of range");
  for (const auto& v : mesh.vertices) require(v.allFinite(), "RaycastScene::add_mesh: a vertex is not finite");
}

// Texels of the finest pyramid level per metre of a face.
float texel_density(const TriangleMesh& mesh, const std::array<int, 3>& f) {
  const Eigen::Vector3f a = mesh.vertices[f[1]] - mesh.vertices[f[0]];
  const Eigen::Vector3f b = mesh.vertices[f[2]] - mesh.vertices[f[0]];
  const Eigen::Array2f size(static_cast<float>(mesh.texture.width()), static_cast<float>(mesh.texture.height()));
  const Eigen::Array2f ta = (mesh.uvs[f[1]] - mesh.uvs[f[0]]).array() * size;
  const Eigen::Array2f tb = (mesh.uvs[f[2]] - mesh.uvs[f[0]]).array() * size;
  const float area = a.cross(b).norm();
  return area > 0 ? std::sqrt(std::abs(ta.x() * tb.y() - ta.y() * tb.x()) / area) : 0.0F;
}

struct MeshEntry {
  std::shared_ptr<const TriangleMesh> mesh;
  RTCScene scene = nullptr;
  TexturePyramid texture;
  std::vector<float> texels_per_m;  // Per face; empty without a texture.
};

struct InstanceEntry {
  int mesh = 0;
  Rigid3 world_from_mesh;
  Eigen::Matrix3f rotation;
  RTCGeometry geometry = nullptr;
  bool visible = true;
  SurfaceMaterial material{};
};

RTCScene build_mesh_scene(RTCDevice device, const TriangleMesh& mesh) {
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  // Embree reads 16 bytes per vertex. Its own buffers are padded accordingly.
  void* vertices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float),
                                           mesh.vertices.size());
  void* faces =
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(int), mesh.faces.size());
  std::memcpy(vertices, static_cast<const void*>(mesh.vertices.data()), mesh.vertices.size() * 3 * sizeof(float));
  std::memcpy(faces, static_cast<const void*>(mesh.faces.data()), mesh.faces.size() * 3 * sizeof(int));
  rtcCommitGeometry(geometry);
  RTCScene scene = rtcNewScene(device);
  rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
  rtcAttachGeometry(scene, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(scene);
  return scene;
}

void set_transform(RTCGeometry geometry, const Rigid3& world_from_mesh) {
  const Eigen::Matrix<float, 3, 4> m = world_from_mesh.matrix().topRows<3>().cast<float>();
  rtcSetGeometryTransform(geometry, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, m.data());
  rtcCommitGeometry(geometry);
}

}  // namespace

struct RaycastScene::Impl {
  Impl() : device(rtcNewDevice(nullptr)) {
    if (device == nullptr) throw std::runtime_error("RaycastScene: Embree cannot start on this machine");
    scene = rtcNewScene(device);
    rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
  }
  ~Impl() {
    for (InstanceEntry& i : instances) rtcReleaseGeometry(i.geometry);
    rtcReleaseScene(scene);
    for (MeshEntry& m : meshes) rtcReleaseScene(m.scene);
    rtcReleaseDevice(device);
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  [[nodiscard]] const InstanceEntry& instance(int i) const {
    require(i >= 0 && i < static_cast<int>(instances.size()), "RaycastScene: no instance " + std::to_string(i));
    return instances[i];
  }
  [[nodiscard]] const MeshEntry& entry(const RayHit& hit) const { return meshes[instances[hit.instance].mesh]; }

  RTCDevice device;
  RTCScene scene = nullptr;
  std::vector<MeshEntry> meshes;
  std::vector<InstanceEntry> instances;
};

RaycastScene::RaycastScene() : impl_(std::make_unique<Impl>()) {}
RaycastScene::~RaycastScene() = default;
RaycastScene::RaycastScene(RaycastScene&&) noexcept = default;
RaycastScene& RaycastScene::operator=(RaycastScene&&) noexcept = default;

int RaycastScene::add_mesh(std::shared_ptr<const TriangleMesh> mesh) {
  require(mesh != nullptr, "RaycastScene::add_mesh: the mesh is missing");
  check_mesh(*mesh);
  MeshEntry entry{nullptr, build_mesh_scene(impl_->device, *mesh), TexturePyramid({}), {}};
  if (mesh->has_texture()) {
    entry.texture = TexturePyramid(mesh->texture);
    for (const auto& f : mesh->faces) entry.texels_per_m.push_back(texel_density(*mesh, f));
  }
  entry.mesh = std::move(mesh);
  impl_->meshes.push_back(std::move(entry));
  return static_cast<int>(impl_->meshes.size()) - 1;
}

int RaycastScene::add_instance(int mesh, const Rigid3& world_from_mesh) {
  require(mesh >= 0 && mesh < static_cast<int>(impl_->meshes.size()), "RaycastScene::add_instance: no such mesh");
  require(world_from_mesh.is_rigid(), "RaycastScene::add_instance: the pose is not a rigid motion");
  InstanceEntry entry;
  entry.mesh = mesh;
  entry.geometry = rtcNewGeometry(impl_->device, RTC_GEOMETRY_TYPE_INSTANCE);
  rtcSetGeometryInstancedScene(entry.geometry, impl_->meshes[mesh].scene);
  rtcSetGeometryTimeStepCount(entry.geometry, 1);
  const auto id = static_cast<unsigned>(impl_->instances.size());
  rtcAttachGeometryByID(impl_->scene, entry.geometry, id);
  impl_->instances.push_back(entry);
  set_pose(static_cast<int>(id), world_from_mesh);
  return static_cast<int>(id);
}

void RaycastScene::set_pose(int instance, const Rigid3& world_from_mesh) {
  require(world_from_mesh.is_rigid(), "RaycastScene::set_pose: the pose is not a rigid motion");
  static_cast<void>(impl_->instance(instance));
  InstanceEntry& entry = impl_->instances[instance];
  entry.world_from_mesh = world_from_mesh;
  entry.rotation = world_from_mesh.rotation.cast<float>();
  set_transform(entry.geometry, world_from_mesh);
}

void RaycastScene::set_visible(int instance, bool visible) {
  static_cast<void>(impl_->instance(instance));
  InstanceEntry& entry = impl_->instances[instance];
  entry.visible = visible;
  if (visible) {
    rtcEnableGeometry(entry.geometry);
  } else {
    rtcDisableGeometry(entry.geometry);
  }
}

void RaycastScene::set_material(int instance, const SurfaceMaterial& material) {
  static_cast<void>(impl_->instance(instance));
  material.check();
  impl_->instances[instance].material = material;
}

void RaycastScene::commit() { rtcCommitScene(impl_->scene); }
int RaycastScene::num_instances() const { return static_cast<int>(impl_->instances.size()); }
bool RaycastScene::is_visible(int instance) const { return impl_->instance(instance).visible; }
const Rigid3& RaycastScene::pose(int instance) const { return impl_->instance(instance).world_from_mesh; }
const TriangleMesh& RaycastScene::mesh(int instance) const {
  return *impl_->meshes[impl_->instance(instance).mesh].mesh;
}

const SurfaceMaterial& RaycastScene::material(int instance) const { return impl_->instance(instance).material; }

void RaycastScene::cast(std::span<const Ray> rays, std::span<RayHit> hits, float min_distance) const {
  require(rays.size() == hits.size(), "RaycastScene::cast: rays and hits differ in length");
  for (std::size_t begin = 0; begin < rays.size(); begin += kPacketSize) {
    const std::size_t count = std::min(kPacketSize, rays.size() - begin);
    alignas(32) RTCRayHit8 packet;
    alignas(32) int valid[kPacketSize];
    for (std::size_t i = 0; i < kPacketSize; ++i) {
      valid[i] = i < count ? -1 : 0;
      const Ray& ray = rays[begin + std::min(i, count - 1)];
      packet.ray.org_x[i] = ray.origin.x();
      packet.ray.org_y[i] = ray.origin.y();
      packet.ray.org_z[i] = ray.origin.z();
      packet.ray.dir_x[i] = ray.direction.x();
      packet.ray.dir_y[i] = ray.direction.y();
      packet.ray.dir_z[i] = ray.direction.z();
      packet.ray.tnear[i] = min_distance;
      packet.ray.tfar[i] = std::numeric_limits<float>::infinity();
      packet.ray.time[i] = 0;
      packet.ray.mask[i] = ~0U;
      packet.ray.id[i] = 0;
      packet.ray.flags[i] = 0;
      packet.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
      packet.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
    }
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    rtcIntersect8(valid, impl_->scene, &context, &packet);
    for (std::size_t i = 0; i < count; ++i) {
      RayHit& hit = hits[begin + i];
      hit = {};
      if (packet.hit.geomID[i] == RTC_INVALID_GEOMETRY_ID) continue;
      hit.distance = packet.ray.tfar[i];
      hit.instance = static_cast<int>(packet.hit.instID[0][i]);
      hit.face = static_cast<int>(packet.hit.primID[i]);
      hit.b0 = 1 - packet.hit.u[i] - packet.hit.v[i];
      hit.b1 = packet.hit.u[i];
    }
  }
}

RayHit RaycastScene::cast(const Ray& ray, float min_distance) const {
  RayHit hit;
  cast({&ray, 1}, {&hit, 1}, min_distance);
  return hit;
}

bool RaycastScene::is_blocked(const Ray& ray, float min_distance, float max_distance) const {
  alignas(16) RTCRay query;
  query.org_x = ray.origin.x();
  query.org_y = ray.origin.y();
  query.org_z = ray.origin.z();
  query.dir_x = ray.direction.x();
  query.dir_y = ray.direction.y();
  query.dir_z = ray.direction.z();
  query.tnear = min_distance;
  query.tfar = max_distance;
  query.time = 0;
  query.mask = ~0U;
  query.id = 0;
  query.flags = 0;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcOccluded1(impl_->scene, &context, &query);
  return query.tfar < 0;
}

Eigen::Vector3f RaycastScene::face_normal(const RayHit& hit) const {
  const TriangleMesh& mesh = *impl_->entry(hit).mesh;
  const auto& f = mesh.faces[hit.face];
  const Eigen::Vector3f a = mesh.vertices[f[1]] - mesh.vertices[f[0]];
  const Eigen::Vector3f b = mesh.vertices[f[2]] - mesh.vertices[f[0]];
  return (impl_->instances[hit.instance].rotation * a.cross(b)).normalized();
}

Eigen::Vector3f RaycastScene::shading_normal(const RayHit& hit) const {
  const TriangleMesh& mesh = *impl_->entry(hit).mesh;
  if (mesh.normals.size() != mesh.vertices.size()) return face_normal(hit);
  const auto& f = mesh.faces[hit.face];
  const Eigen::Vector3f n =
      hit.b0 * mesh.normals[f[0]] + hit.b1 * mesh.normals[f[1]] + (1 - hit.b0 - hit.b1) * mesh.normals[f[2]];
  return (impl_->instances[hit.instance].rotation * n).normalized();
}

Eigen::Vector3f RaycastScene::color(const RayHit& hit, float footprint_m) const {
  const MeshEntry& entry = impl_->entry(hit);
  if (entry.texture.empty()) {
    const Rgb8 c = surface_color(*entry.mesh, hit.face, hit.b0, hit.b1);
    return {static_cast<float>(c.r), static_cast<float>(c.g), static_cast<float>(c.b)};
  }
  const auto& f = entry.mesh->faces[hit.face];
  const auto& uvs = entry.mesh->uvs;
  const Eigen::Vector2f uv = hit.b0 * uvs[f[0]] + hit.b1 * uvs[f[1]] + (1 - hit.b0 - hit.b1) * uvs[f[2]];
  const float texels = footprint_m * entry.texels_per_m[hit.face];
  return entry.texture.sample(uv, texels > 1 ? std::log2(texels) : 0.0F);
}

}  // namespace resight
