// SPDX-License-Identifier: Apache-2.0
#include "resight/io/mesh.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <Eigen/LU>
#include <limits>
#include <optional>

#include "resight/geometry/mesh_sampling.hpp"
#include "resight/io/images.hpp"
#include "resight/io/internal/mesh_parts.hpp"
#include "resight/io/internal/test_data.hpp"

namespace resight {
namespace {

using testing::HasSubstr;

/// A square in the plane z = 0 with a texture: the left half is red, the right half blue, the top row green.
void write_square_obj(const io::TestDirectory& directory, double scale) {
  const std::string s = std::to_string(scale);
  io::write_text(directory / "square.obj", "mtllib square.mtl\nv 0 0 0\nv " + s + " 0 0\nv " + s + " " + s +
                                               " 0\nv 0 " + s +
                                               " 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nusemtl m\nf 1/1 2/2 3/3 4/4\n");
  io::write_text(directory / "square.mtl", "newmtl m\nKd 1 1 1\nmap_Kd square.png \n");
  Image<Rgb8> texture(8, 8, Rgb8{255, 0, 0});
  for (int v = 0; v < 8; ++v)
    for (int u = 4; u < 8; ++u) texture(u, v) = {0, 0, 255};
  for (int u = 0; u < 8; ++u) texture(u, 0) = {0, 255, 0};
  ASSERT_TRUE(write_color(directory / "square.png", texture).ok());
}

TEST(Mesh, ObjTextureStandsUpright) {
  io::TestDirectory directory;
  write_square_obj(directory, 0.2);
  const auto read = read_mesh(directory / "square.obj");
  ASSERT_TRUE(read.ok()) << read.error().message;
  ASSERT_TRUE(read->mesh.has_texture());
  ASSERT_EQ(read->mesh.faces.size(), 2U);
  int num_green = 0;
  for (std::size_t i = 0; i < read->mesh.vertices.size(); ++i) {
    const bool at_top = read->mesh.vertices[i].y() > 0.1F;  // y up = v up = first row of the image
    EXPECT_EQ(read->mesh.uvs[i].y() < 0.5F, at_top);
    num_green += at_top ? 1 : 0;
    EXPECT_NEAR(read->mesh.normals[i].z(), 1, 1e-6);
  }
  EXPECT_EQ(num_green, 2);
}

/// A triangle of each material m0, m1, .. with its texture.
void write_textured_triangles(const io::TestDirectory& directory, const std::vector<std::string>& textures) {
  std::string obj = "mtllib many.mtl\nvt 0 0\nvt 1 0\nvt 1 1\n";
  std::string mtl;
  for (std::size_t i = 0; i < textures.size(); ++i) {
    const std::string material = "m" + std::to_string(i);
    const std::string z = " " + std::to_string(0.01 * static_cast<double>(i)) + "\n";
    mtl += "newmtl " + material + "\nmap_Kd " + textures[i] + "\n";
    obj += "v 0 0" + z + "v 0.1 0" + z + "v 0.1 0.1" + z + "usemtl " + material + "\nf -3/1 -2/2 -1/3\n";
  }
  io::write_text(directory / "many.obj", obj);
  io::write_text(directory / "many.mtl", mtl);
}

// The header of the second texture declares all pixels that a mesh may have. Nothing behind it is right.
TEST(Mesh, ATextureBeyondTheLimitIsNotDecoded) {
  io::TestDirectory directory;
  ASSERT_TRUE(write_color(directory / "a.jpg", Image<Rgb8>(8, 8, Rgb8{255, 0, 0})).ok());
  std::string large = io::read_text(directory / "a.jpg");
  const std::size_t size = large.find("\xff\xc0") + 5;
  large.replace(size, 4, std::string("\x20\x00\x40\x00", 4));  // 8192 rows of 16384 px
  io::write_text(directory / "b.jpg", large);
  write_textured_triangles(directory, {"a.jpg", "b.jpg"});
  const io::MemoryGrowth growth;
  const auto read = read_mesh(directory / "many.obj");
  ASSERT_TRUE(read.ok()) << read.error().message;
  ASSERT_EQ(read->warnings.size(), 1U);
  EXPECT_THAT(read->warnings[0], HasSubstr("b.jpg: the image size 16384x8192 is out of range"));
  EXPECT_LT(growth.bytes(), 100'000'000U);
}

TEST(Mesh, PartsShareTheirTexture) {
  io::TestDirectory directory;
  ASSERT_TRUE(write_color(directory / "t.png", Image<Rgb8>(4096, 4096, Rgb8{255, 0, 0})).ok());
  write_textured_triangles(directory, std::vector<std::string>(20, "t.png"));
  const io::MemoryGrowth growth;
  const auto read = read_mesh(directory / "many.obj");
  ASSERT_TRUE(read.ok()) << read.error().message;
  EXPECT_EQ(read->mesh.texture.width(), 4096);
  EXPECT_EQ(read->mesh.faces.size(), 20U);
  EXPECT_LT(growth.bytes(), 60'000'000U);
}

TEST(Mesh, MissingTextureIsAWarning) {
  io::TestDirectory directory;
  write_square_obj(directory, 0.2);
  std::filesystem::remove(directory / "square.png");
  const auto read = read_mesh(directory / "square.obj");
  ASSERT_TRUE(read.ok()) << read.error().message;
  EXPECT_FALSE(read->mesh.has_texture());
  EXPECT_TRUE(read->mesh.colors.empty()) << "the uniform colour of the material must not become that of the object";
  ASSERT_EQ(read->warnings.size(), 1U);
  EXPECT_THAT(read->warnings[0], HasSubstr("square.png"));
}

TEST(Mesh, WrongUnitsAreRefused) {
  io::TestDirectory directory;
  write_square_obj(directory, 200);
  EXPECT_THAT(read_mesh(directory / "square.obj").error().message, HasSubstr("looks like millimetres"));
  EXPECT_TRUE(read_mesh(directory / "square.obj", {.metres_per_unit = 0.001}).ok());
  write_square_obj(directory, 0.2);
  EXPECT_THAT(read_mesh(directory / "square.obj", {.metres_per_unit = 0.001}).error().message,
              HasSubstr("looks like metres"));
  write_square_obj(directory, 0.001);
  EXPECT_THAT(read_mesh(directory / "square.obj").error().message, HasSubstr("check its unit"));
  EXPECT_TRUE(read_mesh(directory / "square.obj", {.min_size_m = 0}).ok());
  EXPECT_THROW((void)read_mesh(directory / "square.obj", {.metres_per_unit = -1}), std::invalid_argument);
}

TEST(Mesh, ObjectsFarFromTheirOriginAreRefused) {
  io::TestDirectory directory;
  io::write_text(directory / "far.obj", "v 1e6 0 0\nv 1000001 0 0\nv 1e6 1 0\nf 1 2 3\n");
  EXPECT_THAT(read_mesh(directory / "far.obj").error().message, HasSubstr("m away from its origin (at most 100 m)"));
  io::write_text(directory / "near.obj", "v 99 0 0\nv 100 0 0\nv 99 1 0\nf 1 2 3\n");
  EXPECT_TRUE(read_mesh(directory / "near.obj").ok());
}

/// `count` times the same triangle, with two sides of `leg_m`.
void write_stacked_ply(const std::filesystem::path& file, const std::string& leg_m, int count) {
  std::string text = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n";
  text += "element face " + std::to_string(count) + "\nproperty list uchar int vertex_indices\nend_header\n";
  text += "0 0 0\n" + leg_m + " 0 0\n0 " + leg_m + " 0\n";
  for (int i = 0; i < count; ++i) text += "3 0 1 2\n";
  io::write_text(file, text);
}

TEST(Mesh, MoreAreaThanAnObjectCanHaveIsRefused) {
  io::TestDirectory directory;
  // 0.005 m2 each; 100 times 0.02 m2 are allowed.
  write_stacked_ply(directory / "small.ply", "0.1", 350);
  EXPECT_TRUE(read_mesh(directory / "small.ply").ok());
  write_stacked_ply(directory / "small.ply", "0.1", 1000);
  EXPECT_THAT(read_mesh(directory / "small.ply").error().message,
              HasSubstr("its faces have an area of 5 m2, too much for an object that is 0.141 m large (at most 2 m2)"));
  // 4.5 m2 each; 250 m2 are allowed whatever the size.
  write_stacked_ply(directory / "large.ply", "3", 55);
  EXPECT_TRUE(read_mesh(directory / "large.ply").ok());
  write_stacked_ply(directory / "large.ply", "3", 1000);
  EXPECT_THAT(read_mesh(directory / "large.ply").error().message, HasSubstr("an area of 4500 m2"));
  const double any_size = std::numeric_limits<double>::infinity();
  EXPECT_THAT(read_mesh(directory / "large.ply", {.max_size_m = any_size}).error().message,
              HasSubstr("at most 1800 m2"));
}

TEST(Mesh, SameFileSameBytes) {
  io::TestDirectory directory;
  write_square_obj(directory, 0.2);
  const auto a = read_mesh(directory / "square.obj");
  const auto b = read_mesh(directory / "square.obj");
  EXPECT_EQ(a->mesh.vertices, b->mesh.vertices);
  EXPECT_EQ(a->mesh.faces, b->mesh.faces);
  EXPECT_EQ(a->mesh.uvs, b->mesh.uvs);
}

// As programs for construction export boxes: the faces share their corners.
TEST(Mesh, FacesOfABoxWithSharedCornersAreFlat) {
  io::TestDirectory directory;
  std::string obj;
  for (int i = 0; i < 8; ++i) obj += fmt::format("v {} {} {}\n", (i & 1) * 0.2, (i & 2) * 0.05, (i & 4) * 0.02);
  obj += "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
  io::write_text(directory / "box.obj", obj);
  const auto read = read_mesh(directory / "box.obj");
  ASSERT_TRUE(read.ok()) << read.error().message;
  const PointCloud cloud = sample_surface(read->mesh, 1e5);
  ASSERT_GT(cloud.size(), 5000U);
  for (const Eigen::Vector3f& n : cloud.normals) ASSERT_NEAR(n.lpNorm<Eigen::Infinity>(), 1, 1e-5);
}

TEST(Mesh, StlWithoutColours) {
  io::TestDirectory directory;
  io::write_text(directory / "t.stl",
                 "solid t\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex .1 0 0\nvertex 0 .1 "
                 "0\nendloop\nendfacet\nendsolid t\n");
  const auto read = read_mesh(directory / "t.stl");
  ASSERT_TRUE(read.ok()) << read.error().message;
  EXPECT_EQ(read->mesh.faces.size(), 1U);
  EXPECT_TRUE(read->mesh.colors.empty());
}

TEST(Mesh, GltfNodesTexturesAndColours) {
  // Two triangles below a node that moves them by 0.5 along x. In glTF, uv (0, 0) is at the top left.
  io::TestDirectory directory;
  std::string buffer;
  const auto add = [&](float x) { buffer.append(reinterpret_cast<const char*>(&x), 4); };
  for (const float x : {0.F, 0.F, 0.F, .1F, 0.F, 0.F, 0.F, .1F, 0.F}) add(x);
  for (const float x : {0.F, 0.F, 1.F, 0.F, 0.F, 1.F}) add(x);
  io::write_text(directory / "b.bin", buffer);
  Image<Rgb8> texture(4, 4, Rgb8{10, 20, 30});
  texture(0, 0) = {200, 0, 0};
  ASSERT_TRUE(write_color(directory / "t.png", texture).ok());
  io::write_text(directory / "m.gltf", R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],
    "nodes":[{"mesh":0,"translation":[0.5,0,0]}],
    "meshes":[{"primitives":[{"attributes":{"POSITION":0,"TEXCOORD_0":1},"material":0}]}],
    "materials":[{"pbrMetallicRoughness":{"baseColorTexture":{"index":0}}}],"textures":[{"source":0}],"images":[{"uri":"t.png"}],
    "buffers":[{"uri":"b.bin","byteLength":60}],
    "bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":24}],
    "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[0.1,0.1,0]},
                 {"bufferView":1,"componentType":5126,"count":3,"type":"VEC2"}]})");
  const auto read = read_mesh(directory / "m.gltf");
  ASSERT_TRUE(read.ok()) << read.error().message;
  ASSERT_TRUE(read->mesh.has_texture()) << (read->warnings.empty() ? "" : read->warnings[0]);
  ASSERT_EQ(read->mesh.vertices.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_GE(read->mesh.vertices[i].x(), 0.5F);
    const bool is_origin = read->mesh.vertices[i].head<2>().isApprox(Eigen::Vector2f(0.5F, 0));
    EXPECT_EQ(read->mesh.uvs[i].norm() < 1e-6F, is_origin);
  }
}

