// SPDX-License-Identifier: Apache-2.0
#include "resight/models/library_file.hpp"

#include <gmock/gmock.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <functional>
#include <iterator>
#include <limits>

#include "resight/core/hash.hpp"
#include "resight/core/random.hpp"
#include "resight/models/internal/library_payload.hpp"

namespace resight {
namespace {

namespace fs = std::filesystem;
using Bytes = std::vector<std::uint8_t>;
using testing::HasSubstr;

constexpr std::size_t kHeaderBytes = 40;
constexpr std::size_t kPayloadBytesAt = 24;
constexpr std::size_t kChecksumAt = 32;

class LibraryFile : public testing::Test {
 protected:
  LibraryFile()
      : folder_(fs::temp_directory_path() / ("resight_library_test_" + std::to_string(getpid()))),
        path_(folder_ / "models.bin") {
    fs::create_directories(folder_);
  }
  ~LibraryFile() override { fs::remove_all(folder_); }
  LibraryFile(const LibraryFile&) = delete;
  LibraryFile& operator=(const LibraryFile&) = delete;

  void write(const Bytes& bytes) const {
    std::ofstream(path_, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  }
  [[nodiscard]] Bytes read() const {
    std::ifstream file(path_, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  }
  fs::path folder_;
  fs::path path_;
};

Eigen::Vector3f random_vector(Rng& rng) {
  return {static_cast<float>(rng.normal()), static_cast<float>(rng.normal()), static_cast<float>(rng.normal())};
}

CodedFeatures make_features(FeatureType type, int count, Rng& rng) {
  FeatureSet set{.type = type,
                 .dimension = type == FeatureType::kSift ? 128 : 352,
                 .points = {},
                 .normals = {},
                 .descriptors = {}};
  for (int i = 0; i < count; ++i) {
    set.points.push_back(random_vector(rng));
    set.normals.push_back(random_vector(rng).normalized());
    for (int k = 0; k < set.dimension; ++k) set.descriptors.push_back(static_cast<float>(rng.uniform()));
  }
  return encode(set);
}

ObjectModel make_object(const std::string& name, int bop_id, Rng& rng) {
  ObjectModel object;
  object.name = name;
  object.bop_id = bop_id;
  for (int i = 0; i < 50; ++i) {
    object.surface.points.push_back(random_vector(rng));
    object.surface.normals.push_back(random_vector(rng).normalized());
    object.surface.colors.push_back({static_cast<std::uint8_t>(i), 2, 3});
  }
  object.sift = make_features(FeatureType::kSift, 6, rng);
  object.shot = make_features(FeatureType::kShot, bop_id == 2 ? 0 : 5, rng);
  object.symmetries.discrete.push_back(Rigid3::from_axis_angle({1, 2, 3}, 0.5) * Rigid3::from_translation({4, 5, 6}));
  object.symmetries.continuous.push_back({.direction = {0, 1, 2}, .point = {7, 8, 9}});
  object.shape_symmetries.discrete.push_back(Rigid3::from_axis_angle({3, 1, 2}, 0.7));
  object.shape_symmetries.continuous.push_back({.direction = {1, 1, 2}, .point = {1, 8, 9}});
  object.center = random_vector(rng);
  object.diameter_m = 0.25F;
  return object;
}

ModelLibrary make_library() {
  Rng rng(1);
  ModelLibrary library;
  library.objects.push_back(make_object("mug", 3, rng));
  library.objects.push_back(make_object("caf\xC3\xA9 tin", 2, rng));
  library.options_hash = 0x123456789ABCDEF0ULL;
  library.surface_voxel_m = 0.004F;
  return library;
}

void expect_equal(const CodedFeatures& a, const CodedFeatures& b) {
  EXPECT_EQ(a.type, b.type);
  EXPECT_EQ(a.dimension, b.dimension);
  EXPECT_EQ(a.points, b.points);
  EXPECT_EQ(a.normals, b.normals);
  EXPECT_EQ(a.codes, b.codes);
}

void expect_equal(const ObjectSymmetries& a, const ObjectSymmetries& b) {
  ASSERT_EQ(a.discrete.size(), b.discrete.size());
  for (std::size_t k = 0; k < a.discrete.size(); ++k) EXPECT_EQ(a.discrete[k].matrix(), b.discrete[k].matrix());
  ASSERT_EQ(a.continuous.size(), b.continuous.size());
  for (std::size_t k = 0; k < a.continuous.size(); ++k) {
    EXPECT_EQ(a.continuous[k].direction, b.continuous[k].direction);
    EXPECT_EQ(a.continuous[k].point, b.continuous[k].point);
  }
}

void expect_equal(const ModelLibrary& a, const ModelLibrary& b) {
  EXPECT_EQ(a.options_hash, b.options_hash);
  EXPECT_EQ(a.surface_voxel_m, b.surface_voxel_m);
  ASSERT_EQ(a.objects.size(), b.objects.size());
  for (std::size_t i = 0; i < a.objects.size(); ++i) {
    const ObjectModel& x = a.objects[i];
    const ObjectModel& y = b.objects[i];
    EXPECT_EQ(x.name, y.name);
    EXPECT_EQ(x.bop_id, y.bop_id);
    EXPECT_EQ(x.surface.points, y.surface.points);
    EXPECT_EQ(x.surface.normals, y.surface.normals);
    EXPECT_EQ(x.surface.colors, y.surface.colors);
    expect_equal(x.sift, y.sift);
    expect_equal(x.shot, y.shot);
    expect_equal(x.symmetries, y.symmetries);
    expect_equal(x.shape_symmetries, y.shape_symmetries);
    EXPECT_EQ(x.center, y.center);
    EXPECT_EQ(x.diameter_m, y.diameter_m);
  }
}

TEST_F(LibraryFile, GivesBackExactlyWhatWasSaved) {
  const ModelLibrary library = make_library();
  ASSERT_TRUE(save_library(library, path_).ok());
  const Result<ModelLibrary> loaded = load_library(path_, library.options_hash);
  ASSERT_TRUE(loaded.ok()) << loaded.error().message;
  expect_equal(*loaded, library);
  EXPECT_EQ(loaded->find("mug"), 0);
  EXPECT_EQ(loaded->find("caf\xC3\xA9 tin"), 1);
  EXPECT_EQ(loaded->find("nothing"), -1);
}

TEST_F(LibraryFile, SavesAnEmptyLibraryAndAnObjectWithoutFeatures) {
  ModelLibrary library;
  ASSERT_TRUE(save_library(library, path_).ok());
  ASSERT_TRUE(load_library(path_).ok());
  library.objects.push_back({.name = "bare", .surface = {}, .sift = {}, .shot = {}, .symmetries = {}});
  ASSERT_TRUE(save_library(library, path_).ok());
  const Result<ModelLibrary> loaded = load_library(path_);
  ASSERT_TRUE(loaded.ok()) << loaded.error().message;
  EXPECT_EQ(loaded->objects.at(0).name, "bare");
}

TEST_F(LibraryFile, SameLibrarySameBytesAndNothingElseInTheFolder) {
  ASSERT_TRUE(save_library(make_library(), path_).ok());
  const Bytes first = read();
  ASSERT_TRUE(save_library(*load_library(path_), path_).ok());
  EXPECT_EQ(read(), first);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), {}), 1);
}

TEST_F(LibraryFile, AFailedSaveLeavesTheOldFile) {
  ASSERT_TRUE(save_library(make_library(), path_).ok());
  const Result<void> saved = save_library(make_library(), path_ / "models.bin");
  ASSERT_FALSE(saved.ok());
  EXPECT_THAT(saved.error().message, HasSubstr("cannot be written"));
  fs::remove(path_);
  fs::create_directories(path_ / "occupied");  // a folder under the final name
  const Result<void> onto_folder = save_library(make_library(), path_);
  ASSERT_FALSE(onto_folder.ok());
  EXPECT_THAT(onto_folder.error().message, HasSubstr("cannot be written"));
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), {}), 1);
}

