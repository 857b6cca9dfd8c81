// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <cmath>

#include "resight/io/images.hpp"
#include "resight/io/internal/mesh_parts.hpp"
#include "resight/io/internal/test_data.hpp"
#include "resight/io/mesh.hpp"

namespace resight {
namespace {

using io::write_text;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::UnorderedElementsAre;

constexpr const char* kCorners = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

class ObjFile : public testing::Test {
 protected:
  Result<io::ImportedParts> import(const std::string& obj, const std::string& mtl = "") {
    write_text(directory_ / "m.obj", obj);
    write_text(directory_ / "m.mtl", mtl);
    return io::import_mesh_parts(directory_ / "m.obj");
  }
  std::string error_of(const std::string& obj) {
    const auto imported = import(obj);
    return imported ? "" : imported.error().message;
  }
  /// Of a file that has one part.
  io::MeshPart only_part(const std::string& obj, const std::string& mtl = "") {
    auto imported = import(obj, mtl);
    EXPECT_TRUE(imported.ok() && imported->parts.size() == 1) << obj;
    return imported.ok() && imported->parts.size() == 1 ? std::move(imported->parts[0]) : io::MeshPart{};
  }

  io::TestDirectory directory_;
};

/// x, y, z, u, v of a corner as the file has them.
using TestCorner = std::array<float, 5>;

std::vector<std::array<TestCorner, 3>> triangles_of(const TriangleMesh& mesh) {
  std::vector<std::array<TestCorner, 3>> triangles;
  for (const auto& face : mesh.faces) {
    auto& triangle = triangles.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) {
      const auto& p = mesh.vertices[static_cast<std::size_t>(face[k])];
      const Eigen::Vector2f uv =
          mesh.uvs.empty() ? Eigen::Vector2f(-1, 2) : mesh.uvs[static_cast<std::size_t>(face[k])];
      triangle[k] = {p.x(), p.y(), p.z(), uv.x(), 1 - uv.y()};
    }
  }
  return triangles;
}

// Written by hand: a quad and a triangle by negative indices with a texture, of which one corner has no uv, and a quad
// of another material.
TEST_F(ObjFile, SaysWhatItSays) {
  ASSERT_TRUE(write_color(directory_ / "t.png", Image<Rgb8>(4, 4, Rgb8{1, 2, 3})).ok());
  const auto imported = import(
      "mtllib m.mtl\no box\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvn 0 0 1\n"
      "usemtl painted\ns 1\nf 1/1/1 2/2/1 3/3/1 4/4/1\nl 1 2\np 1\n"
      "g top\nv 0 0 5\nv 1 0 5\nv 1 1 5\nusemtl plain\nf 1//1 4//1 3//1 2//1\n"
      "usemtl painted\nf -3/-4/-1 -2/-3/-1 -1//-1\nf 1/1/1 3/3/1 2/2/1\n",
      "newmtl plain\nKd 0 0.5 1\nnewmtl painted\nKd 1 1 1\nmap_Kd t.png\n");
  ASSERT_TRUE(imported.ok()) << imported.error().message;
  EXPECT_THAT(imported->warnings, IsEmpty());
  ASSERT_EQ(imported->parts.size(), 2U);
  const io::MeshPart& painted = imported->parts[0];
  const io::MeshPart& plain = imported->parts[1];
  EXPECT_EQ(painted.mesh.texture(0, 0), (Rgb8{1, 2, 3}));
  constexpr TestCorner kA{0, 0, 0, 0, 0};
  constexpr TestCorner kB{1, 0, 0, 1, 0};
  constexpr TestCorner kC{1, 1, 0, 1, 1};
  constexpr TestCorner kD{0, 1, 0, 0, 1};
  using Triangle3 = std::array<TestCorner, 3>;
  EXPECT_THAT(triangles_of(painted.mesh),
              UnorderedElementsAre(Triangle3{kA, kB, kC}, Triangle3{kA, kC, kD},
                                   Triangle3{TestCorner{0, 0, 5, 0, 0}, {1, 0, 5, 1, 0}, {1, 1, 5, 0, 0}},
                                   Triangle3{kA, kC, kB}));
  EXPECT_EQ(painted.mesh.vertices.size(), 7U) << "corners that are equal share a vertex";
  EXPECT_EQ(painted.mesh.normals, std::vector<Eigen::Vector3f>(7, {0, 0, 1}));
  const auto bare = [](float x, float y) { return TestCorner{x, y, 0, -1, -1}; };
  EXPECT_THAT(triangles_of(plain.mesh), UnorderedElementsAre(Triangle3{bare(0, 0), bare(0, 1), bare(1, 1)},
                                                             Triangle3{bare(0, 0), bare(1, 1), bare(1, 0)}));
  EXPECT_EQ(plain.mesh.vertices.size(), 4U);
  EXPECT_TRUE(plain.has_color);
  EXPECT_EQ(plain.color, (Rgb8{0, 128, 255}));
}

TEST_F(ObjFile, ColoursOfVerticesAndMaterials) {
  const std::string colored = "v 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 0 1 0 0 0 1\nf 1 2 3\n";
  EXPECT_EQ(only_part(colored).mesh.colors, (std::vector<Rgb8>{{255, 0, 0}, {0, 255, 0}, {0, 0, 255}}));
  EXPECT_THAT(only_part("v 1 1 0\n" + colored).mesh.colors, IsEmpty()) << "not all vertices have one";
  const std::string plain = kCorners + std::string("mtllib m.mtl\nusemtl m\nf 1 2 3\n");
  EXPECT_EQ(only_part(plain, "newmtl m\nKd 1 0 0\n").color, (Rgb8{255, 0, 0}));
  EXPECT_TRUE(only_part(plain, "newmtl m\nKd 0 0 0\n").has_color) << "black";
  for (const char* silent : {"", "newmtl m\n", "newmtl n\nKd 1 0 0\n", "newmtl m\nKd spectral f.rfl\n"})
    EXPECT_FALSE(only_part(plain, silent).has_color) << silent;
}

TEST_F(ObjFile, NamesOfMaterials) {
  const auto color_of = [&](const std::string& obj, const std::string& mtl) { return only_part(obj, mtl).color; };
  const std::string corners = kCorners;
  const Rgb8 red{255, 0, 0};
  EXPECT_EQ(color_of("mtllib m.mtl\n" + corners + "usemtl my mat\nf 1 2 3\n", "newmtl my mat\nKd 1 0 0\n"), red);
  EXPECT_EQ(color_of(corners + "usemtl m#1\nf 1 2 3\nmtllib m.mtl", "newmtl m#1 \nKd 1 0 0\n"), red) << "named later";
  EXPECT_EQ(color_of("mtllib m.mtl\n" + corners + "usemtl m\nf 1 2 3\n", "newmtl m\nKd 0 1 0\nNEWMTL m\nkd 1 0 0"), red)
      << "defined twice";
  EXPECT_EQ(color_of("MTLLIB m.mtl\nV 0 0 0\nv 1 0 0\nv 0 1 0\nUsemtl m\nF 1 2 3", "NewMtl m\nKD 1 0 0"), red);
}

TEST_F(ObjFile, OptionsOfTextures) {
  ASSERT_TRUE(write_color(directory_ / "t 1.png", Image<Rgb8>(4, 4, Rgb8{1, 2, 3})).ok());
  const std::string obj = kCorners + std::string("vt 0 0\nmtllib m.mtl\nusemtl m\nf 1/1 2/1 3/1\n");
  for (const char* options : {"", "-s 1 1 1 ", "-clamp on -o 0 0 0 -mm 0 1 ", "-blendu off -bm 2 -texres 8 .\\"})
    EXPECT_TRUE(only_part(obj, "newmtl m\nmap_Kd " + std::string(options) + "t 1.png \r\n").mesh.has_texture())
        << options;
}

TEST_F(ObjFile, AnyEndsOfLines) {
  for (const std::string end : {"\n", "\r\n", "\r", "\n\n", " \n", "\t\r\n"}) {
    std::string obj = "v 0 0 0\nv 1 0 0\n# f 3 2 1\nv 0 1 0\nf 1 2 3";
    for (std::size_t at = 0; (at = obj.find('\n', at)) != obj.npos; at += end.size()) obj.replace(at, 1, end);
    EXPECT_EQ(only_part(obj).mesh.faces.size(), 1U);
    EXPECT_EQ(only_part(obj + end).mesh.faces.size(), 1U);
  }
}

TEST_F(ObjFile, CornersMayLackNumbers) {
  for (const char* face : {"f 1 2 3", "f 1/ 2/ 3/", "f 1// 2// 3//", "f 1/1 2/1 3/1", "f 1//1 2//1 3//1 # front",
                           "f 1/1/1 2/1/1 3/1/1", "f -4 -3 -2"})
    EXPECT_EQ(only_part(kCorners + std::string(face)).mesh.vertices,
              (std::vector<Eigen::Vector3f>{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}}))
        << face;
}