// The square of write_square_obj(); v of the texture points up in PLY, as in OBJ.
void write_square_ply(const io::TestDirectory& directory) {
  io::write_text(directory / "square.ply",
                 "ply\nformat ascii 1.0\ncomment TextureFile square.png\nelement vertex 4\nproperty float x\n"
                 "property float y\nproperty float z\nproperty float texture_u\nproperty float texture_v\n"
                 "element face 2\nproperty list uchar int vertex_indices\nend_header\n"
                 "0 0 0 0 0\n.2 0 0 1 0\n.2 .2 0 1 1\n0 .2 0 0 1\n3 0 1 2\n3 0 2 3\n");
}

// In glTF, it points down.
void write_square_gltf(const io::TestDirectory& directory) {
  std::string buffer;
  const auto add = [&](float x) { buffer.append(reinterpret_cast<const char*>(&x), 4); };
  for (const float x : {0.F, 0.F, 0.F, .2F, 0.F, 0.F, .2F, .2F, 0.F, 0.F, 0.F, 0.F, .2F, .2F, 0.F, 0.F, .2F, 0.F})
    add(x);
  for (const float x : {0.F, 1.F, 1.F, 1.F, 1.F, 0.F, 0.F, 1.F, 1.F, 0.F, 0.F, 0.F}) add(x);
  io::write_text(directory / "square.bin", buffer);
  io::write_text(directory / "square.gltf", R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],
    "nodes":[{"mesh":0}],"meshes":[{"primitives":[{"attributes":{"POSITION":0,"TEXCOORD_0":1},"material":0}]}],
    "materials":[{"pbrMetallicRoughness":{"baseColorTexture":{"index":0}}}],"textures":[{"source":0}],
    "images":[{"uri":"square.png"}],"buffers":[{"uri":"square.bin","byteLength":120}],
    "bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":72},{"buffer":0,"byteOffset":72,"byteLength":48}],
    "accessors":[{"bufferView":0,"componentType":5126,"count":6,"type":"VEC3","min":[0,0,0],"max":[0.2,0.2,0]},
                 {"bufferView":1,"componentType":5126,"count":6,"type":"VEC2"}]})");
}