// Writes a header with a matching checksum, as an attacker or a bug of ours would.
void fix_checksum(Bytes& bytes) {
  const std::uint64_t of_header = checksum_bytes(std::span(bytes).first(kChecksumAt));
  const std::uint64_t sum = checksum_bytes(std::span(bytes).subspan(kHeaderBytes), of_header);
  std::memcpy(bytes.data() + kChecksumAt, &sum, sizeof(sum));
}

// The bytes of a file with another library, which save_library() need not accept.
Bytes with_content(Bytes file, const ModelLibrary& library) {
  const Bytes payload = internal::encode_payload(library).value();
  const std::uint64_t payload_bytes = payload.size();
  std::memcpy(file.data() + kPayloadBytesAt, &payload_bytes, sizeof(payload_bytes));
  file.resize(kHeaderBytes);
  file.insert(file.end(), payload.begin(), payload.end());
  fix_checksum(file);
  return file;
}

TEST_F(LibraryFile, EachKindOfDamageHasItsLine) {
  struct Case {
    const char* name;
    std::function<void(Bytes&)> damage;
    const char* expected;
  };
  const auto cut = [](std::size_t size) { return [size](Bytes& b) { b.resize(size); }; };
  const std::vector<Case> cases{
      {"empty file", cut(0), "not a model library"},
      {"text file", [](Bytes& b) { b = {'h', 'e', 'l', 'l', 'o', '\n'}; }, "not a model library"},
      {"wrong magic", [](Bytes& b) { b[7] = 'X'; }, "not a model library"},
      {"cut in the magic", cut(5), "truncated within its header"},
      {"cut in the header", cut(39), "truncated within its header"},
      {"no payload", cut(40), "truncated: 0 of"},
      {"cut in the payload", [](Bytes& b) { b.pop_back(); }, "truncated"},
      {"trailing garbage", [](Bytes& b) { b.push_back(0); }, "1 bytes too many"},
      {"other version", [](Bytes& b) { b[8] = 99; }, "format version 99 (expected 1); train again"},
      {"bit flip", [](Bytes& b) { b[b.size() / 2] ^= 4; }, "checksum"},
      {"bit flip in the options hash", [](Bytes& b) { b[16] ^= 1; }, "checksum"},
      {"bit flip in the checksum", [](Bytes& b) { b[kChecksumAt] ^= 1; }, "checksum"},
      {"endless size", [](Bytes& b) { std::memset(b.data() + 24, 0xFF, 8); }, "truncated"},
      {"size zero", [](Bytes& b) { std::memset(b.data() + 24, 0, 8); }, "bytes too many"},
      {"payload of zeros",
       [](Bytes& b) {
         std::fill(b.begin() + kHeaderBytes, b.end(), std::uint8_t{0});
         fix_checksum(b);
       },
       "damaged: "},
      {"payload of ones",
       [](Bytes& b) {
         std::fill(b.begin() + kHeaderBytes, b.end(), std::uint8_t{255});
         fix_checksum(b);
       },
       "not a model library"},
  };
  for (const Case& c : cases) {
    ASSERT_TRUE(save_library(make_library(), path_).ok());
    Bytes bytes = read();
    c.damage(bytes);
    write(bytes);
    const Result<ModelLibrary> loaded = load_library(path_);
    ASSERT_FALSE(loaded.ok()) << c.name;
    EXPECT_THAT(loaded.error().message, HasSubstr(c.expected)) << c.name;
    EXPECT_THAT(loaded.error().message, HasSubstr(path_.string())) << c.name;
    EXPECT_THAT(loaded.error().message, testing::Not(HasSubstr("\n"))) << c.name;
  }
}

