// SPDX-License-Identifier: Apache-2.0
#include "resight/io/ply.hpp"

#include <gmock/gmock.h>

#include "resight/io/images.hpp"
#include "resight/io/internal/test_data.hpp"
#include "resight/io/mesh.hpp"

namespace resight {
namespace {

using testing::Each;
using testing::HasSubstr;

TriangleMesh small_mesh() {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {0.1F, 0, 0}, {0, 0.1F, 0}, {0, 0, 0.123456F}};
  mesh.faces = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
  compute_vertex_normals(mesh);
  return mesh;
}

TEST(Ply, TexturedMeshComesBack) {
  io::TestDirectory directory;
  TriangleMesh mesh = small_mesh();
  mesh.uvs = {{0.1F, 0.2F}, {0.9F, 0.25F}, {0.5F, 0.75F}, {0.0F, 1.0F}};
  mesh.texture = io::random_frame("t", 1).color;
  ASSERT_TRUE(write_ply(directory / "mesh.ply", mesh).ok());
  const auto read = read_mesh(directory / "mesh.ply");
  ASSERT_TRUE(read.ok()) << read.error().message;
  EXPECT_TRUE(read->warnings.empty());
  EXPECT_EQ(read->mesh.vertices, mesh.vertices);
  EXPECT_EQ(read->mesh.normals.size(), 4U);
  EXPECT_EQ(read->mesh.faces, mesh.faces);
  EXPECT_EQ(read->mesh.texture, mesh.texture);
  for (int i = 0; i < 4; ++i) EXPECT_LT((read->mesh.uvs[i] - mesh.uvs[i]).norm(), 1e-6F);
}

TEST(Ply, VertexColoursAndMillimetres) {
  io::TestDirectory directory;
  TriangleMesh mesh = small_mesh();
  mesh.colors = {{1, 2, 3}, {4, 5, 6}, {7, 8, 9}, {250, 251, 252}};
  ASSERT_TRUE(write_ply(directory / "mesh.ply", mesh, 1000).ok());
  EXPECT_NEAR(read_ply(directory / "mesh.ply")->mesh.vertices[3].z(), 123.456F, 1e-4F);
  const auto read = read_mesh(directory / "mesh.ply", {.metres_per_unit = 0.001});
  ASSERT_TRUE(read.ok()) << read.error().message;
  EXPECT_EQ(read->mesh.colors, mesh.colors);
  EXPECT_NEAR(read->mesh.vertices[3].z(), 0.123456F, 1e-7F);
}

TEST(Ply, CloudComesBack) {
  io::TestDirectory directory;
  PointCloud cloud;
  cloud.points = {{1, 2, 3}, {-4, 5.5F, 6}};
  cloud.colors = {{1, 2, 3}, {255, 0, 128}};
  cloud.normals = {{1, 0, 0}, {0, 0, -1}};
  ASSERT_TRUE(write_ply(directory / "cloud.ply", cloud).ok());
  const auto read = read_ply_cloud(directory / "cloud.ply");
  ASSERT_TRUE(read.ok()) << read.error().message;
  EXPECT_EQ(read->points, cloud.points);
  EXPECT_EQ(read->colors, cloud.colors);
  EXPECT_EQ(read->normals, cloud.normals);
  EXPECT_THAT(read_mesh(directory / "cloud.ply").error().message, HasSubstr("no faces"));
}

TEST(Ply, AsciiExtrasPolygonsAndTextureV) {
  const auto read = parse_ply(
      "ply\nformat ascii 1.0\ncomment TextureFile my picture.jpg \nobj_info x\nelement vertex 4\nproperty double "
      "x\nproperty float z\n"
      "property float y\nproperty int quality\nproperty float texture_u\nproperty float texture_v\nelement face "
      "1\nproperty uchar flag\n"
      "property list uchar uint vertex_index\nelement edge 1\nproperty int a\nend_header\n"
      "0 0 0 5 0 0\n1 0 0 5 1 0\n1 0 1 5 1 1\n0 0 1 5 0.25 1\n9 4 0 1 2 3\n77\n",
      "t");
  ASSERT_TRUE(read.ok()) << read.error().message;
  EXPECT_THAT(read->texture_files, testing::ElementsAre("my picture.jpg"));
  EXPECT_EQ(read->mesh.vertices[2], Eigen::Vector3f(1, 1, 0));
  ASSERT_EQ(read->mesh.faces.size(), 2U);
  EXPECT_EQ(read->mesh.faces[1], (std::array<int, 3>{0, 2, 3}));
  EXPECT_EQ(read->mesh.uvs[3], Eigen::Vector2f(0.25F, 0))
      << "v points up in the file, the origin is top left in memory";
}

TEST(Ply, NormalsThatAreNoneAreComputed) {
  io::TestDirectory directory;
  io::write_text(directory / "mesh.ply",
                 "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
                 "property float nx\nproperty float ny\nproperty float nz\nelement face 1\n"
                 "property list uchar int vertex_indices\nend_header\n"
                 "0 0 0 0 0 0\n0 0.1 0 nan nan nan\n0 0 0.1 0 0 0\n3 0 1 2\n");
  const auto content = read_ply(directory / "mesh.ply");
  ASSERT_TRUE(content.ok()) << content.error().message;
  EXPECT_THAT(content->mesh.normals, Each(Eigen::Vector3f(0, 0, 0)));
  const auto read = read_mesh(directory / "mesh.ply");
  ASSERT_TRUE(read.ok()) << read.error().message;
  EXPECT_THAT(read->mesh.normals, Each(Eigen::Vector3f(1, 0, 0)));
}

// A U of 5 squares in a 3x2 rectangle.
TEST(Ply, ConcaveFacesKeepTheirShape) {
  const std::string head = "ply\nformat ascii 1.0\n";
  const std::string vertex = "element vertex 8\nproperty float x\nproperty float y\nproperty float z\n";
  const std::string face = "element face 1\nproperty list ushort int vertex_indices\n";
  const std::string corners = "0 0 0\n3 0 0\n3 2 0\n2 2 0\n2 1 0\n1 1 0\n1 2 0\n0 2 0\n";
  const std::string polygon = "8 7 0 1 2 3 4 5 6\n";
  const auto read = parse_ply(head + vertex + face + "end_header\n" + corners + polygon, "t");
  ASSERT_TRUE(read.ok()) << read.error().message;
  ASSERT_EQ(read->mesh.faces.size(), 6U);
  double area = 0;
  for (const auto& [a, b, c] : read->mesh.faces) {
    const auto& v = read->mesh.vertices;
    area += 0.5 * (v[b] - v[a]).cross(v[c] - v[a]).norm();
  }
  EXPECT_NEAR(area, 5, 1e-6);
  const auto faces_first = parse_ply(head + face + vertex + "end_header\n" + polygon + corners, "t");
  ASSERT_TRUE(faces_first.ok()) << faces_first.error().message;
  EXPECT_EQ(faces_first->mesh.faces, read->mesh.faces);
  EXPECT_EQ(faces_first->mesh.vertices, read->mesh.vertices);
  const auto read_polygon = [&](int num_corners) {
    std::string list = std::to_string(num_corners);
    for (int i = 0; i < num_corners; ++i) list += " " + std::to_string(i % 8);
    return parse_ply(head + vertex + face + "end_header\n" + corners + list + "\n", "t");
  };
  EXPECT_EQ(read_polygon(1024)->mesh.faces.size(), 1022U);
  EXPECT_THAT(read_polygon(1025).error().message, HasSubstr("t: has a face of more than 1024 corners"));
}

TEST(Ply, BigEndian) {
  std::string bytes =
      "ply\nformat binary_big_endian 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty short "
      "z\nend_header\n";
  bytes += std::string("\x3f\x80\0\0\xc0\0\0\0\x01\x02", 10);
  const auto read = parse_ply(bytes, "t");
  ASSERT_TRUE(read.ok()) << read.error().message;
  EXPECT_EQ(read->mesh.vertices[0], Eigen::Vector3f(1, -2, 258));
}

TEST(Ply, CornerTextureCoordinatesSplitVertices) {
  const auto read = parse_ply(
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement face 2\n"
      "property list uchar int vertex_indices\nproperty list uchar float texcoord\nend_header\n"
      "0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2 6 0 0 1 0 1 1\n3 0 2 3 6 0 0 0.5 0.5 0 1\n",
      "t");
  ASSERT_TRUE(read.ok()) << read.error().message;
  EXPECT_EQ(read->mesh.vertices.size(), 5U) << "vertex 2 has two texture coordinates, vertex 0 has one";
  EXPECT_EQ(read->mesh.uvs.size(), 5U);
  EXPECT_EQ(read->mesh.vertices[read->mesh.faces[1][1]], Eigen::Vector3f(1, 1, 0));
}

/// A square as MeshLab writes it, with one triangle of each of two textures: a.png is red, b.png is blue.
class MeshLabPly : public testing::Test {
 protected:
  MeshLabPly() {
    EXPECT_TRUE(write_color(directory_ / "a.png", Image<Rgb8>(8, 8, kRed)).ok());
    EXPECT_TRUE(write_color(directory_ / "b.png", Image<Rgb8>(4, 4, kBlue)).ok());
  }
  /// `first` and `second`: texture coordinates and number of the texture of each triangle.
  MeshFile read(const std::string& first, const std::string& second) {
    io::write_text(
        directory_ / "m.ply",
        "ply\nformat ascii 1.0\ncomment TextureFile a.png\ncomment TextureFile b.png\nelement vertex 4\n"
        "property float x\nproperty float y\nproperty float z\nelement face 2\n"
        "property list uchar int vertex_indices\nproperty list uchar float texcoord\nproperty int texnumber\n"
        "end_header\n0 0 0\n.2 0 0\n.2 .2 0\n0 .2 0\n3 0 1 2 " +
            first + "\n3 0 2 3 " + second + "\n");
    auto mesh = read_mesh(directory_ / "m.ply");
    EXPECT_TRUE(mesh.ok()) << mesh.error().message;
    return mesh.ok() ? *std::move(mesh) : MeshFile{};
  }
  /// The colours of the lower and the upper triangle.
  static std::vector<Rgb8> colors_of(const TriangleMesh& mesh) {
    std::vector<Rgb8> colors(2);
    for (int f = 0; f < 2; ++f) {
      const auto& corners = mesh.faces[static_cast<std::size_t>(f)];
      const Eigen::Vector3f sum = mesh.vertices[corners[0]] + mesh.vertices[corners[1]] + mesh.vertices[corners[2]];
      colors[sum.x() > sum.y() ? 0 : 1] = surface_color(mesh, f, 0.3F, 0.3F);
    }
    return colors;
  }

