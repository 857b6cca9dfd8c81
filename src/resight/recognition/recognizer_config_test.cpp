// SPDX-License-Identifier: Apache-2.0
#include "resight/recognition/recognizer_config.hpp"

#include <gmock/gmock.h>

#include <cctype>
#include <fstream>
#include <map>
#include <set>

namespace resight {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::filesystem::path write_text(const std::string& text) {
  const auto path =
      std::filesystem::path(::testing::TempDir()) /
      (std::string("config_") + ::testing::UnitTest::GetInstance()->current_test_info()->name() + ".toml");
  std::ofstream(path) << text;
  return path;
}

// Stands for a value of any type; never evaluated.
struct AnyValue {
  template <typename T>
  operator T() const;  // NOLINT(google-explicit-constructor): to convert is what it is for
};

// The number of fields of an aggregate: as many values as it can be initialised with.
template <typename Aggregate, typename... Values>
consteval int num_fields() {
  if constexpr (requires { Aggregate{Values{}..., AnyValue{}}; })
    return num_fields<Aggregate, Values..., AnyValue>();
  else
    return sizeof...(Values);
}

// Names and values of settings as a TOML file. What is not a number, true or false is a word.
std::string to_toml(const std::pair<std::string, std::string>& setting) {
  const auto& [name, value] = setting;
  const bool is_word = std::isalpha(static_cast<unsigned char>(value[0])) != 0 && value != "true" && value != "false";
  return name + " = " + (is_word ? "\"" + value + "\"" : value) + "\n";
}

// Other values that a setting might take, some of which its rules will allow.
std::vector<std::string> other_values(const std::string& value) {
  for (const auto& [one, other] : {std::pair("true", "false"),
                                   {"geodesic", "absolute_euler"},
                                   {"spherical_bins", "depth_image"},
                                   {"beyond_best", "all_weights"}}) {
    if (value == one) return {other};
    if (value == other) return {one};
  }
  const double number = std::stod(value);
  std::vector<std::string> others;
  if (value.find_first_of(".e") == std::string::npos)
    others = {std::to_string(std::stoll(value) + 1), std::to_string(std::stoll(value) - 1)};
  others.push_back(std::to_string(0.9 * number));
  others.push_back("0.125");
  return others;
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
  for (const auto& setting : settings) {
    EXPECT_TRUE(names.insert(setting.first).second) << setting.first;
    if (setting.first != "preset") toml += to_toml(setting);
  }
  EXPECT_GT(names.size(), 80U);
  const auto read = read_config(write_text(toml), RecognizerConfig::from_preset("default"));
  ASSERT_TRUE(read.ok()) << read.error().message;
  auto again = read->to_settings();
  again[0] = settings[0];  // the preset's name
  EXPECT_EQ(again, settings);
}

// A field that is added to any options must be added to the list of settings, too.
TEST(RecognizerConfig, EveryFieldOfEveryOptionsIsASetting) {
  constexpr int kThreads = 1;
  constexpr int kPose = num_fields<EstimatePoseOptions>();
  const std::map<std::string, int> expected{
      {"", num_fields<RecognizerConfig>() - 15},  // the options of the stages
      {"attention", num_fields<SearchPlannerOptions>()},
      {"poses", num_fields<CorrectCameraOptions>() - 2 + num_fields<AlignmentViewOptions>() +
                    num_fields<AlignViewOptions>() - kThreads - 2},  // the prior is that of the poses
      {"prepare", num_fields<PrepareViewOptions>() - 2 - kThreads + num_fields<ComputeNormalsOptions>() - kThreads +
                      num_fields<DepthEdgeOptions>()},
      {"sift", num_fields<SiftOptions>()},
      {"shot", num_fields<ShotOptions>() - kThreads},
      {"match", num_fields<MatchFeaturesOptions>() - 2 + 2 * (num_fields<DescriptorIndexOptions>() - kThreads)},
      {"grouping",
       num_fields<GenerateHypothesesOptions>() - 1 - kThreads + num_fields<GroupCorrespondencesOptions>() - 1 + kPose},
      {"shape", num_fields<ShapeSearchOptions>() - 2 - kThreads + num_fields<SampleSceneOptions>() - kThreads +
                    num_fields<CountSamplesOptions>()},
      {"cluster", num_fields<ClusterHypothesesOptions>() - 1 - kThreads + kPose},
      {"changes", num_fields<DetectChangesOptions>() - kThreads - 1},  // the voxels are those of integrate
      {"removal", num_fields<RemovalSupportOptions>()},
      {"integrate", num_fields<IntegrateOptions>() - kThreads},
      {"score", num_fields<DetectionScoreOptions>()},
      {"history",
       num_fields<ObjectHistoryOptions>() - 2 + num_fields<PresenceOptions>() + num_fields<DepthHistoryOptions>()}};
  std::map<std::string, int> found;
  for (const auto& [name, value] : RecognizerConfig{}.to_settings())
    if (!name.starts_with("verify."))  // Declared beside its fields.
      ++found[name.substr(0, name.find('.') == std::string::npos ? 0 : name.find('.'))];
  EXPECT_EQ(found, expected);
}

// No two names for one field, and none that sets another's.
TEST(RecognizerConfig, EachSettingChangesItselfAlone) {
  const RecognizerConfig config;
  const auto settings = config.to_settings();
  for (std::size_t i = 1; i < settings.size(); ++i) {        // [0] is the preset's name
    if (settings[i].first.starts_with("verify.")) continue;  // Declared beside its fields.
    std::vector<std::string> changed;
    for (const std::string& other : other_values(settings[i].second)) {
      const auto read = read_config(write_text(to_toml({settings[i].first, other})), config);
      if (!read.ok()) continue;
      const auto now = read->to_settings();
      for (std::size_t k = 0; k < now.size(); ++k)
        if (now[k] != settings[k]) changed.push_back(now[k].first);
      break;
    }
    EXPECT_THAT(changed, ElementsAre(settings[i].first));
  }
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
  EXPECT_FALSE(read_config(::testing::TempDir(), {}).ok());
}

}  // namespace
}  // namespace resight
