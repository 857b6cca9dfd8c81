// SPDX-License-Identifier: Apache-2.0
#include "resight/core/options.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <limits>
#include <stdexcept>

namespace resight {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Pair;

enum class Color : std::uint8_t { kRed, kBlue };

struct Soft {
  double give_m = 0.5;
};
void declare(OptionVisitor& v, Soft& o) { v.field("give_m", o.give_m, positive(), "How far it gives."); }

struct Hard {};
void declare(OptionVisitor& /*v*/, Hard& /*o*/) {}

struct Wheel {
  int num_spokes = 8;
  std::variant<Soft, Hard> tyre{};
  std::uint64_t seed = 1;
  int num_threads = 1;
};
void declare(OptionVisitor& v, Wheel& o) {
  v.field("num_spokes", o.num_spokes, between(3, 100), "Spokes.");
  v.choice("tyre", o.tyre, {{"soft", ""}, {"hard", ""}}, "Tyre.");
  v.seed(o.seed);
  v.num_threads(o.num_threads);
}

struct Cart {
  Wheel wheel{};
  std::optional<Wheel> spare{};
  Color color = Color::kRed;
  bool has_bell = true;
  std::optional<double> load_kg{};
  std::optional<int> num_seats = 2;
};
void declare(OptionVisitor& v, Cart& o) {
  v.group("wheel", o.wheel);
  v.group("spare", o.spare, "Whether there is another wheel.");
  v.choice("color", o.color, {{"red", ""}, {"blue", ""}}, "Colour.");
  v.field("has_bell", o.has_bell, "Whether it rings.");
  v.only_if(o.has_bell, "has_bell", "true", [&] { v.field("load_kg", o.load_kg, positive(), "Load.", "our own"); });
  v.field("num_seats", o.num_seats, at_least(1), "Seats.");
  v.rule(!o.spare || o.spare->num_spokes == o.wheel.num_spokes, "both wheels must have as many spokes");
}

// Forgets one of its fields.
struct Forgetful {
  double told = 0;
  double forgotten = 0;
};
void declare(OptionVisitor& v, Forgetful& o) { v.field("told", o.told, any_number(), ""); }

class FieldCounter final : public OptionVisitor {
 public:
  int num_missing = 0;

