// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <limits>

#include "reader.hpp"
#include "resight/io/mesh.hpp"
#include "resight/io/organized_pcd.hpp"
#include "resight/io/pcd.hpp"
#include "resight/io/ply.hpp"

namespace resight::fuzz {
namespace {

namespace fs = std::filesystem;

/// All sizes are right, so that more of a reader runs.
constexpr ReadMeshOptions kAnySize{
    .metres_per_unit = 1.0, .min_size_m = 0, .max_size_m = std::numeric_limits<double>::infinity()};

TriangleMesh make_tetrahedron() {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {0.1F, 0, 0}, {0, 0.1F, 0}, {0, 0, 0.1F}};
  mesh.faces = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  mesh.colors = {{255, 0, 0}, {0, 255, 0}, {0, 0, 255}, {9, 9, 9}};
  return mesh;
}

std::vector<std::string> make_ply_seeds() {
  const auto mesh =
      bytes_written_by("seed.ply", [](const fs::path& file) { (void)write_ply(file, make_tetrahedron()); });
  return {mesh,
          "ply\nformat ascii 1.0\ncomment TextureFile t.png\nelement vertex 3\nproperty float x\nproperty float y\n"
          "property float z\nproperty double nx\nproperty float ny\nproperty float nz\nproperty uchar red\n"
          "property uchar green\nproperty uchar blue\nproperty float s\nproperty float t\nelement face 1\n"
          "property list uchar int vertex_indices\nproperty list uchar float texcoord\nproperty int texnumber\n"
          "end_header\n"
          "0 0 0 0 0 1 1 2 3 0 1\n1 0 0 0 0 1 1 2 3 0 1\n0 1 0 0 0 1 4 5 6 1 1\n3 0 1 2 6 0 0 1 0 0 1 0\n",
          std::string("ply\nformat binary_big_endian 1.0\nelement vertex 1\nproperty short x\nproperty char y\n"
                      "property double z\nelement other 2\nproperty list ushort uint a\nend_header\n"
                      "\0\1\2\0\0\0\0\0\0\0\0\0\0\0\1\0\0\0\1",
                      134)};
}

PcdCloud make_cloud(int width, int height) {
  PcdCloud cloud;
  cloud.width = width;
  cloud.height = height;
  for (int v = 0; v < height; ++v)
    for (int u = 0; u < width; ++u) {
      cloud.points.emplace_back((static_cast<float>(u) - 2.5F) / 50, (static_cast<float>(v) - 1.5F) / 50, 1.0F);
      cloud.normals.emplace_back(0.0F, 0.0F, -1.0F);
      cloud.colors.push_back({static_cast<std::uint8_t>(u), 2, 3});
    }
  return cloud;
}

std::vector<std::string> make_pcd_seeds() {
  std::vector<std::string> seeds;
  for (const auto encoding : {PcdEncoding::kAscii, PcdEncoding::kBinary, PcdEncoding::kBinaryCompressed})
    for (const int height : {1, 4})
      seeds.push_back(bytes_written_by(
          "seed.pcd", [&](const fs::path& file) { (void)write_pcd(file, make_cloud(5, height), encoding); }));
  seeds.push_back(bytes_written_by("seed.pcd", [](const fs::path& file) {
    (void)write_pcd(file, make_cloud(12, 10), PcdEncoding::kBinary);  // enough points for a camera
  }));
  return seeds;
}

void read_pcd_bytes(std::string_view bytes) {
  const auto cloud = parse_pcd(bytes, "fuzz.pcd");
  if (!cloud) return;
  (void)to_point_cloud(*cloud);
  if (cloud->is_organized()) (void)to_frame(*cloud, "fuzz");
}

constexpr std::array kObjFiles = {"mesh.obj", "m.mtl"};

std::vector<std::string> make_obj_seeds() {
  const std::array<std::string, 2> textured = {
      "# cube\nmtllib m.mtl\no a\nv 0 0 0\nv .1 0 0 1 0 0\nv 0 0.1 0\nv 0 0 1e-1\nvt 0 0\nvt 1 0 0\nvn 0 0 1\n"
      "usemtl red\ns 1\nf 1/1/1 2/2/1 3/1/1\ng b\nusemtl blue\nf -1 -2 -3\nf 1//1 2//1 4//1 3//1\nl 1 2\np 1\n",
      "newmtl red\nKd 1 0 0\nmap_Kd t.png\nbump b.png\nnewmtl blue\nKd 0 0 1\nd 0.5\nmap_Kd -s 1 1 1 t.png\n"};
  return {join_files(textured), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n",
          "mtllib a://\nmtllib \\\\\nv 0 0 0\nmtllib b\\m.mtl",
          "v 0 0 0\r\nv 2 0 0\r\nv 2 1 0\r\nv 1 .1 0\r\nv 0 2 \\\r\n0\r\nt a 9/9/9\r\nf 1/ 2/ 3/ 4/ 5/ # concave"};
}

constexpr std::string_view kGltf =
    R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],)"
    R"("nodes":[{"mesh":0,"children":[1],"matrix":[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1]},{"translation":[0,0,1],"rotation":[0,0,0,1]}],)"
    R"("meshes":[{"primitives":[{"attributes":{"POSITION":1,"TEXCOORD_0":2},"indices":0,"material":0,"mode":4}]}],)"
    R"("materials":[{"pbrMetallicRoughness":{"baseColorFactor":[1,0,0,1],"baseColorTexture":{"index":0,"texCoord":0,"extensions":{"KHR_texture_transform":{"offset":[0.5,0],"rotation":1,"scale":[2,-1],"texCoord":0}}}}}],)"
    R"("textures":[{"source":0}],"images":[{"uri":"t.png"}],)"
    R"("accessors":[{"bufferView":0,"componentType":5123,"count":3,"type":"SCALAR"},)"
    R"({"bufferView":1,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]},)"
    R"({"bufferView":1,"componentType":5126,"count":3,"type":"VEC2"}],)"
    R"("bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":6},{"buffer":0,"byteOffset":8,"byteLength":36}],)";