// The test would run out of memory or time if such files were read before they are looked at.
TEST_F(LibraryFile, LooksAtTheHeaderBeforeItReadsTheRest) {
  write({});
  fs::resize_file(path_, std::uintmax_t{3} << 40);
  EXPECT_THAT(load_library(path_).error().message, HasSubstr("not a model library"));
  ASSERT_TRUE(save_library(make_library(), path_).ok());
  Bytes bytes = read();
  const std::uint64_t payload_bytes = std::uint64_t{3} << 40;
  std::memcpy(&bytes[kPayloadBytesAt], &payload_bytes, sizeof(payload_bytes));
  write(bytes);
  fs::resize_file(path_, kHeaderBytes + payload_bytes);
  EXPECT_THAT(load_library(path_).error().message, HasSubstr("more than a library can have"));
}

TEST_F(LibraryFile, RefusesMissingFilesFoldersAndStaleOptions) {
  EXPECT_THAT(load_library(path_).error().message, HasSubstr("no such file"));
  EXPECT_THAT(load_library(folder_).error().message, HasSubstr("not a file"));
  ASSERT_TRUE(save_library(make_library(), path_).ok());
  const Result<ModelLibrary> stale = load_library(path_, 1);
  ASSERT_FALSE(stale.ok());
  EXPECT_THAT(stale.error().message,
              HasSubstr("trained with other options (hash 123456789abcdef0, expected 0000000000000001)"));
}

