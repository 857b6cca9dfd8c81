// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <sys/stat.h>

#include "resight/io/images.hpp"
#include "resight/io/internal/test_data.hpp"
#include "resight/io/mesh.hpp"

namespace resight {
namespace {

using io::write_text;
using testing::HasSubstr;

constexpr const char* kTriangleObj = "v 0 0 0\nv .1 0 0\nv 0 .1 0\nvt 0 0\nvt 1 0\nvt 0 1\nusemtl m\nf 1/1 2/2 3/3\n";

std::size_t num_warnings(const std::filesystem::path& file) {
  const auto read = read_mesh(file);
  EXPECT_TRUE(read.ok()) << read.error().message;
  return read.ok() ? read->warnings.size() : 0;
}

TEST(MeshFiles, NumbersMayBeginWithAPoint) {
  io::TestDirectory directory;
  write_text(directory / "t.obj", kTriangleObj);
  const auto read = read_mesh(directory / "t.obj");
  ASSERT_TRUE(read.ok()) << read.error().message;
  EXPECT_EQ(read->mesh.vertices.size(), 3U);
  EXPECT_FLOAT_EQ(read->mesh.vertices[1].x() + read->mesh.vertices[2].x(), 0.1F);
  write_text(directory / "t.obj", "  v\t.5 -.5 0.5\nv 0 -.5 .5\nv .5 .0 +.5\no a .b\nf 1 2 3\n");
  EXPECT_EQ(read_mesh(directory / "t.obj")->mesh.vertices[0], Eigen::Vector3f(0.5F, -0.5F, 0.5F));
}

TEST(MeshFiles, LinesMayGoOn) {
  io::TestDirectory directory;
  write_text(directory / "t.obj", "v 1 \\\n .2 3\nv 1\\\r\n2 3\n# a\\\nv 2 2 3\nf 1 \\\n2 \\\n 3\n");
  const auto read = read_mesh(directory / "t.obj");
  ASSERT_TRUE(read.ok()) << read.error().message;
  EXPECT_THAT(read->mesh.vertices,
              testing::ElementsAre(Eigen::Vector3f(1, 0.2F, 3), Eigen::Vector3f(1, 2, 3), Eigen::Vector3f(2, 2, 3)));
}

TEST(MeshFiles, ObjFilesThatTakeTooLongAreRefused) {
  io::TestDirectory directory;
  const auto repeated = [](const std::string& text, int count) {
    std::string all;
    for (int i = 0; i < count; ++i) all += text;
    return all;
  };
  const auto names = [](const std::string& keyword, int count) {
    std::string all;
    for (int i = 0; i < count; ++i) all += keyword + " a" + std::to_string(i) + "\n";
    return all;
  };
  const auto message_of = [&](const std::string& text) {
    write_text(directory / "m.obj", kTriangleObj + text);
    const auto read = read_mesh(directory / "m.obj");
    return read ? std::string() : read.error().message;
  };
  EXPECT_EQ(message_of("f" + repeated(" 1/1", 1024) + "\n" + repeated("f 1 2 3\n", 50)), "");
  EXPECT_THAT(message_of("f" + repeated(" 1/1/1", 1025) + "\n"), HasSubstr("1024 corners"));
  EXPECT_THAT(message_of("f" + repeated(" 1 2 \\\n", 700) + "3\n"), HasSubstr("1024 corners")) << "over several lines";
  EXPECT_THAT(message_of("f" + repeated(" 1", 400000)), HasSubstr("1024 corners"));
  EXPECT_EQ(message_of(repeated("usemtl a\nusemtl b\n", 50000) + repeated("o a\n", 50000) + repeated("g a\n", 50000)),
            "");
  EXPECT_THAT(message_of(names("usemtl", 4097)), HasSubstr("4096 materials"));
  EXPECT_THAT(message_of(names("mtllib", 4097)), HasSubstr("4096 materials or libraries"));
}

TEST(MeshFiles, TexturesBeforeTheFirstMaterialAreSkipped) {
  io::TestDirectory directory;
  write_text(directory / "t.obj", std::string("mtllib t.mtl\n") + kTriangleObj);
  for (const char* first : {"map_Kd t.png\n", "bump t.png\n", "Kd 1 0 0\n", "map_Kd", "-", ""}) {
    write_text(directory / "t.mtl", first);
    const auto read = read_mesh(directory / "t.obj");
    EXPECT_TRUE(read.ok()) << first << ": " << read.error().message;
  }
  write_text(directory / "t.mtl", "map_Kd a\n newmtl m\nNs 3\n\tmap_Kd b c.png\nbump d\nKd 1 0 0\n");
  const auto read = read_mesh(directory / "t.obj");
  ASSERT_EQ(read->warnings.size(), 1U);
  EXPECT_THAT(read->warnings[0], HasSubstr("b c.png"));
}

// Editors of Windows write it; the first statement is the material, or the library of materials.
TEST(MeshFiles, AByteOrderMarkIsSkipped) {
  io::TestDirectory directory;
  const std::string mark = "\xEF\xBB\xBF";
  write_text(directory / "t.obj", mark + "mtllib t.mtl\n" + kTriangleObj);
  write_text(directory / "t.mtl", mark + "newmtl m\nKd 1 0 0\n");
  const auto read = read_mesh(directory / "t.obj");
  ASSERT_TRUE(read.ok()) << read.error().message;
  ASSERT_FALSE(read->mesh.colors.empty());
  EXPECT_EQ(read->mesh.colors[0].r, 255);
  EXPECT_EQ(read->mesh.colors[0].g, 0);
}

TEST(MeshFiles, MaterialsOfPipesAndDevicesAreNotRead) {
  io::TestDirectory directory;
  ASSERT_EQ(::mkfifo((directory / "pipe").c_str(), 0600), 0);
  for (const char* name : {"pipe", "/dev/zero"}) {
    write_text(directory / "t.obj", std::string("mtllib ") + name + "\n" + kTriangleObj);
    const auto read = read_mesh(directory / "t.obj");
    ASSERT_TRUE(read.ok()) << name;
    ASSERT_EQ(read->warnings.size(), 1U) << name;
    EXPECT_THAT(read->warnings[0], HasSubstr(std::string("left out: "))) << name;
  }
  write_text(directory / "t.obj", kTriangleObj);
  EXPECT_EQ(num_warnings(directory / "t.obj"), 0U) << "names no other file";
}

TEST(MeshFiles, MaterialsAreFoundBesideTheModel) {
  io::TestDirectory directory;
  write_text(directory / "t.mtl", "newmtl m\nKd 1 0 0\n");
  write_text(directory / "parts/u.mtl", "newmtl m\nKd 0 1 0\n");
  const auto color_with = [&](const std::string& library) {
    write_text(directory / "t.obj", "mtllib " + library + "\n" + kTriangleObj);
    const auto read = read_mesh(directory / "t.obj");
    EXPECT_TRUE(read.ok() && read->warnings.empty() && !read->mesh.colors.empty()) << library;
    return read.ok() && !read->mesh.colors.empty() ? read->mesh.colors[0] : Rgb8{};
  };
  const Rgb8 red{255, 0, 0};
  const Rgb8 green{0, 255, 0};
  EXPECT_EQ(color_with("t.mtl"), red);
  EXPECT_EQ(color_with("parts\\u.mtl"), green);
  EXPECT_EQ(color_with("C:\\scans\\t.mtl"), red) << "made on another machine";
  EXPECT_EQ(color_with("/scans/t.mtl"), red);
  EXPECT_EQ(color_with("before_it_was_renamed.mtl"), red);
}

TEST(MeshFiles, AFileWithManyNamesIsReadOnce) {
  io::TestDirectory directory;
  write_text(directory / "t.mtl", "newmtl m\nKd 1 0 0\n" + std::string(1'000'000, '#'));
  std::string obj;
  for (int i = 0; i < 300; ++i)
    obj += "mtllib missing_" + std::to_string(i) + "\nmtllib " + std::string(i, '/') + "t.mtl\n";
  write_text(directory / "t.obj", obj + kTriangleObj);
  const io::MemoryGrowth growth;
  const auto read = read_mesh(directory / "t.obj");
  ASSERT_TRUE(read.ok() && !read->mesh.colors.empty());
  EXPECT_EQ(read->mesh.colors[0], (Rgb8{255, 0, 0}));
  EXPECT_LT(growth.bytes(), 50'000'000U);
}

/// A triangle in a buffer of a file, with one texture.
std::string make_gltf(const std::string& buffer, const std::string& texture) {
  return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
    "meshes":[{"primitives":[{"attributes":{"POSITION":0,"TEXCOORD_0":1},"material":0}]}],
    "materials":[{"pbrMetallicRoughness":{"baseColorTexture":{"index":0}}}],"textures":[{"source":0}],
    "images":[{"uri":")" +
         texture + R"("}],"buffers":[{"uri":")" + buffer + R"(","byteLength":60}],
    "bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":24}],
    "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"},
                 {"bufferView":1,"componentType":5126,"count":3,"type":"VEC2"}]})";
}

