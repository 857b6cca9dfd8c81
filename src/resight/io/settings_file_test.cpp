// SPDX-License-Identifier: Apache-2.0
#include "resight/io/settings_file.hpp"

#include <gmock/gmock.h>

#include "resight/io/internal/test_data.hpp"

namespace resight {
namespace {

using ::testing::HasSubstr;

struct Sail {
  double area_m = 4;
};
void declare(OptionVisitor& v, Sail& o) { v.field("area_m", o.area_m, positive(), ""); }

struct Engine {
  int num_cylinders = 2;
};
void declare(OptionVisitor& v, Engine& o) { v.field("num_cylinders", o.num_cylinders, between(1, 16), ""); }

struct Anchor {
  double weight = 10;
};
void declare(OptionVisitor& v, Anchor& o) { v.field("weight", o.weight, positive(), ""); }

struct Boat {
  double length_m = 5;
  std::variant<Sail, Engine> drive{};
  std::optional<Anchor> anchor{};
  void check() const { check_options("", *this); }
};
void declare(OptionVisitor& v, Boat& o) {
  v.field("length_m", o.length_m, positive(), "");
  v.choice("drive", o.drive, {{"sail", ""}, {"engine", ""}}, "");
  v.group("anchor", o.anchor, "");
}

class ReadSettings : public testing::Test {
 protected:
  static Result<Boat> read(const std::string& text, const Boat& boat = {}) {
    const io::TestDirectory directory;
    io::write_text(directory / "settings.toml", text);
    return read_settings(directory / "settings.toml", boat);
  }
  static std::string error_of(const std::string& text) {
    const Result<Boat> boat = read(text);
    return boat.ok() ? "" : boat.error().message;
  }
};

TEST_F(ReadSettings, OverwritesWhatTheFileNames) {
  const Result<Boat> boat = read("length_m = 7");
  ASSERT_TRUE(boat.ok());
  EXPECT_EQ(boat->length_m, 7);
  EXPECT_EQ(std::get<Sail>(boat->drive).area_m, 4);
}

TEST_F(ReadSettings, ChoicesComeIntoEffectWhateverTheOrder) {
  const Result<Boat> boat = read("num_cylinders = 4\ndrive = \"engine\"\n[anchor]\nweight = 3\nenabled = true\n");
  ASSERT_TRUE(boat.ok()) << boat.error().message;
  EXPECT_EQ(std::get<Engine>(boat->drive).num_cylinders, 4);
  ASSERT_TRUE(boat->anchor.has_value());
  EXPECT_EQ(boat->anchor->weight, 3);
}

TEST_F(ReadSettings, RefusesOptionsWithoutEffect) {
  EXPECT_THAT(error_of("num_cylinders = 4"), HasSubstr("num_cylinders has no effect unless drive = engine"));
  EXPECT_THAT(error_of("drive = \"engine\"\narea_m = 4"), HasSubstr("area_m has no effect unless drive = sail"));
  EXPECT_THAT(error_of("[anchor]\nweight = 4"), HasSubstr("anchor.weight has no effect unless anchor.enabled = true"));
}

TEST_F(ReadSettings, NamesFileKeyAndRule) {
  EXPECT_THAT(error_of("length = 7"), HasSubstr("unknown key length (did you mean length_m?)"));
  EXPECT_THAT(error_of("length_m = \"long\""), HasSubstr("length_m must be a number"));
  EXPECT_THAT(error_of("length_m = [1]"), HasSubstr("length_m must be a number"));
  EXPECT_THAT(error_of("length_m = inf"), HasSubstr("length_m must be a number"));
  EXPECT_THAT(error_of("length_m = -7"), HasSubstr("length_m = -7 (must be > 0)"));
  EXPECT_THAT(error_of("drive = \"oars\""), HasSubstr("one of \"sail\", \"engine\""));
  EXPECT_THAT(error_of("length_m = 7\n[anchor"), HasSubstr("line 2"));
  EXPECT_THAT(error_of("[anchor\n"), HasSubstr(".toml: "));
}

TEST_F(ReadSettings, FilesThatCannotBeReadAreErrors) {
  EXPECT_FALSE(read_settings("/nonexistent/x.toml", Boat{}).ok());
  EXPECT_FALSE(read_settings(testing::TempDir(), Boat{}).ok());
}

}  // namespace
}  // namespace resight