// A valid checksum does not guarantee the meaning of the content.
TEST_F(LibraryFile, RefusesContentWithoutMeaning) {
  struct Case {
    std::function<void(ModelLibrary&)> spoil;
    const char* expected;
  };
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const std::vector<Case> cases{
      {[](ModelLibrary& l) { l.objects[1].name = "mug"; }, "two objects are named 'mug'"},
      {[](ModelLibrary& l) { l.objects[0].name.clear(); }, "name"},
      {[](ModelLibrary& l) { l.objects[0].bop_id = -1; }, "obj_id"},
      {[&](ModelLibrary& l) { l.objects[0].surface.points[3].y() = nan; }, "surface of object 'mug'"},
      {[](ModelLibrary& l) { l.objects[0].surface.normals[3] *= 2; }, "surface of object 'mug'"},
      {[](ModelLibrary& l) { l.objects[0].surface.colors.pop_back(); }, "surface of object 'mug'"},
      {[](ModelLibrary& l) { l.objects[0].sift.points.pop_back(); }, "SIFT features of object 'mug'"},
      {[](ModelLibrary& l) { l.objects[0].sift.dimension = 64; }, "SIFT features of object 'mug'"},
      {[](ModelLibrary& l) { l.objects[0].sift.codes.pop_back(); }, "SIFT features of object 'mug'"},
      {[](ModelLibrary& l) { std::fill_n(l.objects[0].shot.codes.begin(), 352, std::uint8_t{0}); },
       "SHOT features of object 'mug'"},
      {[](ModelLibrary& l) { l.objects[0].shot.normals.pop_back(); }, "SHOT features of object 'mug'"},
      {[](ModelLibrary& l) { l.objects[0].symmetries.discrete[0].rotation *= 1000; }, "symmetries"},
      {[](ModelLibrary& l) { l.objects[0].symmetries.continuous[0].direction.setZero(); }, "symmetries"},
      {[](ModelLibrary& l) { l.objects[0].shape_symmetries.discrete[0].rotation *= 1000; }, "shape symmetries"},
      {[](ModelLibrary& l) { l.objects[0].shape_symmetries.continuous[0].direction.setZero(); }, "shape symmetries"},
      // More motions than fit into the memory.
      {[](ModelLibrary& l) { l.objects[0].symmetries.continuous.resize(6); }, "symmetries"},
      {[](ModelLibrary& l) { l.objects[0].shape_symmetries.continuous.resize(6); }, "shape symmetries"},
      {[&](ModelLibrary& l) { l.objects[0].center.x() = nan; }, "centre"},
      {[&](ModelLibrary& l) { l.objects[0].diameter_m = nan; }, "diameter"},
      // Finite numbers that do not fit into the integers of pixels and voxels.
      {[](ModelLibrary& l) { l.objects[0].surface.points[3].y() = 1e12F; }, "surface of object 'mug'"},
      {[](ModelLibrary& l) { l.objects[0].sift.points[3].x() = -1e12F; }, "SIFT features of object 'mug'"},
      {[](ModelLibrary& l) { l.objects[0].symmetries.discrete[0].translation.x() = 1e12; }, "symmetries"},
      {[](ModelLibrary& l) { l.objects[0].symmetries.continuous[0].point.x() = 1e12; }, "symmetries"},
      {[](ModelLibrary& l) { l.objects[0].center.x() = 1e12F; }, "centre"},
      {[](ModelLibrary& l) { l.objects[0].diameter_m = 1e12F; }, "diameter"},
      // Views are cropped to the object: a wrong size would need all memory.
      {[](ModelLibrary& l) { l.objects[0].diameter_m = 40; }, "diameter"},
      {[](ModelLibrary& l) { l.objects[0].center.x() = 40; }, "diameter"},
      {[](ModelLibrary& l) { l.surface_voxel_m = 1e-12F; }, "voxel size"},
      {[](ModelLibrary& l) { l.objects[0].name = "../mug"; }, "'../mug'"},
      {[](ModelLibrary& l) { l.objects[0].name = "mug\x1b[2J"; }, "'mug\\x1b[2J'"},
      {[](ModelLibrary& l) { l.surface_voxel_m = 0; }, "voxel size"},
  };
  ASSERT_TRUE(save_library(make_library(), path_).ok());
  const Bytes good = read();
  for (const Case& c : cases) {
    ModelLibrary library = make_library();
    c.spoil(library);
    write(with_content(good, library));
    const Result<ModelLibrary> loaded = load_library(path_);
    ASSERT_FALSE(loaded.ok()) << c.expected;
    EXPECT_THAT(loaded.error().message, HasSubstr(c.expected));
    const Bytes before = read();
    const Result<void> saved = save_library(library, path_);
    ASSERT_FALSE(saved.ok()) << c.expected;
    EXPECT_THAT(saved.error().message, HasSubstr(c.expected));
    EXPECT_EQ(read(), before);
  }
}

