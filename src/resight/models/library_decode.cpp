// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <model_library_generated.h>

#include <Eigen/Geometry>
#include <cmath>
#include <cstring>
#include <set>

#include "resight/core/names.hpp"
#include "resight/core/parallel.hpp"
#include "resight/geometry/limits.hpp"
#include "resight/models/internal/library_payload.hpp"

namespace resight::internal {
namespace {

constexpr float kUnitTolerance = 1e-2F;
constexpr float kMinVoxel_m = 1e-4F;
constexpr float kMaxVoxel_m = 1;
constexpr double kMaxDiameter_m = 4 * kMaxObjectCoordinate_m;  // more than the diagonal of all allowed points

bool read(const flatbuffers::Vector<float>* values, std::vector<Eigen::Vector3f>& vectors) {
  if (values == nullptr || values->size() % 3 != 0) return false;
  vectors.resize(values->size() / 3);
  if (!vectors.empty()) std::memcpy(vectors.front().data(), values->data(), sizeof(float) * values->size());
  return true;
}

/// False for NaN, and beyond the limit: such coordinates would not fit into the integers of pixels and voxels.
bool are_near(const std::vector<Eigen::Vector3f>& points) {
  for (const Eigen::Vector3f& p : points)
    if (!(p.cwiseAbs().maxCoeff() <= kMaxObjectCoordinate_m) || !p.allFinite()) return false;
  return true;
}

bool are_unit(const std::vector<Eigen::Vector3f>& normals) {
  for (const Eigen::Vector3f& n : normals)
    if (!(std::abs(n.norm() - 1) < kUnitTolerance)) return false;
  return true;
}

bool read(const schema::Surface* surface, PointCloud& cloud) {
  if (surface == nullptr || surface->colors() == nullptr) return false;
  if (!read(surface->points(), cloud.points) || !read(surface->normals(), cloud.normals)) return false;
  const std::size_t n = cloud.points.size();
  if (!are_near(cloud.points) || cloud.normals.size() != n || !are_unit(cloud.normals)) return false;
  const std::size_t num_colors = surface->colors()->size() / 3;
  if (surface->colors()->size() % 3 != 0 || (num_colors != 0 && num_colors != n)) return false;
  cloud.colors.resize(num_colors);
  if (num_colors > 0) std::memcpy(cloud.colors.data(), surface->colors()->data(), 3 * n);
  return true;
}

bool read(const schema::Features* stored, FeatureType type, int dimension, CodedFeatures& features) {
  if (stored == nullptr || stored->descriptors() == nullptr) return false;
  features.type = type;
  features.dimension = stored->dimension();
  if (!read(stored->points(), features.points) || !read(stored->normals(), features.normals)) return false;
  const std::size_t n = features.size();
  if (!are_near(features.points) || features.normals.size() != n || !are_unit(features.normals)) return false;
  if (n == 0) return stored->descriptors()->size() == 0 && (features.dimension == 0 || features.dimension == dimension);
  if (features.dimension != dimension || stored->descriptors()->size() != n * static_cast<std::size_t>(dimension))
    return false;
  const std::span codes(stored->descriptors()->data(), stored->descriptors()->size());
  if (has_zero_row(codes, dimension)) return false;
  features.codes.assign(codes.begin(), codes.end());
  return true;
}

bool read(const schema::Motion& stored, Rigid3& motion) {
  for (int i = 0; i < 9; ++i) motion.rotation(i / 3, i % 3) = stored.rotation()->Get(static_cast<std::uint16_t>(i));
  for (int i = 0; i < 3; ++i) motion.translation(i) = stored.translation()->Get(static_cast<std::uint16_t>(i));
  return is_possible_symmetry(motion);
}

bool read(const schema::Axis& stored, RotationAxis& axis) {
  for (int i = 0; i < 3; ++i) {
    axis.direction(i) = stored.direction()->Get(static_cast<std::uint16_t>(i));
    axis.point(i) = stored.offset()->Get(static_cast<std::uint16_t>(i));
  }
  return is_possible_symmetry(axis);
}

template <typename Stored, typename Value>
bool read_all(const flatbuffers::Vector<const Stored*>* stored, std::vector<Value>& values) {
  if (stored == nullptr) return false;
  for (const Stored* s : *stored)
    if (!read(*s, values.emplace_back())) return false;
  return true;
}

std::size_t count_bytes(const schema::Surface* surface) {
  if (surface == nullptr || surface->points() == nullptr || surface->normals() == nullptr) return 0;
  const std::size_t num_colors = surface->colors() != nullptr ? surface->colors()->size() : 0;
  return sizeof(float) * (std::size_t{surface->points()->size()} + surface->normals()->size()) + num_colors;
}

std::size_t count_bytes(const schema::Features* features) {
  if (features == nullptr || features->points() == nullptr || features->normals() == nullptr) return 0;
  const std::size_t num_codes = features->descriptors() != nullptr ? features->descriptors()->size() : 0;
  return sizeof(float) * (std::size_t{features->points()->size()} + features->normals()->size()) + num_codes;
}

template <typename Stored>
std::size_t count_bytes(const flatbuffers::Vector<const Stored*>* values) {
  return values != nullptr ? sizeof(Stored) * std::size_t{values->size()} : 0;
}

std::size_t count_bytes(const schema::Object& object) {
  return count_bytes(object.surface()) + count_bytes(object.sift()) + count_bytes(object.shot()) +
         count_bytes(object.discrete_symmetries()) + count_bytes(object.continuous_symmetries()) +
         count_bytes(object.discrete_shape_symmetries()) + count_bytes(object.continuous_shape_symmetries());
}

/// Whether centre and diameter can be those of the surface. Views are cropped to them.
bool fits_surface(const ObjectModel& object) {
  if (object.surface.empty()) return true;
  Eigen::AlignedBox3f box;
  for (const Eigen::Vector3f& p : object.surface.points) box.extend(p);
  const float diagonal_m = box.diagonal().norm() + kMaxVoxel_m / 100;
  return object.diameter_m <= 2 * diagonal_m && (object.center - box.center()).norm() <= diagonal_m;
}

// Decodes one object. Returns the name of the damaged part, or an empty string.
std::string read(const schema::Object& stored, ObjectModel& object) {
  object.name = stored.name()->str();
  object.bop_id = stored.bop_id();
  if (object.bop_id < 0) return "obj_id";
  if (!read(stored.surface(), object.surface)) return "surface";
  if (!read(stored.sift(), FeatureType::kSift, 128, object.sift)) return "SIFT features";
  if (!read(stored.shot(), FeatureType::kShot, 352, object.shot)) return "SHOT features";
  if (!read_all(stored.discrete_symmetries(), object.symmetries.discrete)) return "symmetries";
  if (!read_all(stored.continuous_symmetries(), object.symmetries.continuous)) return "symmetries";
  if (!has_few_motions(object.symmetries)) return "symmetries";
  const auto* discrete = stored.discrete_shape_symmetries();
  const auto* continuous = stored.continuous_shape_symmetries();
  if (discrete != nullptr && !read_all(discrete, object.shape_symmetries.discrete)) return "shape symmetries";
  if (continuous != nullptr && !read_all(continuous, object.shape_symmetries.continuous)) return "shape symmetries";
  if (!has_few_motions(object.shape_symmetries)) return "shape symmetries";
  if (stored.center() == nullptr) return "centre";
  object.center = {stored.center()->x(), stored.center()->y(), stored.center()->z()};
  object.diameter_m = stored.diameter_m();
  if (!are_near({object.center})) return "centre";
  return object.diameter_m >= 0 && object.diameter_m <= kMaxDiameter_m && fits_surface(object) ? "" : "diameter";
}

}  // namespace

Result<ModelLibrary> decode_payload(std::span<const std::uint8_t> payload) {
  flatbuffers::Verifier verifier(payload.data(), payload.size());
  if (!schema::VerifyLibraryBuffer(verifier)) return Error{"damaged: its payload is not a model library"};
  const schema::Library& stored = *schema::GetLibrary(payload.data());
  ModelLibrary library;
  library.surface_voxel_m = stored.surface_voxel_m();
  if (!(library.surface_voxel_m >= kMinVoxel_m && library.surface_voxel_m <= kMaxVoxel_m) ||
      stored.objects() == nullptr)
    return Error{"damaged: it has no objects, or no voxel size of surfaces"};
  const auto& objects = *stored.objects();
  std::set<std::string> names;  // Names are checked first, so that duplicates are not decoded.
  for (const schema::Object* object : objects) {
    if (object->name() == nullptr) return Error{"damaged: the name of an object cannot be read"};
    const std::string name = object->name()->str();
    if (const auto checked = check_object_name(name); !checked) return Error{"damaged: " + checked.error().message};
    if (!names.insert(name).second) return Error{fmt::format("damaged: two objects are named '{}'", name)};
  }
  // Objects could share their parts, and a small file fill the memory.
  std::size_t num_bytes = 0;
  for (const schema::Object* object : objects) num_bytes += count_bytes(*object);
  if (num_bytes > payload.size()) return Error{"damaged: its objects hold more than the file does"};
  library.objects.resize(objects.size());
  std::vector<std::string> damaged_parts(objects.size());
  parallel_for(objects.size(), num_hardware_threads(), [&](std::size_t i) {
    damaged_parts[i] = read(*objects[static_cast<flatbuffers::uoffset_t>(i)], library.objects[i]);
  });
  for (std::size_t i = 0; i < damaged_parts.size(); ++i)
    if (!damaged_parts[i].empty())
      return Error{
          fmt::format("damaged: the {} of object '{}' cannot be read", damaged_parts[i], library.objects[i].name)};
  return library;
}

}  // namespace resight::internal