  static constexpr Rgb8 kRed{255, 0, 0};
  static constexpr Rgb8 kBlue{0, 0, 255};
  const std::string first_uvs_ = "6 0 0 1 0 1 1 ";
  const std::string second_uvs_ = "6 0 0 1 1 0 1 ";
  io::TestDirectory directory_;
};

TEST_F(MeshLabPly, EachFaceHasItsTexture) {
  const MeshFile file = read(first_uvs_ + "0", second_uvs_ + "1");
  EXPECT_TRUE(file.mesh.has_texture());
  EXPECT_THAT(file.warnings, testing::IsEmpty());
  ASSERT_EQ(file.mesh.faces.size(), 2U);
  EXPECT_THAT(colors_of(file.mesh), testing::ElementsAre(kRed, kBlue));
  EXPECT_THAT(colors_of(read(first_uvs_ + "1", second_uvs_ + "0").mesh), testing::ElementsAre(kBlue, kRed));
  EXPECT_THAT(colors_of(read(first_uvs_ + "1", second_uvs_ + "1").mesh), Each(kBlue));
}

TEST_F(MeshLabPly, FacesWithoutTextureLeaveItToTheOthers) {
  for (const std::string& second : {std::string("0 1"), second_uvs_ + "-1", second_uvs_ + "2"}) {
    const MeshFile file = read(first_uvs_ + "0", second);
    EXPECT_TRUE(file.mesh.has_texture()) << second;
    EXPECT_THAT(file.warnings, testing::ElementsAre(HasSubstr("without texture coordinates"))) << second;
    ASSERT_EQ(file.mesh.faces.size(), 2U) << second;
    EXPECT_THAT(colors_of(file.mesh), testing::ElementsAre(kRed, Rgb8{128, 128, 128})) << second;
  }
  const MeshFile bare = read("0 0", "0 1");
  EXPECT_FALSE(bare.mesh.has_texture());
  EXPECT_THAT(bare.warnings, testing::ElementsAre(HasSubstr("without texture coordinates")));
}

TEST_F(MeshLabPly, AMissingTextureLeavesTheOthers) {
  std::filesystem::remove(directory_ / "b.png");
  const MeshFile file = read(first_uvs_ + "0", second_uvs_ + "1");
  EXPECT_THAT(file.warnings, testing::ElementsAre(HasSubstr("b.png")));
  EXPECT_EQ(colors_of(file.mesh)[0], kRed);
}

TEST(Ply, BadFiles) {
  const std::string head = "ply\nformat binary_little_endian 1.0\n";
  const std::string xyz = "property float x\nproperty float y\nproperty float z\n";
  const auto message = [](const std::string& text) {
    const auto read = parse_ply(text, "bad.ply");
    return read.ok() ? std::string("no error") : read.error().message;
  };
  EXPECT_THAT(message(""), HasSubstr("not a PLY"));
  EXPECT_THAT(message(head), HasSubstr("end_header"));
  EXPECT_THAT(message(head + "element vertex 99999999999999\n" + xyz + "end_header\n"), HasSubstr("cut off"));
  EXPECT_THAT(message(head + "element vertex 4000000000\nend_header\n"), HasSubstr("cut off"));
  EXPECT_THAT(message(head + "element vertex -1\n" + xyz + "end_header\n"), HasSubstr("line 3"));
  EXPECT_THAT(message(head + "element vertex 1\nproperty real x\nend_header\n"), HasSubstr("line 4"));
  EXPECT_THAT(message(head + "element vertex 1\nproperty float x\nend_header\n1234"), HasSubstr("no x, y, z"));
  const std::string one = head + "element vertex 1\n" + xyz +
                          "element face 1\nproperty list uchar int vertex_indices\nend_header\n" +
                          std::string(12, '\0');
  EXPECT_THAT(message(one + std::string("\x03\0\0\0\0\0\0\0\0\x01\0\0\0", 13)), HasSubstr("vertex 1 of 1"));
  EXPECT_THAT(message(one + std::string("\x03\0\0\0\0\0\0\0\0\xff\xff\xff\xff", 13)), HasSubstr("refers to vertex"));
  EXPECT_THAT(message(one + "\x03"), HasSubstr("too early"));
  EXPECT_THAT(message("ply\nformat ascii 1.0\nelement vertex 1\n" + xyz + "end_header\n1 nan 2\n"),
              HasSubstr("not finite"));
}

}  // namespace
}  // namespace resight