TEST_F(LibraryFile, RefusesADescriptorOfZeros) {
  ModelLibrary library = make_library();
  std::ranges::fill(library.objects[0].sift.codes, std::uint8_t{255});
  ASSERT_TRUE(save_library(library, path_).ok());
  Bytes bytes = read();
  const Bytes row(128, 255);
  const auto found = std::search(bytes.begin(), bytes.end(), row.begin(), row.end());
  ASSERT_NE(found, bytes.end());
  std::fill(found, found + 128, std::uint8_t{0});
  fix_checksum(bytes);
  write(bytes);
  const Result<ModelLibrary> loaded = load_library(path_);
  ASSERT_FALSE(loaded.ok());
  EXPECT_THAT(loaded.error().message, HasSubstr("SIFT features of object 'mug'"));
}

TEST_F(LibraryFile, NoticesEveryBitFlip) {
  ASSERT_TRUE(save_library(make_library(), path_).ok());
  const Bytes original = read();
  Rng rng(2);
  for (int i = 0; i < 480; ++i) {
    Bytes bytes = original;
    const std::size_t at =
        i < 320 ? static_cast<std::size_t>(i) / 8 : rng.below(static_cast<std::uint32_t>(bytes.size()));
    bytes[at] ^= static_cast<std::uint8_t>(1U << (i % 8));
    write(bytes);
    const Result<ModelLibrary> loaded = load_library(path_);
    ASSERT_FALSE(loaded.ok()) << "bit " << i % 8 << " of byte " << at;
  }
}

TEST_F(LibraryFile, NoticesEveryTruncation) {
  ASSERT_TRUE(save_library(make_library(), path_).ok());
  const Bytes original = read();
  for (std::size_t size = 0; size < original.size(); size += size < 48 ? 1 : 97) {
    write(Bytes(original.begin(), original.begin() + static_cast<std::ptrdiff_t>(size)));
    ASSERT_FALSE(load_library(path_).ok()) << size;
  }
}

// Mutations with a matching checksum. They may pass (a changed colour is a valid colour) or fail, but a library that
// passes must be valid.
TEST_F(LibraryFile, SurvivesMaliciousContent) {
  ASSERT_TRUE(save_library(make_library(), path_).ok());
  const Bytes original = read();
  Rng rng(3);
  int refused = 0;
  for (int i = 0; i < 500; ++i) {
    Bytes bytes = original;
    for (int k = 0; k < 1 + i % 4; ++k) {
      // Half of the changes hit the tables (offsets and sizes) at both ends of the payload.
      const std::uint32_t range = i % 2 == 0 ? 300 : static_cast<std::uint32_t>(bytes.size() - kHeaderBytes);
      bytes[kHeaderBytes + rng.below(range)] = static_cast<std::uint8_t>(rng.below(3) == 0 ? 255 : rng.next());
    }
    fix_checksum(bytes);
    write(bytes);
    const Result<ModelLibrary> loaded = load_library(path_);
    refused += loaded.ok() ? 0 : 1;
    if (!loaded.ok()) continue;
    for (const ObjectModel& object : loaded->objects) {
      ASSERT_FALSE(object.name.empty());
      ASSERT_EQ(object.surface.colors.size(), object.surface.size());
      ASSERT_EQ(object.sift.codes.size(), object.sift.size() * 128);
      ASSERT_EQ(object.shot.codes.size(), object.shot.size() * 352);
    }
  }
  EXPECT_GT(refused, 100);
  EXPECT_LT(refused, 500);
}

}  // namespace
}  // namespace resight
