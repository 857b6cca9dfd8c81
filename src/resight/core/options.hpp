// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "resight/core/field_count.hpp"

namespace resight {

/// The values that a number may take. NaN is in none.
struct OptionRange {
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
  bool excludes_min = false;

  [[nodiscard]] bool contains(double value) const {
    return (excludes_min ? value > min : value >= min) && value <= max;
  }
  /// "> 0", ">= 1", "in [0, 1]", ...
  [[nodiscard]] std::string rule() const;
};
[[nodiscard]] constexpr OptionRange any_number() { return {}; }
[[nodiscard]] constexpr OptionRange positive() { return {.min = 0, .excludes_min = true}; }
[[nodiscard]] constexpr OptionRange at_least(double min) { return {.min = min}; }
[[nodiscard]] constexpr OptionRange between(double min, double max) { return {.min = min, .max = max}; }
/// Cell sizes and search radii of grids of points: finer or wider ones would take all memory, or minutes.
[[nodiscard]] constexpr OptionRange grid_length_m() { return between(1e-4, 1); }

/// One value of an option that names its values.
struct OptionAlternative {
  std::string_view name;
  std::string_view doc;
};

/// An option that names its values: an enum, a variant, or whether an optional group is there. Borrows them.
struct OptionChoice {
  void* value = nullptr;
  int (*index)(const void*) = nullptr;
  void (*select)(void*, int) = nullptr;
  std::span<const OptionAlternative> alternatives;
};

/// Where the value of an option is kept. An empty optional number is written as "off".
using OptionPointer =
    std::variant<bool*, int*, std::uint64_t*, double*, std::optional<int>*, std::optional<double>*, OptionChoice>;

/// An option as it is declared. All texts are literals.
struct OptionDeclaration {
  std::string_view name;
  std::string_view doc;     ///< Meaning, and what happens at the extremes. Plain English, a sentence or two.
  std::string_view source;  ///< Paper, section or program that the default comes from; may be empty.
  OptionRange range{};
  OptionPointer pointer{};
};

/// What an options struct is made of. Each struct has one function `void declare(OptionVisitor&, Struct&)` beside it,
/// in its namespace, that names each of its fields once: check_options(), settings, settings files and docs/options.md
/// are all derived from it. Units are part of the names (_m, _rad, _px, _ms, _deg; none: a number or a share).
class OptionVisitor {
 public:
  OptionVisitor() = default;
  OptionVisitor(const OptionVisitor&) = delete;
  OptionVisitor& operator=(const OptionVisitor&) = delete;
  virtual ~OptionVisitor() = default;

  void field(std::string_view name, double& value, OptionRange range, std::string_view doc,
             std::string_view source = {}) {
    leaf({name, doc, source, range, &value});
  }
  void field(std::string_view name, int& value, OptionRange range, std::string_view doc, std::string_view source = {}) {
    leaf({name, doc, source, range, &value});
  }
  void field(std::string_view name, std::optional<double>& value, OptionRange range, std::string_view doc,
             std::string_view source = {}) {
    leaf({name, doc, source, range, &value});
  }
  void field(std::string_view name, std::optional<int>& value, OptionRange range, std::string_view doc,
             std::string_view source = {}) {
    leaf({name, doc, source, range, &value});
  }
  void field(std::string_view name, bool& value, std::string_view doc, std::string_view source = {}) {
    leaf({name, doc, source, {}, &value});
  }
  void field(std::string_view name, std::uint64_t& value, std::string_view doc, std::string_view source = {}) {
    leaf({name, doc, source, {}, &value});
  }
  /// Seeds and numbers of threads are set for all stages at once: they are no settings of a single stage.
  void seed(std::uint64_t& value) {
    ++num_declared_.back();
    visit_seed(value);
  }
  void num_threads(int& value) {
    ++num_declared_.back();
    visit_num_threads(value);
  }

  /// A field that is no option: the name of the whole.
  void label(const std::string& /*name*/) { ++num_declared_.back(); }

  /// An enum whose values are 0, 1, ... in the order of `alternatives`.
  template <typename Enum>
  void choice(std::string_view name, Enum& value, std::initializer_list<OptionAlternative> alternatives,
              std::string_view doc, std::string_view source = {}) {
    leaf({name,
          doc,
          source,
          {},
          OptionChoice{&value,
                       [](const void* v) { return static_cast<int>(*static_cast<const Enum*>(v)); },
                       [](void* v, int i) { *static_cast<Enum*>(v) = static_cast<Enum>(i); },
                       {alternatives.begin(), alternatives.size()}}});
  }