constexpr std::string_view kGltfMissingBuffer = R"("buffers":[{"byteLength":44,"uri":"a://"}]})";
constexpr std::string_view kGltfBuffer = R"("buffers":[{"byteLength":44,"uri":"data:application/octet-stream;base64,)"
                                         R"(AAABAAIAAAAAAAAAAAAAAAAAAAAAAIA/AAAAAAAAAAAAAAAAAACAPwAAAAA="}]})";

std::vector<std::string> make_gltf_seeds() {
  return {std::string(kGltf).append(kGltfBuffer), std::string(kGltf).append(kGltfMissingBuffer)};
}

std::string make_glb() {
  const auto number = [](std::size_t value) {
    const auto n = static_cast<std::uint32_t>(value);
    return std::string(reinterpret_cast<const char*>(&n), sizeof(n));
  };
  std::string json = std::string(kGltf) + R"("buffers":[{"byteLength":44}]})";
  json.resize((json.size() + 3) / 4 * 4, ' ');
  std::string triangle(44, '\0');
  const std::array<std::uint16_t, 3> indices = {0, 1, 2};
  const std::array<float, 9> points = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  triangle.replace(0, 6, reinterpret_cast<const char*>(indices.data()), 6);
  triangle.replace(8, 36, reinterpret_cast<const char*>(points.data()), 36);
  return "glTF" + number(2) + number(12 + 8 + json.size() + 8 + triangle.size()) + number(json.size()) + "JSON" + json +
         number(triangle.size()) + std::string("BIN\0", 4) + triangle;
}

std::vector<std::string> make_stl_seeds() {
  std::string binary(80, ' ');
  binary += std::string("\1\0\0\0", 4);
  const std::array<float, 12> facet = {0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0};
  binary += std::string(reinterpret_cast<const char*>(facet.data()), sizeof(facet)) + std::string(2, '\0');
  return {
      "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n"
      "endsolid a\n",
      binary};
}

std::function<void(std::string_view)> mesh_file_reader(const char* name) {
  return [name](std::string_view bytes) { (void)read_mesh(write_scratch(name, bytes), kAnySize); };
}

}  // namespace

std::vector<FuzzReader> mesh_readers() {
  return {
      {"ply", make_ply_seeds, [](std::string_view bytes) { (void)parse_ply(bytes, "fuzz.ply"); }},
      {"pcd", make_pcd_seeds, read_pcd_bytes},
      {"obj", make_obj_seeds,
       [](std::string_view bytes) { (void)read_mesh(write_bundle(bytes, kObjFiles) / kObjFiles[0], kAnySize); }, 5000},
      {"gltf", make_gltf_seeds, mesh_file_reader("mesh.gltf"), 300, true},
      {"glb", [] { return std::vector{make_glb()}; }, mesh_file_reader("mesh.glb"), 1000, true},
      {"stl", make_stl_seeds, mesh_file_reader("mesh.stl"), 1000, true},
  };
}

}  // namespace resight::fuzz