// Colour of a mesh in the plane z = 0.
std::optional<Rgb8> color_at(const TriangleMesh& mesh, const Eigen::Vector2f& place) {
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    const Eigen::Vector2f c = mesh.vertices[mesh.faces[f][2]].head<2>();
    Eigen::Matrix2f edges;
    edges << mesh.vertices[mesh.faces[f][0]].head<2>() - c, mesh.vertices[mesh.faces[f][1]].head<2>() - c;
    const Eigen::Vector2f b = edges.inverse() * (place - c);
    if (b.minCoeff() >= 0 && b.sum() <= 1) return surface_color(mesh, static_cast<int>(f), b[0], b[1]);
  }
  return std::nullopt;
}

TEST(Mesh, ColoursAreTheSameInAllFormats) {
  io::TestDirectory directory;
  write_square_obj(directory, 0.2);
  write_square_ply(directory);
  write_square_gltf(directory);
  const auto obj = read_mesh(directory / "square.obj");
  ASSERT_TRUE(obj.ok()) << obj.error().message;
  for (const char* name : {"square.ply", "square.gltf"}) {
    const auto other = read_mesh(directory / name);
    ASSERT_TRUE(other.ok()) << other.error().message;
    for (float x = 0.013F; x < 0.2F; x += 0.025F)
      for (float y = 0.011F; y < 0.2F; y += 0.025F) {
        const std::optional<Rgb8> expected = color_at(obj->mesh, {x, y});
        ASSERT_TRUE(expected);
        const std::optional<Rgb8> color = color_at(other->mesh, {x, y});
        ASSERT_TRUE(color);
        EXPECT_NEAR(color->r, expected->r, 1) << name << " at " << x << ", " << y;
        EXPECT_NEAR(color->g, expected->g, 1) << name << " at " << x << ", " << y;
        EXPECT_NEAR(color->b, expected->b, 1) << name << " at " << x << ", " << y;
      }
  }
}