  /// A variant of options structs. Fields of the one that is chosen stand beside `name`; those of others have no
  /// effect.
  template <typename... Structs>
  void choice(std::string_view name, std::variant<Structs...>& value,
              std::initializer_list<OptionAlternative> alternatives, std::string_view doc,
              std::string_view source = {}) {
    using Variant = std::variant<Structs...>;
    leaf({name,
          doc,
          source,
          {},
          OptionChoice{
              &value,
              [](const void* v) { return static_cast<int>(static_cast<const Variant*>(v)->index()); },
              [](void* v, int i) { select_alternative(*static_cast<Variant*>(v), static_cast<std::size_t>(i)); },
              {alternatives.begin(), alternatives.size()}}});
    [&]<std::size_t... I>(std::index_sequence<I...>) {
      (visit_alternative<I>(name, value, alternatives.begin()[I].name), ...);
    }
    (std::index_sequence_for<Structs...>{});
  }

  /// A struct of options: a table of its own.
  template <typename Struct>
  void group(std::string_view name, Struct& options) {
    ++num_declared_.back();
    path_.push_back(name);
    visit_struct(options);
    path_.pop_back();
  }

  /// A struct whose options stand beside those of the struct that it is a part of.
  template <typename Struct>
  void merge(Struct& options) {
    ++num_declared_.back();
    visit_struct(options);
  }

  /// A group that may be missing, with a key "enabled": false if there is none.
  template <typename Struct>
  void group(std::string_view name, std::optional<Struct>& options, std::string_view doc,
             std::string_view source = {}) {
    static constexpr OptionAlternative kSwitch[] = {{"false", ""}, {"true", ""}};
    path_.push_back(name);
    leaf({"enabled",
          doc,
          source,
          {},
          OptionChoice{&options,
                       [](const void* v) { return static_cast<const std::optional<Struct>*>(v)->has_value() ? 1 : 0; },
                       [](void* v, int i) {
                         auto& option = *static_cast<std::optional<Struct>*>(v);
                         if (i == 0) option.reset();
                         if (i == 1 && !option) option.emplace();
                       },
                       kSwitch}});
    if (options) {
      visit_struct(*options);
    } else {
      Struct none{};
      only_if(false, "enabled", "true", [&] { visit_struct(none); });
    }
    path_.pop_back();
  }

  /// What `declare_fields` declares has an effect only if `key`, beside them, has that value.
  template <typename Declare>
  void only_if(bool has_effect, std::string_view key, std::string_view value, const Declare& declare_fields) {
    if (!has_effect) conditions_.push_back({path_.size(), key, value});
    declare_fields();
    if (!has_effect) conditions_.pop_back();
  }

  /// A rule that single fields cannot express: `message` completes "<name of the struct>: ...".
  void rule(bool holds, std::string_view message) {
    if (!holds && conditions_.empty()) broken_rule(message);
  }

  /// To start with. Calls declare().
  template <typename Struct>
  void visit_struct(Struct& options) {
    num_declared_.push_back(0);
    declare(*this, options);
    const int num_declared = num_declared_.back();
    num_declared_.pop_back();
    end_struct(num_declared, num_fields<Struct>());
  }

 protected:
  virtual void visit(const OptionDeclaration& option) = 0;
  virtual void visit_seed(std::uint64_t& /*seed*/) {}
  virtual void visit_num_threads(int& /*num_threads*/) {}
  virtual void broken_rule(std::string_view /*message*/) {}
  /// After each struct: a field that is not declared makes the numbers differ.
  virtual void end_struct(int /*num_declared*/, int /*num_fields*/) {}

  /// "verify.support.max_distance_m".
  [[nodiscard]] std::string key_of(std::string_view name) const;
  /// "verify.clutter.rule = continuation", or empty if the option has an effect.
  [[nodiscard]] std::string unmet_condition() const;
  [[nodiscard]] bool has_effect() const { return conditions_.empty(); }

 private:
  struct Condition {
    std::size_t depth;  // Of the path of its key.
    std::string_view key;
    std::string_view value;
  };

  void leaf(const OptionDeclaration& option) {
    ++num_declared_.back();
    visit(option);
  }