TEST_F(ObjFile, WhatIsNotANumberIsRefused) {
  const std::string triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  ASSERT_EQ(error_of(triangle), "");
  for (const char* vertex : {"v", "v 1 2", "v a b c", "v 1 2 3x", "v 1 2 1e", "v 1 2 1e999"})
    EXPECT_THAT(error_of(triangle + vertex), HasSubstr("m.obj: holds a vertex without three numbers")) << vertex;
  for (const char* vertex : {"v nan 0 0", "v 0 inf 0"})
    EXPECT_THAT(error_of(triangle + vertex), HasSubstr("not finite")) << vertex;
  write_text(directory_ / "m.obj", "v 1e39 0 0\n" + triangle);
  EXPECT_THAT(read_mesh(directory_ / "m.obj").error().message, HasSubstr("not finite"));
  for (const char* face : {"f 1 2 0", "f a b c", "f 1 2 3 x", "f / 1 2 3", "f 1/2/3/4 2 3", "f 1//2/3 2 3"})
    EXPECT_THAT(error_of(triangle + face), HasSubstr("corners are not numbers of vertices")) << face;
  for (const char* face : {"f 1 2 4", "f 1 2 -4", "f 1 2 99999999", "f 1 2 2147483647", "f 1 2 -2147483648",
                           "f 1 2 3 9", "f 1 2 3 1 2 3 -9"})
    EXPECT_THAT(error_of(triangle + face), HasSubstr("a vertex that does not exist")) << face;
  // What they name is left out.
  for (const char* face : {"f 1/9 2/-9 3/2147483647", "f 1//9 2//-9 3//-2147483648", "f 1/-1/-1 2/-2/-2 3/1/1"})
    EXPECT_EQ(error_of(triangle + "vt 0 0\nvn 0 0 1\n" + face), "") << face;
}

