// SPDX-License-Identifier: Apache-2.0
#include "resight/recognition/recognizer_config.hpp"

#include <gmock/gmock.h>

#include <fstream>
#include <set>

namespace resight {
namespace {

using ::testing::HasSubstr;

std::filesystem::path write_text(const std::string& text) {
  const auto path =
      std::filesystem::path(::testing::TempDir()) /
      (std::string("config_") + ::testing::UnitTest::GetInstance()->current_test_info()->name() + ".toml");
  std::ofstream(path) << text;
  return path;
}

TEST(RecognizerConfig, PresetsDifferWhereTheyShould) {
  const auto mvr = RecognizerConfig::from_preset("mvr");
  const auto chd = RecognizerConfig::from_preset("mvr-chd");
  EXPECT_FALSE(mvr.detect_changes);
  EXPECT_TRUE(chd.detect_changes);
  EXPECT_EQ(chd.changes.occlusion_test, OcclusionTest::kSphericalBins);
  EXPECT_NO_THROW(RecognizerConfig::from_preset("default").check());
  EXPECT_THROW((void)RecognizerConfig::from_preset("best"), std::invalid_argument);
}

TEST(RecognizerConfig, SettingsHaveUniqueNamesAndReadBackAsTheyAre) {
  const auto settings = RecognizerConfig::from_preset("mvr-chd").to_settings();
  std::set<std::string> names;
  std::string toml;
  for (const auto& [name, value] : settings) {
    EXPECT_TRUE(names.insert(name).second) << name;
    if (name == "preset") continue;
    const bool is_word = value == "geodesic" || value == "spherical_bins";
    toml += name + " = " + (is_word ? "\"" + value + "\"" : value) + "\n";
  }
  EXPECT_GT(names.size(), 80U);
  const auto read = read_config(write_text(toml), RecognizerConfig::from_preset("default"));
  ASSERT_TRUE(read.ok()) << read.error().message;
  auto again = read->to_settings();
  again[0] = settings[0];  // the preset's name
  EXPECT_EQ(again, settings);
}

TEST(RecognizerConfig, AFileOverwritesSingleFields) {
  const auto read = read_config(
      write_text("num_previous_views = 2\n[changes]\ntolerance_m = 0.01\nocclusion_test = \"depth_image\"\n"),
      RecognizerConfig::from_preset("mvr-chd"));
  ASSERT_TRUE(read.ok()) << read.error().message;
  EXPECT_EQ(read->num_previous_views, 2);
  EXPECT_DOUBLE_EQ(read->changes.tolerance_m, 0.01);
  EXPECT_EQ(read->changes.occlusion_test, OcclusionTest::kDepthImage);
}

TEST(RecognizerConfig, BadFilesNameTheKeyAndTheRule) {
  struct Case {
    const char* text;
    const char* expected;
  };
  for (const Case& c :
       {Case{"[changes]\ntolerance = 1.0\n", "unknown key changes.tolerance"}, Case{"speed = 3\n", "unknown key speed"},
        Case{"num_previous_views = \"two\"\n", "must be a whole number"},
        Case{"num_previous_views = 2.5\n", "must be a whole number"},
        Case{"[changes]\ntolerance_m = -1.0\n", "tolerance_m = -1"},
        Case{"[changes]\ntolerance_m = nan\n", "tolerance_m = nan"},
        Case{"[cluster]\nrotation_test = \"euler\"\n", "\"absolute_euler\""},
        Case{"[sift]\nroot_sift = 1\n", "true or false"}, Case{"[changes\n", "line 1"}}) {
    const auto read = read_config(write_text(c.text), RecognizerConfig::from_preset("default"));
    ASSERT_FALSE(read.ok()) << c.text;
    EXPECT_THAT(read.error().message, HasSubstr(c.expected));
    EXPECT_THAT(read.error().message, HasSubstr(".toml"));
  }
  EXPECT_FALSE(read_config("/nonexistent/x.toml", {}).ok());
}

}  // namespace
}  // namespace resight