  template <typename... Structs>
  static void select_alternative(std::variant<Structs...>& value, std::size_t selected) {
    if (selected == value.index()) return;  // Keeps what its fields were set to.
    [&]<std::size_t... I>(std::index_sequence<I...>) {
      ((selected == I ? static_cast<void>(value.template emplace<I>()) : static_cast<void>(0)), ...);
    }
    (std::index_sequence_for<Structs...>{});
  }

  template <std::size_t I, typename... Structs>
  void visit_alternative(std::string_view key, std::variant<Structs...>& value, std::string_view alternative) {
    if (auto* chosen = std::get_if<I>(&value)) {
      visit_struct(*chosen);
    } else {
      std::variant_alternative_t<I, std::variant<Structs...>> none{};
      only_if(false, key, alternative, [&] { visit_struct(none); });
    }
  }

  std::vector<std::string_view> path_;
  std::vector<Condition> conditions_;
  std::vector<int> num_declared_{0};
};

/// One option of some options, as collected. `pointer` may be used only if the option has an effect.
struct Option {
  std::string key;
  std::string_view doc;
  std::string_view source;
  OptionRange range;
  OptionPointer pointer;
  std::vector<OptionAlternative> alternatives;  ///< Empty for numbers and switches.
  std::string value;                            ///< As text.
  std::string condition;                        ///< "key = value" without which it has no effect; empty: it has one.
};

/// Text of a value, as in settings and settings files (without the quotes of words).
[[nodiscard]] std::string option_text(const OptionPointer& pointer);

/// A value from a settings file.
using OptionValue = std::variant<bool, std::int64_t, double, std::string>;
/// Sets an option. Returns what was expected ("a number", ...) if the value does not fit, else an empty text. Ranges
/// are not checked.
[[nodiscard]] std::string assign_option(const Option& option, const OptionValue& value);

namespace internal {

class ListVisitor final : public OptionVisitor {
 public:
  std::vector<Option> options;

 protected:
  void visit(const OptionDeclaration& option) override;
};

class CheckVisitor final : public OptionVisitor {
 public:
  explicit CheckVisitor(std::string_view name) : name_(name) {}

 protected:
  void visit(const OptionDeclaration& option) override;
  void visit_num_threads(int& num_threads) override;
  void broken_rule(std::string_view message) override;

 private:
  [[nodiscard]] std::string full_name(std::string_view option) const;
  std::string_view name_;
};

class SeedVisitor final : public OptionVisitor {
 public:
  explicit SeedVisitor(std::uint64_t seed) : seed_(seed) {}

 protected:
  void visit(const OptionDeclaration& /*option*/) override {}
  void visit_seed(std::uint64_t& seed) override { seed = seed_; }

 private:
  std::uint64_t seed_;
};

class ThreadsVisitor final : public OptionVisitor {
 public:
  explicit ThreadsVisitor(int num_threads) : num_threads_(num_threads) {}

 protected:
  void visit(const OptionDeclaration& /*option*/) override {}
  void visit_num_threads(int& num_threads) override { num_threads = num_threads_; }

 private:
  int num_threads_;
};

}  // namespace internal

/// All settings in the order of their declaration, also those that have no effect. Valid while `options` is, and until
/// a choice is changed.
template <typename Struct>
[[nodiscard]] std::vector<Option> list_options(Struct& options) {
  internal::ListVisitor visitor;
  visitor.visit_struct(options);
  return std::move(visitor.options);
}

/// Throws std::invalid_argument, "name.key = value (must be rule)", for the first option that is out of its range.
template <typename Struct>
void check_options(std::string_view name, const Struct& options) {
  Struct copy = options;
  internal::CheckVisitor visitor(name);
  visitor.visit_struct(copy);
}

/// Sets every seed, and every number of threads, of all structs within.
template <typename Struct>
void set_all_seeds(Struct& options, std::uint64_t seed) {
  internal::SeedVisitor visitor(seed);
  visitor.visit_struct(options);
}
template <typename Struct>
void set_all_num_threads(Struct& options, int num_threads) {
  internal::ThreadsVisitor visitor(num_threads);
  visitor.visit_struct(options);
}

/// Key and value of all settings that have an effect.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> settings_of(std::span<const Option> options);

/// All values in order, separated by blanks; 0 where there is none. For hashes that must not change with names.
[[nodiscard]] std::string joined_values(std::span<const Option> options);

/// The known key that is most like an unknown one.
[[nodiscard]] std::string nearest_key(std::span<const Option> options, std::string_view unknown);

}  // namespace resight
