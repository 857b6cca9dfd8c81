// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <model_library_generated.h>

#include "resight/models/internal/library_payload.hpp"

namespace resight::internal {
namespace {

using flatbuffers::FlatBufferBuilder;
using flatbuffers::Offset;
constexpr std::size_t kMaxEstimatedBytes = 2'000'000'000;

std::size_t estimate_bytes(const CodedFeatures& f) { return f.codes.size() + f.size() * 2 * sizeof(Eigen::Vector3f); }
std::size_t estimate_bytes(const ObjectSymmetries& s) { return s.discrete.size() * 96 + s.continuous.size() * 48; }
std::size_t estimate_bytes(const ModelLibrary& library) {
  std::size_t bytes = 4096;
  for (const ObjectModel& o : library.objects)
    bytes += 4096 + o.name.size() + o.surface.size() * 27 + estimate_bytes(o.sift) + estimate_bytes(o.shot) +
             estimate_bytes(o.symmetries) + estimate_bytes(o.shape_symmetries);
  return bytes;
}

Offset<flatbuffers::Vector<float>> write(FlatBufferBuilder& builder, const std::vector<Eigen::Vector3f>& vectors) {
  static_assert(sizeof(Eigen::Vector3f) == 3 * sizeof(float));
  return builder.CreateVector(vectors.empty() ? nullptr : vectors.front().data(), 3 * vectors.size());
}

Offset<schema::Surface> write(FlatBufferBuilder& builder, const PointCloud& cloud) {
  static_assert(sizeof(Rgb8) == 3);
  const auto points = write(builder, cloud.points);
  const auto normals = write(builder, cloud.normals);
  const auto colors =
      builder.CreateVector(reinterpret_cast<const std::uint8_t*>(cloud.colors.data()), 3 * cloud.colors.size());
  return schema::CreateSurface(builder, points, normals, colors);
}

Offset<schema::Features> write(FlatBufferBuilder& builder, const CodedFeatures& features) {
  const auto points = write(builder, features.points);
  const auto normals = write(builder, features.normals);
  const auto descriptors = builder.CreateVector(features.codes);
  return schema::CreateFeatures(builder, features.dimension, points, normals, descriptors);
}

schema::Motion to_file(const Rigid3& motion) {
  const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> rotation = motion.rotation;
  return {flatbuffers::span<const double, 9>(rotation.data(), 9),
          flatbuffers::span<const double, 3>(motion.translation.data(), 3)};
}

schema::Axis to_file(const RotationAxis& axis) {
  return {flatbuffers::span<const double, 3>(axis.direction.data(), 3),
          flatbuffers::span<const double, 3>(axis.point.data(), 3)};
}

struct WrittenSymmetries {
  Offset<flatbuffers::Vector<const schema::Motion*>> discrete;
  Offset<flatbuffers::Vector<const schema::Axis*>> continuous;
};

WrittenSymmetries write(FlatBufferBuilder& builder, const ObjectSymmetries& symmetries) {
  std::vector<schema::Motion> motions;
  for (const Rigid3& m : symmetries.discrete) motions.push_back(to_file(m));
  std::vector<schema::Axis> axes;
  for (const auto& c : symmetries.continuous) axes.push_back(to_file(c));
  return {builder.CreateVectorOfStructs(motions), builder.CreateVectorOfStructs(axes)};
}

Offset<schema::Object> write(FlatBufferBuilder& builder, const ObjectModel& object) {
  const auto name = builder.CreateString(object.name);
  const auto surface = write(builder, object.surface);
  const auto sift = write(builder, object.sift);
  const auto shot = write(builder, object.shot);
  const auto [discrete, continuous] = write(builder, object.symmetries);
  const auto [shape_discrete, shape_continuous] = write(builder, object.shape_symmetries);
  const schema::Vec3 center(object.center.x(), object.center.y(), object.center.z());
  return schema::CreateObject(builder, name, object.bop_id, surface, sift, shot, discrete, continuous, &center,
                              object.diameter_m, shape_discrete, shape_continuous);
}

}  // namespace

Result<std::vector<std::uint8_t>> encode_payload(const ModelLibrary& library) {
  const std::size_t bytes = estimate_bytes(library);
  if (bytes > kMaxEstimatedBytes)
    return Error{fmt::format("the library would take {:.1f} GB (a file can contain at most 2 GB)",
                             1e-9 * static_cast<double>(bytes))};
  FlatBufferBuilder builder(bytes);
  std::vector<Offset<schema::Object>> objects;
  for (const ObjectModel& object : library.objects) objects.push_back(write(builder, object));
  const auto all = builder.CreateVector(objects);
  builder.Finish(schema::CreateLibrary(builder, library.surface_voxel_m, all));
  return std::vector<std::uint8_t>(builder.GetBufferPointer(), builder.GetBufferPointer() + builder.GetSize());
}

}  // namespace resight::internal