TEST_F(ObjFile, FacesOfMoreThan255Corners) {
  for (const int num_corners : {254, 255, 256, 257, 258, 512, 1024}) {
    std::string vertices;
    std::string face = "f";
    for (int i = 0; i < num_corners; ++i) {
      const double angle = 6.283 * i / num_corners;
      vertices += "v " + std::to_string(std::cos(angle)) + " " + std::to_string(std::sin(angle)) + " 0\n";
      face += " " + std::to_string(i + 1);
    }
    EXPECT_EQ(only_part(vertices + face + "\nf 1 2 3\n").mesh.faces.size(), static_cast<std::size_t>(num_corners) - 1);
  }
}

// Found by fuzzing: Assimp 5.2 wrote beyond its arrays.
TEST_F(ObjFile, DamagedFilesAreHarmless) {
  const std::string start = "# cube\nmtllib m.mtl\no a\nv 0 0 0\nv .1 0 0 1 0 0\nv 0 0.1 0\nv 0 0 1e-1\nvt 0 0\n";
  const auto imported =
      import(start +
                 "vt 1 0  0\nvn 0 0 1\nusemtl red\ns 1v 0 0.1 0\nv 0 0 1e-1\nvt 0 0\nvt 0  1u0\n{emtl red\ns 1\n"
                 "f 1/1/1 2/2/1 3/1/1\ng b\nu\ns 1\nf 1/1/1 2/6/1 3/1/1\ng b\nusemtl blue\nn -1 -2s 1\n"
                 "f 1/1/1 2/2/1 3/1/1\ng \nf 1/1/1 2/2/1 3/1/9\ng b\nuse1mtl bmue\nf -1 -2 -3\nf\xC0"
                 "1//1 2//1 4/1 3//2\nl 1 2\np 1\n",
             "nEwmtl red\nKd 1 0 0\nmap_Kd t.pn\1\4.pm 1b png\nnewmtl blue\nKd 0 0 1\nd 0.5\nmap_Kd -s 1 1 1 t.png\n");
  ASSERT_TRUE(imported.ok()) << imported.error().message;
  EXPECT_EQ(imported->warnings.size(), 3U) << "two textures, and faces without texture coordinates";
  const std::string zeros = std::string("v 0 0 0\0 9\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 2\0 3\n\0", 45);
  EXPECT_EQ(only_part(zeros).mesh.faces.size(), 2U);
}

TEST_F(ObjFile, WhatIsNotUsedTakesNoMemory) {
  std::string obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  for (int i = 0; i < 2000; ++i) obj += "t a 8192/8192/8192\nvw 0 1 1\n";
  const io::MemoryGrowth growth;
  EXPECT_EQ(error_of(obj), "");
  EXPECT_LT(growth.bytes(), 50'000'000U);
}

}  // namespace
}  // namespace resight
