// SPDX-License-Identifier: Apache-2.0
#include "resight/io/internal/gltf_file.hpp"

#include <gmock/gmock.h>

#include <functional>
#include <nlohmann/json.hpp>
#include <string>

#include "resight/io/internal/test_data.hpp"
#include "resight/io/mesh.hpp"

namespace resight {
namespace {

using nlohmann::json;
using testing::HasSubstr;

/// A triangle with its indices.
json triangle_gltf() {
  return json::parse(R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
    "meshes":[{"primitives":[{"attributes":{"POSITION":1},"indices":0}]}],
    "accessors":[{"bufferView":0,"componentType":5123,"count":3,"type":"SCALAR"},
                 {"bufferView":1,"componentType":5126,"count":3,"type":"VEC3"}],
    "bufferViews":[{"buffer":0,"byteLength":6},{"buffer":0,"byteOffset":8,"byteLength":36}],
    "buffers":[{"byteLength":44,"uri":"data:application/octet-stream;base64,)"
                     R"(AAABAAIAAAAAAAAAAAAAAAAAAADNzMw9AAAAAAAAAAAAAAAAzczMPQAAAAA="}]})");
}

std::shared_ptr<const std::string> find_nothing(const std::string& /*name*/) {
  return std::make_shared<const std::string>();
}
Result<io::NormalizedGltf> normalize(const std::string& text) { return io::normalize_gltf(text, &find_nothing); }

json& primitive_of(json& gltf) { return gltf["meshes"][0]["primitives"][0]; }

/// Nodes in a row, each below the one before it.
void nest_nodes(json& gltf, int count) {
  gltf["nodes"] = json::array();
  for (int i = 1; i < count; ++i) gltf["nodes"].push_back({{"children", {i}}});
  gltf["nodes"].push_back({{"mesh", 0}});
}

std::string glb_chunk(const char* type, const std::string& bytes) {
  const auto size = static_cast<std::uint32_t>(bytes.size());
  return std::string(reinterpret_cast<const char*>(&size), 4) + std::string(type, 4) + bytes;
}

TEST(GltfFile, TrianglesAreRead) {
  io::TestDirectory directory;
  json gltf = triangle_gltf();
  io::write_text(directory / "m.gltf", gltf.dump());
  const auto read = read_mesh(directory / "m.gltf");
  ASSERT_TRUE(read.ok()) << read.error().message;
  EXPECT_EQ(read->mesh.faces.size(), 1U);
  nest_nodes(gltf, 200);
  io::write_text(directory / "nested.gltf", gltf.dump());
  EXPECT_TRUE(read_mesh(directory / "nested.gltf").ok());
}

/// Each of these crashed Assimp, made it run or allocate without end, or made it read beyond its buffers.
TEST(GltfFile, WhatAssimpWouldFollowOutOfTheFileIsRefused) {
  struct Mistake {
    std::function<void(json&)> make;
    const char* message;
  };
  const Mistake mistakes[] = {
      {[](json& g) { nest_nodes(g, 100000); }, "nested more than 256 deep"},
      {[](json& g) { g["nodes"][0]["children"] = {0}; }, "nested more than 256 deep"},
      {[](json& g) {
         g["nodes"] = {{{"children", {1, 1}}}, {{"mesh", 0}}};
       },
       "listed twice"},
      {[](json& g) {
         g["nodes"] = {{{"children", {1, 2}}}, {{"children", {2}}}, {{"mesh", 0}}};
       },
       "two parents"},
      {[](json& g) {
         g["nodes"] = {{{"children", {1}}}, {{"mesh", 0}}};
         g["scenes"][0]["nodes"] = {0, 1};
       },
       "a node of a scene has a parent"},
      {[](json& g) {
         g["accessors"][1]["sparse"] = {{"count", 100000000}};
       },
       "sparse"},
      {[](json& g) { g["accessors"][1]["count"] = 4; }, "beyond its part of the buffer"},
      {[](json& g) { g["accessors"][0]["count"] = -1; }, "'count'"},
      {[](json& g) { g["accessors"][1].erase("bufferView"); }, "has no data"},
      {[](json& g) { g["bufferViews"][1]["byteStride"] = 4000000000; }, "stride"},
      {[](json& g) {
         g["bufferViews"][1]["byteStride"] = 1000000000000;
         g["accessors"][1]["count"] = 1000000000000;
       },
       "stride"},
      {[](json& g) { g["bufferViews"][1]["byteLength"] = 37; }, "beyond the buffer"},
      {[](json& g) { g["buffers"] = json::array(); }, "lies in no buffer"},
      {[](json& g) { g["asset"]["version"] = "1.0"; }, "is not glTF 2.0"},
      {[](json& g) { g["extensionsRequired"] = {"KHR_draco_mesh_compression"}; }, "compressed"},
      {[](json& g) { primitive_of(g)["attributes"]["POSITION"] = 7; }, "no positions"},
      {[](json& g) { primitive_of(g)["indices"] = 1; }, "indices are no whole numbers"},
      {[](json& g) {
         for (const char* list : {"buffers", "bufferViews"}) g[list][0]["byteLength"] = 1000000000;
         g["accessors"][0]["count"] = 30000000;
       },
       "more than 16777216 vertices"},
  };
  for (const Mistake& mistake : mistakes) {
    json gltf = triangle_gltf();
    mistake.make(gltf);
    const auto result = normalize(gltf.dump());
    ASSERT_FALSE(result.ok()) << mistake.message;
    EXPECT_THAT(result.error().message, HasSubstr(mistake.message));
  }
  EXPECT_THAT(normalize(std::string(300000, '[')).error().message, HasSubstr("nested more than 64 deep"));
}

TEST(GltfFile, WhatIsNotUsedDoesNotReachAssimp) {
  json gltf = triangle_gltf();
  gltf["skins"] = {{{"joints", std::vector<int>(1000, 0)}, {"inverseBindMatrices", 1}}};
  gltf["nodes"][0]["skin"] = 0;
  gltf["animations"] = {1};
  primitive_of(gltf)["targets"] = {{{"POSITION", 0}}};
  primitive_of(gltf)["attributes"]["JOINTS_0"] = 0;
  primitive_of(gltf)["attributes"]["NORMAL"] = 0;
  // A fan of one point has "-1" triangles.
  gltf["meshes"][0]["primitives"].push_back({{"attributes", {{"POSITION", 2}}}, {"mode", 6}});
  gltf["accessors"].push_back({{"bufferView", 1}, {"componentType", 5126}, {"count", 1}, {"type", "VEC3"}});
  const auto text = normalize(gltf.dump());
  ASSERT_TRUE(text.ok()) << text.error().message;
  json used = json::parse(text->bytes);
  EXPECT_FALSE(used.contains("skins"));
  EXPECT_FALSE(used.contains("animations"));
  EXPECT_EQ(used["meshes"][0]["primitives"].size(), 1U);
  EXPECT_EQ(primitive_of(used)["attributes"], (json{{"POSITION", 1}}));
  EXPECT_FALSE(primitive_of(used).contains("targets"));
}

TEST(GltfFile, ChunksOfABinaryFileLieWithinIt) {
  io::TestDirectory directory;
  const std::string header("glTF\2\0\0\0\x1c\0\0\0", 12);
  json gltf = triangle_gltf();
  gltf["buffers"] = {{{"byteLength", 44}}};
  std::string buffer(44, '\0');
  const std::uint16_t indices[] = {0, 1, 2};
  const float points[] = {0, 0, 0, .1F, 0, 0, 0, .1F, 0};
  buffer.replace(0, 6, reinterpret_cast<const char*>(indices), 6);
  buffer.replace(8, 36, reinterpret_cast<const char*>(points), 36);
  const std::string text = glb_chunk("JSON", gltf.dump());
  io::write_text(directory / "t.glb", header + text + glb_chunk("BIN\0", buffer));
  const auto read = read_mesh(directory / "t.glb");
  ASSERT_TRUE(read.ok()) << read.error().message;
  EXPECT_EQ(read->mesh.faces.size(), 1U);

  const auto message_of = [](const std::string& bytes) {
    return io::normalize_glb(bytes, &find_nothing).error().message;
  };
  EXPECT_THAT(message_of(header), HasSubstr("no header"));
  std::string old = header + text;
  old[4] = 1;
  EXPECT_THAT(message_of(old), HasSubstr("version 1; only version 2 is read"));
  EXPECT_THAT(message_of(header + text + glb_chunk("BIN\0", buffer.substr(0, 40))), HasSubstr("beyond the buffer"));
  EXPECT_THAT(message_of(header + "\xf0\xff\xff\xffJSON{}"), HasSubstr("a chunk is longer than the file"));
}

TEST(GltfFile, OtherFormatsAreNotReadUnderThisName) {
  io::TestDirectory directory;
  const std::string off = "OFF\n3 1 0\n0 0 0\n0.1 0 0\n0 0.1 0\n3 0 1 2\n";
  for (const char* name : {"m.gltf", "m.glb", "m.obj", "m.stl"}) {
    io::write_text(directory / name, off);
    EXPECT_FALSE(read_mesh(directory / name).ok()) << name;
  }
  // Assimp finds no token of OBJ in the first bytes.
  io::write_text(directory / "comment.obj", "#" + std::string(500, '-') + "\nv 0 0 0\nv .1 0 0\nv 0 .1 0\nf 1 2 3\n");
  EXPECT_TRUE(read_mesh(directory / "comment.obj").ok());
}

}  // namespace
}  // namespace resight
