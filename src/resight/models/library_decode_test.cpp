// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <model_library_generated.h>

#include "resight/models/internal/library_payload.hpp"

namespace resight::internal {
namespace {

// A payload in which all objects have the same 200 symmetry motions, stored once.
std::vector<std::uint8_t> share_motions(int num_objects) {
  flatbuffers::FlatBufferBuilder builder;
  const Rigid3 still;
  const std::vector<schema::Motion> motions(
      200, schema::Motion(flatbuffers::span<const double, 9>(still.rotation.data(), 9),
                          flatbuffers::span<const double, 3>(still.translation.data(), 3)));
  const auto discrete = builder.CreateVectorOfStructs(motions);
  const auto continuous = builder.CreateVectorOfStructs(std::vector<schema::Axis>());
  const auto points = builder.CreateVector(std::vector<float>());
  const auto bytes = builder.CreateVector(std::vector<std::uint8_t>());
  const auto surface = schema::CreateSurface(builder, points, points, bytes);
  const auto features = schema::CreateFeatures(builder, 0, points, points, bytes);
  const schema::Vec3 center(0, 0, 0);
  std::vector<flatbuffers::Offset<schema::Object>> objects;
  for (int i = 0; i < num_objects; ++i)
    objects.push_back(schema::CreateObject(builder, builder.CreateString("object " + std::to_string(i)), 1, surface,
                                           features, features, discrete, continuous, &center, 0.1F));
  builder.Finish(schema::CreateLibrary(builder, 0.003F, builder.CreateVector(objects)));
  return {builder.GetBufferPointer(), builder.GetBufferPointer() + builder.GetSize()};
}

TEST(DecodePayload, ObjectsThatShareTheirPartsDoNotFillTheMemory) {
  const auto one = decode_payload(share_motions(1));
  ASSERT_TRUE(one.ok()) << one.error().message;
  EXPECT_EQ(one->objects[0].symmetries.discrete.size(), 200U);
  const auto many = decode_payload(share_motions(50));
  ASSERT_FALSE(many.ok());
  EXPECT_THAT(many.error().message, testing::HasSubstr("hold more than the file does"));
}

}  // namespace
}  // namespace resight::internal