TEST(MeshFiles, OnlyFilesBelowTheFolderOfTheModelAreRead) {
  io::TestDirectory directory;
  std::string buffer;
  for (const float x : {0.F, 0.F, 0.F, .1F, 0.F, 0.F, 0.F, .1F, 0.F, 0.F, 0.F, 1.F, 0.F, 0.F, 1.F})
    buffer.append(reinterpret_cast<const char*>(&x), 4);
  const Image<Rgb8> texture(4, 4, Rgb8{10, 20, 30});
  for (const char* folder : {"secret", "model/parts"}) {
    write_text(directory / (std::string(folder) + "/b.bin"), buffer);
    ASSERT_TRUE(write_color(directory / (std::string(folder) + "/t.png"), texture).ok());
  }
  const auto mesh = directory / "model/m.gltf";
  write_text(mesh, make_gltf("parts/b.bin", "parts/t.png"));
  EXPECT_EQ(num_warnings(mesh), 0U) << "data in the folder of the model are used";
  EXPECT_TRUE(read_mesh(mesh)->mesh.has_texture());
  for (const std::string& outside :
       {std::string("../secret/"), (directory / "secret/").string(), std::string("parts/../../secret/")}) {
    write_text(mesh, make_gltf(outside + "b.bin", "parts/t.png"));
    EXPECT_FALSE(read_mesh(mesh).ok()) << outside;
    write_text(mesh, make_gltf("parts/b.bin", outside + "t.png"));
    EXPECT_FALSE(read_mesh(mesh)->mesh.has_texture()) << outside;
    ASSERT_EQ(num_warnings(mesh), 1U) << outside;
    EXPECT_THAT(read_mesh(mesh)->warnings[0], HasSubstr("outside the folder")) << outside;
  }
}

