// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "resight/io/images.hpp"
#include "resight/io/internal/test_data.hpp"
#include "resight/io/mesh.hpp"

namespace resight {
namespace {

using nlohmann::json;
using testing::Each;

constexpr Rgb8 kWhite{255, 255, 255};
constexpr float kHalfOfSrgb = 0.2158605F;  // linear light of 128

/// A triangle with a material, written as "m.gltf" beside its buffer and its texture.
class GltfMaterial : public testing::Test {
 protected:
  GltfMaterial() {
    primitive()["attributes"]["POSITION"] = add<float>("VEC3", 5126, {0, 0, 0, 0.1F, 0, 0, 0, 0.1F, 0});
  }

  json& primitive(std::size_t i = 0) { return gltf_["meshes"][0]["primitives"][i]; }
  json& surface() { return gltf_["materials"][0]["pbrMetallicRoughness"]; }

  /// Three elements, and the number of their accessor.
  template <typename T>
  std::size_t add(const char* type, int component, const std::vector<T>& values) {
    buffer_.resize((buffer_.size() + 3) / 4 * 4);
    const std::size_t bytes = values.size() * sizeof(T);
    gltf_["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", buffer_.size()}, {"byteLength", bytes}});
    buffer_.append(reinterpret_cast<const char*>(values.data()), bytes);
    const std::size_t view = gltf_["bufferViews"].size() - 1;
    gltf_["accessors"].push_back(
        {{"bufferView", view}, {"componentType", component}, {"count", 3}, {"type", type}, {"normalized", true}});
    return view;
  }

  /// One texel per corner of the triangle: white, red and blue.
  void add_texture() {
    Image<Rgb8> texture(8, 8, kWhite);
    for (int v = 0; v < 4; ++v)
      for (int u = 4; u < 8; ++u) texture(u, v) = {255, 0, 0};
    for (int v = 4; v < 8; ++v)
      for (int u = 0; u < 4; ++u) texture(u, v) = {0, 0, 255};
    ASSERT_TRUE(write_color(directory_ / "t.png", texture).ok());
    surface()["baseColorTexture"]["index"] = 0;
    gltf_["textures"] = {{{"source", 0}}};
    gltf_["images"] = {{{"uri", "t.png"}}};
    primitive()["attributes"]["TEXCOORD_0"] = add<float>("VEC2", 5126, {0.1F, 0.1F, 0.9F, 0.1F, 0.1F, 0.9F});
  }

  Result<MeshFile> read() {
    gltf_["buffers"] = {{{"uri", "b.bin"}, {"byteLength", buffer_.size()}}};
    io::write_text(directory_ / "b.bin", buffer_);
    io::write_text(directory_ / "m.gltf", gltf_.dump());
    return read_mesh(directory_ / "m.gltf");
  }
  /// The colours of the corners of a face.
  std::vector<Rgb8> read_corners(int face = 0) {
    const auto mesh = read();
    EXPECT_TRUE(mesh.ok()) << mesh.error().message;
    if (!mesh.ok()) return {};
    warnings_ = mesh->warnings;
    return {surface_color(mesh->mesh, face, 1, 0), surface_color(mesh->mesh, face, 0, 1),
            surface_color(mesh->mesh, face, 0, 0)};
  }

  io::TestDirectory directory_;
  std::string buffer_;
  std::vector<std::string> warnings_;
  json gltf_ = json::parse(R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
    "meshes":[{"primitives":[{"material":0}]}],"materials":[{}],"accessors":[],"bufferViews":[]})");
};

TEST_F(GltfMaterial, ItsColourIsLinearLight) {
  surface()["baseColorFactor"] = {kHalfOfSrgb, 1, 0, 1};
  EXPECT_THAT(read_corners(), Each(Rgb8{128, 255, 0}));
}

TEST_F(GltfMaterial, VertexColoursAreLinearLightTimesItsColour) {
  const float x = kHalfOfSrgb;
  primitive()["attributes"]["COLOR_0"] = add<float>("VEC3", 5126, {x, x, x, 1, 0, x, 0, 2 * x, 1});
  EXPECT_THAT(read_corners(), testing::ElementsAre(Rgb8{128, 128, 128}, Rgb8{255, 0, 128}, Rgb8{0, 176, 255}));
  surface()["baseColorFactor"] = {1, 0.5, x, 1};
  EXPECT_THAT(read_corners(), testing::ElementsAre(Rgb8{128, 92, 61}, Rgb8{255, 0, 61}, Rgb8{0, 128, 128}));
  surface().erase("baseColorFactor");
  primitive()["attributes"]["COLOR_0"] =
      add<std::uint8_t>("VEC4", 5121, {55, 55, 0, 255, 55, 55, 0, 255, 55, 55, 0, 0});
  EXPECT_THAT(read_corners(), Each(Rgb8{128, 128, 0}));
}

TEST_F(GltfMaterial, ItsColourScalesTheLightOfItsTexture) {
  add_texture();
  EXPECT_THAT(read_corners(), testing::ElementsAre(kWhite, Rgb8{255, 0, 0}, Rgb8{0, 0, 255}));
  gltf_["meshes"][0]["primitives"].push_back(primitive());
  gltf_["materials"].push_back(gltf_["materials"][0]);
  primitive(1)["material"] = 1;
  surface()["baseColorFactor"] = {kHalfOfSrgb, 1, 0, 1};
  EXPECT_THAT(read_corners(0), testing::ElementsAre(Rgb8{128, 255, 0}, Rgb8{128, 0, 0}, Rgb8{0, 0, 0}));
  EXPECT_THAT(read_corners(1), testing::ElementsAre(kWhite, Rgb8{255, 0, 0}, Rgb8{0, 0, 255})) << "another material";
}

}  // namespace
}  // namespace resight