 protected:
  void visit(const OptionDeclaration& /*option*/) override {}
  void end_struct(int num_declared, int num_fields) override { num_missing += num_fields - num_declared; }
};

template <typename Struct>
int num_missing_fields(Struct options = {}) {
  FieldCounter counter;
  counter.visit_struct(options);
  return counter.num_missing;
}

std::string error_of(const Cart& cart, std::string_view name = "cart") {
  try {
    check_options(name, cart);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

const Option& find(const std::vector<Option>& options, std::string_view key) {
  return *std::ranges::find(options, key, &Option::key);
}

TEST(NumFields, CountsTheFieldsOfAggregates) {
  EXPECT_EQ(num_fields<Hard>(), 0);
  EXPECT_EQ(num_fields<Soft>(), 1);
  EXPECT_EQ(num_fields<Wheel>(), 4);
  EXPECT_EQ(num_fields<Cart>(), 6);
}

TEST(OptionVisitor, ReportsFieldsThatAreNotDeclared) {
  EXPECT_EQ(num_missing_fields<Cart>(), 0);
  EXPECT_EQ(num_missing_fields<Cart>({.spare = Wheel{.tyre = Hard{}}}), 0);
  EXPECT_EQ(num_missing_fields<Forgetful>(), 1);
}

TEST(ListOptions, SettingsAreWhatHasAnEffect) {
  Cart cart;
  EXPECT_THAT(settings_of(list_options(cart)),
              ElementsAre(Pair("wheel.num_spokes", "8"), Pair("wheel.tyre", "soft"), Pair("wheel.give_m", "0.5"),
                          Pair("spare.enabled", "false"), Pair("color", "red"), Pair("has_bell", "true"),
                          Pair("load_kg", "off"), Pair("num_seats", "2")));
  cart = {.wheel = {.tyre = Hard{}}, .spare = Wheel{}, .has_bell = false, .num_seats = {}};
  EXPECT_THAT(settings_of(list_options(cart)),
              ElementsAre(Pair("wheel.num_spokes", "8"), Pair("wheel.tyre", "hard"), Pair("spare.enabled", "true"),
                          Pair("spare.num_spokes", "8"), Pair("spare.tyre", "soft"), Pair("spare.give_m", "0.5"),
                          Pair("color", "red"), Pair("has_bell", "false"), Pair("num_seats", "off")));
}

TEST(ListOptions, NamesWhatAnOptionNeedsToHaveAnEffect) {
  Cart cart{.wheel = {.tyre = Hard{}}, .has_bell = false};
  const std::vector<Option> options = list_options(cart);
  EXPECT_EQ(find(options, "wheel.give_m").condition, "wheel.tyre = soft");
  EXPECT_EQ(find(options, "spare.num_spokes").condition, "spare.enabled = true");
  EXPECT_EQ(find(options, "load_kg").condition, "has_bell = true");
  EXPECT_EQ(find(options, "load_kg").source, "our own");
  EXPECT_EQ(find(options, "color").condition, "");
}

TEST(CheckOptions, NamesKeyValueAndRule) {
  EXPECT_EQ(error_of({}), "");
  EXPECT_EQ(error_of({.wheel = {.num_spokes = 2}}), "cart.wheel.num_spokes = 2 (must be in [3, 100])");
  EXPECT_EQ(error_of({.load_kg = -1}), "cart.load_kg = -1 (must be > 0)");
  EXPECT_EQ(error_of({.load_kg = -1}, ""), "load_kg = -1 (must be > 0)");
  EXPECT_EQ(error_of({.wheel = {.tyre = Soft{std::numeric_limits<double>::quiet_NaN()}}}),
            "cart.wheel.give_m = nan (must be > 0)");
  EXPECT_EQ(error_of({.num_seats = 0}), "cart.num_seats = 0 (must be >= 1)");
  EXPECT_EQ(error_of({.wheel = {.num_threads = 0}}), "cart.wheel.num_threads = 0 (must be >= 1)");
  EXPECT_EQ(error_of({.spare = Wheel{.num_spokes = 9}}), "cart: both wheels must have as many spokes");
}

TEST(AssignOption, TakesValuesThatFitAndNamesWhatWasExpected) {
  Cart cart;
  const auto assign = [&](std::string_view key, const OptionValue& value) {
    return assign_option(find(list_options(cart), key), value);
  };
  EXPECT_EQ(assign("wheel.num_spokes", std::int64_t{12}), "");
  EXPECT_EQ(cart.wheel.num_spokes, 12);
  EXPECT_EQ(assign("wheel.num_spokes", 12.5), "a whole number");
  EXPECT_EQ(assign("wheel.give_m", std::int64_t{2}), "");
  EXPECT_EQ(std::get<Soft>(cart.wheel.tyre).give_m, 2);
  EXPECT_EQ(assign("wheel.tyre", std::string("soft")), "");
  EXPECT_EQ(std::get<Soft>(cart.wheel.tyre).give_m, 2) << "what was chosen already keeps its values";
  EXPECT_EQ(assign("wheel.tyre", std::string("hard")), "");
  EXPECT_TRUE(std::holds_alternative<Hard>(cart.wheel.tyre));
  EXPECT_EQ(assign("wheel.tyre", std::string("flat")), "one of \"soft\", \"hard\"");
  EXPECT_EQ(assign("spare.enabled", true), "");
  EXPECT_TRUE(cart.spare.has_value());
  EXPECT_EQ(assign("spare.enabled", std::int64_t{1}), "true or false");
  EXPECT_EQ(assign("spare.enabled", false), "");
  EXPECT_FALSE(cart.spare.has_value());
  EXPECT_EQ(assign("color", std::string("blue")), "");
  EXPECT_EQ(cart.color, Color::kBlue);
  EXPECT_EQ(assign("load_kg", 3.5), "");
  EXPECT_EQ(cart.load_kg, 3.5);
  EXPECT_EQ(assign("load_kg", std::string("off")), "");
  EXPECT_EQ(cart.load_kg, std::nullopt);
  EXPECT_EQ(assign("load_kg", std::string("heavy")), "a number or \"off\"");
  EXPECT_EQ(assign("num_seats", 1.5), "a whole number or \"off\"");
  EXPECT_EQ(assign("has_bell", std::string("yes")), "true or false");
}

TEST(AllAtOnce, SeedsAndThreadsReachEveryStruct) {
  Cart cart{.spare = Wheel{}};
  set_all_seeds(cart, 7);
  set_all_num_threads(cart, 3);
  for (const Wheel& wheel : {cart.wheel, *cart.spare}) {
    EXPECT_EQ(wheel.seed, 7U);
    EXPECT_EQ(wheel.num_threads, 3);
  }
}

TEST(NearestKey, PrefersTheSameLastPart) {
  Cart cart;
  const std::vector<Option> options = list_options(cart);
  EXPECT_EQ(nearest_key(options, "wheel.num_spoke"), "wheel.num_spokes");
  EXPECT_EQ(nearest_key(options, "bell"), "has_bell");
  EXPECT_EQ(nearest_key(options, "whole.num_spokes"), "wheel.num_spokes");
  EXPECT_EQ(nearest_key({}, "x"), "");
}

TEST(JoinedValues, AreSeparatedByBlanksWithZeroForNone) {
  Cart cart{.wheel = {.tyre = Soft{100000}}, .num_seats = {}};
  EXPECT_EQ(joined_values(list_options(cart.wheel)), "8 soft 100000");
  EXPECT_THAT(joined_values(list_options(cart)), HasSubstr("true 0 0"));
}

}  // namespace
}  // namespace resight