/// Where the texture of a square lies: u at its left and right, v at its bottom.
struct SquareUvs {
  float left;
  float right;
  float bottom;
};

/// Squares of 0.1 m in a row, with the texture of write_square_obj(), and one more with another texture.
Result<MeshFile> read_row(const io::TestDirectory& directory, const std::vector<SquareUvs>& squares) {
  write_square_obj(directory, 0.2);
  EXPECT_TRUE(write_color(directory / "other.png", Image<Rgb8>(16, 4, Rgb8{255, 255, 0})).ok());
  io::write_text(directory / "row.mtl", "newmtl m\nmap_Kd square.png\nnewmtl other\nmap_Kd other.png\n");
  std::string obj = "mtllib row.mtl\nusemtl m\n";
  float x = 0;
  const auto add = [&](const SquareUvs& at) {
    for (const Eigen::Vector2f& d :
         {Eigen::Vector2f(0, 0), Eigen::Vector2f(1, 0), Eigen::Vector2f(1, 1), Eigen::Vector2f(0, 1)})
      obj += fmt::format("v {} {} 0\nvt {} {}\n", x + 0.1F * d.x(), 0.1F * d.y(), d.x() > 0 ? at.right : at.left,
                         at.bottom + d.y());
    obj += "f -4/-4 -3/-3 -2/-2 -1/-1\n";
    x += 0.1F;
  };
  for (const SquareUvs& square : squares) add(square);
  obj += "usemtl other\n";
  add({0, 1, 0});
  io::write_text(directory / "row.obj", obj);
  return read_mesh(directory / "row.obj");
}

