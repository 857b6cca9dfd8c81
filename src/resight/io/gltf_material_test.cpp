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
using testing::HasSubstr;

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

  /// Coordinates that have to be computed.
  std::vector<Eigen::Vector2f> read_scaled_uvs() {
    add_texture();
    surface()["baseColorTexture"]["extensions"]["KHR_texture_transform"]["scale"] = {0.5, 1};
    return read()->mesh.uvs;
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

// The corners of the triangle are white, red and blue.
const auto kTextured = testing::ElementsAre(kWhite, Rgb8{255, 0, 0}, Rgb8{0, 0, 255});

TEST_F(GltfMaterial, TextureCoordinatesMayBeWholeNumbers) {
  add_texture();
  json& uvs = primitive()["attributes"]["TEXCOORD_0"];
  uvs = add<std::uint16_t>("VEC2", 5123, {6554, 6554, 58982, 6554, 6554, 58982});
  EXPECT_THAT(read_corners(), kTextured);
  uvs = add<std::uint8_t>("VEC2", 5121, {26, 26, 0, 0, 230, 26, 0, 0, 26, 230});
  gltf_["bufferViews"].back()["byteStride"] = 4;
  EXPECT_THAT(read_corners(), kTextured);
}

TEST_F(GltfMaterial, AnySetOfTextureCoordinates) {
  add_texture();
  json& attributes = primitive()["attributes"];
  attributes["TEXCOORD_3"] = attributes["TEXCOORD_0"];
  attributes["TEXCOORD_0"] = add<float>("VEC2", 5126, std::vector<float>(6, 0.1F));
  EXPECT_THAT(read_corners(), Each(kWhite));
  surface()["baseColorTexture"]["texCoord"] = 3;
  EXPECT_THAT(read_corners(), kTextured);
  surface()["baseColorTexture"]["texCoord"] = 0;
  surface()["baseColorTexture"]["extensions"]["KHR_texture_transform"]["texCoord"] = 3;
  EXPECT_THAT(read_corners(), kTextured);
}

// The example of the extension: the lower left quadrant, rotated by 90 deg.
TEST_F(GltfMaterial, TextureTransforms) {
  add_texture();
  gltf_["extensionsRequired"] = {"KHR_texture_transform"};
  surface()["baseColorTexture"]["extensions"]["KHR_texture_transform"] = {
      {"offset", {0, 1}}, {"rotation", 1.5707963}, {"scale", {0.5, 0.5}}};
  const auto uvs = read()->mesh.uvs;
  ASSERT_EQ(uvs.size(), 3U);
  EXPECT_LT((uvs[0] - Eigen::Vector2f(0.05F, 0.95F)).norm(), 1e-6F);
  EXPECT_LT((uvs[1] - Eigen::Vector2f(0.05F, 0.55F)).norm(), 1e-6F);
  EXPECT_LT((uvs[2] - Eigen::Vector2f(0.45F, 0.95F)).norm(), 1e-6F);
  surface()["baseColorTexture"]["extensions"]["KHR_texture_transform"] = {{"scale", {-1, 1}}, {"offset", {1, 0}}};
  EXPECT_THAT(read_corners(), testing::ElementsAre(Rgb8{255, 0, 0}, kWhite, kWhite));
}

TEST_F(GltfMaterial, DamagedTextureCoordinatesAreRefused) {
  add_texture();
  json& transform = surface()["baseColorTexture"]["extensions"]["KHR_texture_transform"];
  const auto message = [&] {
    const auto mesh = read();
    return mesh.ok() ? std::string() : mesh.error().message;
  };
  for (const char* key : {"offset", "scale"})
    for (const json& wrong : {json::array(), json{1}, json{"a", "b"}, json(1)}) {
      transform = {{key, wrong}};
      EXPECT_THAT(message(), HasSubstr("KHR_texture_transform")) << transform;
    }
  transform = {{"rotation", json::array()}};
  EXPECT_THAT(message(), HasSubstr("KHR_texture_transform"));
  transform = {{"rotation", 1}};
  EXPECT_EQ(message(), "");
  buffer_.resize(buffer_.size() - 4);  // the file is shorter than it says
  EXPECT_THAT(message(), HasSubstr("cut off?"));
}

std::string to_base64(const std::string& bytes) {
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < 8 * bytes.size(); i += 6) {
    std::size_t digit = 0;
    for (std::size_t bit = i; bit < i + 6; ++bit)
      digit = 2 * digit + (bit / 8 < bytes.size() ? static_cast<std::uint8_t>(bytes[bit / 8]) >> (7 - bit % 8) & 1 : 0);
    text += kDigits[digit];
  }
  return text + std::string((4 - text.size() % 4) % 4, '=');
}

