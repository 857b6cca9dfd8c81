// SPDX-License-Identifier: Apache-2.0
#include "resight/recognition/recognizer_config.hpp"

#include <gmock/gmock.h>

#include <set>

#include "resight/recognition/options_reference.hpp"

namespace resight {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr const char* kPresets[] = {"mvr", "mvr-chd", "default"};

// Finds structs of which a field is not declared.
class FieldCounter final : public OptionVisitor {
 public:
  std::vector<std::string> incomplete;
  int num_structs = 0;

 protected:
  void visit(const OptionDeclaration& /*option*/) override {}
  void end_struct(int num_declared, int num_fields) override {
    ++num_structs;
    if (num_declared != num_fields) incomplete.push_back(key_of("*"));
  }
};

// Other values that an option might take. Its rules allow some of them.
std::vector<OptionValue> other_values(const Option& option) {
  std::vector<OptionValue> others;
  for (const OptionAlternative& alternative : option.alternatives) {
    if (alternative.name == option.value) continue;
    others.emplace_back(std::string(alternative.name));
    others.emplace_back(alternative.name == "true");
  }
  if (std::holds_alternative<bool*>(option.pointer)) others.emplace_back(option.value != "true");
  if (!others.empty()) return others;
  for (const double number : {0.125, 0.75, 1.5}) others.emplace_back(number);
  for (const std::int64_t number : {7, 11}) others.emplace_back(number);
  return others;
}

TEST(RecognizerConfig, PresetsDifferWhereTheyShould) {
  const auto mvr = RecognizerConfig::from_preset("mvr");
  const auto chd = RecognizerConfig::from_preset("mvr-chd");
  EXPECT_FALSE(mvr.changes.enabled);
  EXPECT_TRUE(chd.changes.enabled);
  EXPECT_TRUE(std::holds_alternative<PointTestOptions>(chd.changes.detection.test));
  for (const char* preset : kPresets) EXPECT_NO_THROW(RecognizerConfig::from_preset(preset).check()) << preset;
  EXPECT_THROW((void)RecognizerConfig::from_preset("best"), std::invalid_argument);
}

TEST(RecognizerConfig, EveryFieldOfEveryOptionsIsDeclared) {
  for (const char* preset : kPresets) {
    RecognizerConfig config = RecognizerConfig::from_preset(preset);
    FieldCounter counter;
    counter.visit_struct(config);
    EXPECT_THAT(counter.incomplete, ElementsAre()) << preset;
    EXPECT_GT(counter.num_structs, 30);
  }
}

TEST(RecognizerConfig, KeysAreUnique) {
  RecognizerConfig config;
  std::set<std::string> keys;
  for (const Option& option : list_options(config)) EXPECT_TRUE(keys.insert(option.key).second) << option.key;
  EXPECT_GT(keys.size(), 100U);
}

// No two keys of one field, and none that sets another's.
TEST(RecognizerConfig, EachOptionChangesItselfAlone) {
  const RecognizerConfig config = RecognizerConfig::from_preset("default");
  RecognizerConfig first = config;
  const std::vector<Option> before = list_options(first);
  for (std::size_t i = 0; i < before.size(); ++i) {
    if (!before[i].condition.empty()) continue;
    bool was_changed = false;
    for (const OptionValue& other : other_values(before[i])) {
      RecognizerConfig changed = config;
      if (!assign_option(list_options(changed)[i], other).empty()) continue;
      const std::vector<Option> after = list_options(changed);
      if (after[i].value == before[i].value) continue;
      was_changed = true;
      // Options that come into effect, or lose it, depend on this one.
      for (std::size_t k = 0; k < before.size(); ++k)
        if (k != i && before[k].condition == after[k].condition) {
          EXPECT_EQ(before[k].value, after[k].value);
        }
    }
    EXPECT_TRUE(was_changed) << before[i].key;
  }
}

TEST(RecognizerConfig, SeedAndThreadsReachAllStages) {
  RecognizerConfig config = RecognizerConfig::from_preset("default");
  config.set_seed(7);
  config.set_num_threads(3);
  EXPECT_EQ(config.run.seed, 7U);
  EXPECT_EQ(config.verify.seed, 7U);
  EXPECT_EQ(config.features.match.shot_index.seed, 7U);
  EXPECT_EQ(config.hypotheses.generate.grouping.pose.seed, 7U);
  EXPECT_EQ(config.verify.num_threads, 3);
  EXPECT_EQ(config.prepare.normals.num_threads, 3);
  EXPECT_EQ(config.changes.detection.num_threads, 3);
  EXPECT_EQ(config.hypotheses.cluster->num_threads, 3);
  EXPECT_THROW(config.set_num_threads(0), std::invalid_argument);
}

TEST(RecognizerConfig, RefusesCombinationsWithoutEffect) {
  RecognizerConfig config = RecognizerConfig::from_preset("default");
  config.remember_objects = false;
  EXPECT_THROW(config.check(), std::invalid_argument) << "searches fewer views, but remembers no object";
  config.search = {};
  EXPECT_NO_THROW(config.check());
  config.verify.clutter.rule = SegmentClutter{};
  EXPECT_THROW(config.check(), std::invalid_argument) << "planes without segments, which this rule needs";
  config.verify.planes->spacing_m.reset();
  EXPECT_NO_THROW(config.check());
  config.integrate.min_edge_distance_px = 5.5;
  EXPECT_THROW(config.check(), std::invalid_argument) << "no point is integrated";
}

TEST(OptionsReference, NamesEveryOptionWithItsValues) {
  const std::string text = options_reference();
  RecognizerConfig config;
  for (const Option& option : list_options(config)) {
    EXPECT_THAT(text, HasSubstr("| `" + option.key + "` |"));
    EXPECT_FALSE(option.doc.empty()) << option.key;
  }
  EXPECT_THAT(text, HasSubstr("| `verify.clutter.max_offset_m` | m | > 0 | – | – | 0.005 |"));
  EXPECT_THAT(text, HasSubstr("Only with `verify.clutter.rule = continuation`."));
}

}  // namespace
}  // namespace resight