TEST(Mesh, RepeatedTexturesAreStackedWithOthers) {
  io::TestDirectory directory;
  const auto expected = read_row(directory, {{0, 1, 0}, {0, 1, 0}});
  ASSERT_TRUE(expected.ok()) << expected.error().message;
  ASSERT_TRUE(expected->mesh.has_texture());
  // The squares of the first row share two vertices that lie on both sides of the texture.
  const std::vector<std::vector<SquareUvs>> rows = {
      {{0, 1, 0}, {1, 2, 0}}, {{0, 1, 3}, {0, 1, -2}}, {{-5, -4, 0}, {7, 8, 1}}};
  for (const std::vector<SquareUvs>& row : rows) {
    const auto read = read_row(directory, row);
    ASSERT_TRUE(read.ok()) << read.error().message;
    EXPECT_TRUE(read->mesh.has_texture());
    EXPECT_TRUE(read->warnings.empty());
    int num_colors = 0;
    for (float x = 0.013F; x < 0.3F; x += 0.0125F)
      for (float y = 0.011F; y < 0.1F; y += 0.0125F, ++num_colors)
        ASSERT_EQ(color_at(read->mesh, {x, y}), color_at(expected->mesh, {x, y})) << x << ", " << y;
    EXPECT_EQ(num_colors, 184);
  }
}