TEST_F(GltfMaterial, TheBufferMayBeInTheText) {
  const auto uvs = read_scaled_uvs();
  ASSERT_EQ(uvs.size(), 3U);
  EXPECT_LT((uvs[1] - Eigen::Vector2f(0.45F, 0.1F)).norm(), 1e-6F);
  gltf_["buffers"][0]["uri"] = "data:application/octet-stream;base64," + to_base64(buffer_);
  io::write_text(directory_ / "text.gltf", gltf_.dump());
  const auto text = read_mesh(directory_ / "text.gltf");
  ASSERT_TRUE(text.ok()) << text.error().message;
  EXPECT_EQ(text->mesh.uvs, uvs);
  EXPECT_TRUE(text->mesh.has_texture());
}

TEST_F(GltfMaterial, TheBufferMayBeAPartOfABinaryFile) {
  const auto uvs = read_scaled_uvs();
  gltf_["buffers"][0].erase("uri");
  const auto number = [](std::size_t n) { return std::string(reinterpret_cast<const char*>(&n), 4); };
  const std::string text = gltf_.dump();
  io::write_text(directory_ / "m.glb", "glTF" + number(2) + number(28 + text.size() + buffer_.size()) +
                                           number(text.size()) + "JSON" + text + number(buffer_.size()) +
                                           std::string("BIN\0", 4) + buffer_);
  const auto glb = read_mesh(directory_ / "m.glb");
  ASSERT_TRUE(glb.ok()) << glb.error().message;
  EXPECT_EQ(glb->mesh.uvs, uvs);
  EXPECT_TRUE(glb->mesh.has_texture());
}

TEST_F(GltfMaterial, ExtensionsThatChangeMoreThanShadingAreRefused) {
  add_texture();
  for (const char* name : {"KHR_materials_unlit", "KHR_materials_clearcoat", "KHR_lights_punctual"}) {
    gltf_["extensionsRequired"] = {name};
    EXPECT_THAT(read_corners(), kTextured) << name;
  }
  for (const char* name : {"EXT_texture_webp", "KHR_texture_basisu", "KHR_mesh_quantization", "ACME_anything"}) {
    gltf_["extensionsRequired"] = {"KHR_materials_unlit", name};
    const auto mesh = read();
    ASSERT_FALSE(mesh.ok()) << name;
    EXPECT_THAT(mesh.error().message, HasSubstr(name));
  }
}

TEST_F(GltfMaterial, ATextureThatCannotBeReadIsMissing) {
  add_texture();
  const auto is_missing = [&](const char* why) {
    const auto mesh = read();
    ASSERT_TRUE(mesh.ok()) << mesh.error().message;
    EXPECT_TRUE(mesh->mesh.colors.empty()) << "the factor of the texture is not the colour of the object";
    EXPECT_FALSE(mesh->mesh.has_texture());
    EXPECT_THAT(mesh->warnings, testing::ElementsAre(HasSubstr(why)));
  };
  const json complete = gltf_;
  gltf_["textures"][0] = {{"extensions", {{"EXT_texture_webp", {{"source", 0}}}}}};
  is_missing("names no image");
  gltf_["textures"][0] = {{"source", 7}};
  is_missing("names no image");
  gltf_ = complete;
  gltf_["images"][0] = {{"name", "t"}};
  is_missing("names no image");
  gltf_ = complete;
  surface()["baseColorTexture"]["index"] = 1;
  is_missing("names no image");
  gltf_ = complete;
  surface()["baseColorTexture"]["texCoord"] = 1;
  is_missing("without texture coordinates");
  gltf_ = complete;
  gltf_["textures"][0]["extensions"]["EXT_texture_webp"]["source"] = 7;
  EXPECT_THAT(read_corners(), kTextured) << "the other image is for those who do not read WebP";
}

TEST_F(GltfMaterial, SpecularMaterialsHaveADiffuseColour) {
  add_texture();
  gltf_["materials"][0]["extensions"]["KHR_materials_pbrSpecularGlossiness"] = {
      {"diffuseTexture", surface()["baseColorTexture"]}, {"diffuseFactor", {1, 0, 1, 1}}};
  gltf_["materials"][0].erase("pbrMetallicRoughness");
  EXPECT_THAT(read_corners(), testing::ElementsAre(Rgb8{255, 0, 255}, Rgb8{255, 0, 0}, Rgb8{0, 0, 255}));
}

TEST_F(GltfMaterial, WithoutAMaterialTheColourIsUnknown) {
  EXPECT_THAT(read()->mesh.colors, Each(kWhite)) << "the default of glTF";
  primitive().erase("material");
  const auto mesh = read();
  ASSERT_TRUE(mesh.ok()) << mesh.error().message;
  EXPECT_TRUE(mesh->mesh.colors.empty());
}

}  // namespace
}  // namespace resight