// Found by fuzzing: Assimp read beyond their ends.
TEST(MeshFiles, AnyNameOfAMissingFileIsHarmless) {
  io::TestDirectory directory;
  for (const std::string name : {"a://", "://", "\\\\", "\\\\\\", " ", "\t", "/", ".", "..", "a/", "%20"}) {
    write_text(directory / "t.obj", kTriangleObj + ("mtllib " + name));
    EXPECT_TRUE(read_mesh(directory / "t.obj").ok()) << name;
    std::string quoted;
    for (const char c : name) quoted += c == '\\' ? "\\\\" : c == '\t' ? "\\t" : std::string(1, c);
    write_text(directory / "t.gltf", make_gltf(quoted, "t.png"));
    const auto read = read_mesh(directory / "t.gltf");
    ASSERT_FALSE(read.ok()) << name;
    EXPECT_THAT(read.error().message, HasSubstr("t.gltf: cannot be read as a mesh")) << name;
  }
}

TEST(MeshFiles, TexturesOfAPlyFileLieInItsFolder) {
  io::TestDirectory directory;
  const Image<Rgb8> texture(4, 4, Rgb8{10, 20, 30});
  ASSERT_TRUE(write_color(directory / "t.png", texture).ok());
  ASSERT_TRUE(write_color(directory / "model/t.png", texture).ok());
  const auto write_model = [&](const std::string& name) {
    write_text(directory / "model/t.ply",
               "ply\nformat ascii 1.0\ncomment TextureFile " + name +
                   "\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty float s\n"
                   "property float t\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
                   "0 0 0 0 0\n.1 0 0 1 0\n0 .1 0 0 1\n3 0 1 2\n");
  };
  write_model("t.png");
  EXPECT_EQ(num_warnings(directory / "model/t.ply"), 0U);
  for (const std::string& name : {std::string("../t.png"), (directory / "t.png").string()}) {
    write_model(name);
    EXPECT_EQ(num_warnings(directory / "model/t.ply"), 1U) << name;
  }
}

}  // namespace
}  // namespace resight