TEST(Mesh, ATextureThatRepeatsWithinAFaceIsLostBesideOthers) {
  io::TestDirectory directory;
  const auto read = read_row(directory, {{0, 2, 0}});
  ASSERT_TRUE(read.ok()) << read.error().message;
  EXPECT_FALSE(read->mesh.has_texture());
  ASSERT_EQ(read->warnings.size(), 1U);
  EXPECT_THAT(read->warnings[0], HasSubstr("row.obj: its textures became vertex colours"));
}

TEST(Mesh, BadFiles) {
  io::TestDirectory directory;
  EXPECT_THAT(read_mesh(directory / "none.obj").error().message, HasSubstr("no such file"));
  EXPECT_THAT(read_mesh(directory / "none.doc").error().message, HasSubstr("expected ply, obj"));
  io::write_text(directory / "empty.obj", "");
  EXPECT_FALSE(read_mesh(directory / "empty.obj").ok());
  io::write_text(directory / "points.obj", "v 0 0 0\nv 1 0 0\nl 1 2\n");
  EXPECT_FALSE(read_mesh(directory / "points.obj").ok());
  io::write_text(directory / "noise.glb", "glTF\x02\x01\x03");
  EXPECT_FALSE(read_mesh(directory / "noise.glb").ok());
}

TriangleMesh triangle(const Eigen::Vector2f& shift) {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.uvs = {shift, shift + Eigen::Vector2f(1, 0), shift + Eigen::Vector2f(0, 1)};
  mesh.faces = {{0, 1, 2}};
  return mesh;
}

TEST(JoinParts, StackedTexturesKeepTheirColours) {
  std::vector<io::MeshPart> parts(3);
  parts[0].mesh = triangle({0, 0});
  parts[0].mesh.texture = Image<Rgb8>(16, 8, Rgb8{255, 0, 0});
  parts[1].mesh = triangle({0, 0});
  parts[1].mesh.texture = Image<Rgb8>(4, 32, Rgb8{0, 255, 0});
  parts[2].mesh = triangle({0, 0});
  parts[2].mesh.uvs.clear();
  parts[2].color = {0, 0, 255};
  const TriangleMesh mesh = io::join_parts(parts).mesh;
  ASSERT_EQ(mesh.faces.size(), 3U);
  ASSERT_TRUE(mesh.has_texture());
  for (const float b : {0.01F, 0.4F, 0.98F}) {
    EXPECT_EQ(surface_color(mesh, 0, b, (1 - b) / 2), (Rgb8{255, 0, 0}));
    EXPECT_EQ(surface_color(mesh, 1, b, (1 - b) / 2), (Rgb8{0, 255, 0}));
    EXPECT_EQ(surface_color(mesh, 2, b, (1 - b) / 2), (Rgb8{0, 0, 255}));
  }
}

TEST(JoinParts, RepeatingTexturesBecomeVertexColours) {
  std::vector<io::MeshPart> parts(2);
  parts[0].mesh = triangle({3, 0});
  parts[0].mesh.uvs[1].x() += 1;
  parts[0].mesh.texture = Image<Rgb8>(16, 8, Rgb8{255, 0, 0});
  parts[1].mesh = triangle({0, 0});
  parts[1].mesh.texture = Image<Rgb8>(4, 32, Rgb8{0, 255, 0});
  const TriangleMesh mesh = io::join_parts(parts).mesh;
  EXPECT_FALSE(mesh.has_texture());
  EXPECT_EQ(surface_color(mesh, 0, 0.3F, 0.3F), (Rgb8{255, 0, 0}));
  EXPECT_EQ(surface_color(mesh, 1, 0.3F, 0.3F), (Rgb8{0, 255, 0}));
}

}  // namespace
}  // namespace resight
