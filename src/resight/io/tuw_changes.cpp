// SPDX-License-Identifier: Apache-2.0
#include "resight/io/tuw_changes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <tuple>

#include "resight/core/check.hpp"
#include "resight/core/names.hpp"
#include "resight/io/internal/files.hpp"
#include "resight/io/internal/text.hpp"
#include "resight/io/internal/tuw_names.hpp"

namespace resight {
namespace {

std::optional<ChangeChainEntry> parse_entry(std::string_view word) {
  if (word.ends_with(".txt")) word.remove_suffix(4);
  auto name = io::split_annotation_name(word);
  if (!name) return std::nullopt;
  return ChangeChainEntry{std::move(name->view), name->view_number, std::move(name->what.object), name->what.instance};
}

auto order_of(const ChangeChain& chain) {
  const ChangeChainEntry& first = chain.entries.front();
  return std::tie(first.object, first.view_number, first.instance);
}

std::string file_name_of(const ChangeChainEntry& entry) {
  return fmt::format("{}_{}_{}.txt", entry.view, entry.object, entry.instance);
}

/// Index of each view by its name without leading zeros, and by its number; -1 if several views have it.
class ViewIndex {
 public:
  explicit ViewIndex(const std::vector<std::string>& views) {
    for (std::size_t i = 0; i < views.size(); ++i) {
      add(by_name_, io::normalized_view(views[i]), static_cast<int>(i));
      if (const auto number = io::trailing_number(views[i])) add(by_number_, *number, static_cast<int>(i));
    }
  }
  [[nodiscard]] std::optional<int> find(const ChangeChainEntry& entry) const {
    if (const auto it = by_name_.find(io::normalized_view(entry.view)); it != by_name_.end()) return it->second;
    if (const auto it = by_number_.find(entry.view_number); it != by_number_.end()) return it->second;
    return std::nullopt;
  }

 private:
  template <typename Key>
  static void add(std::map<Key, int>& index, const Key& key, int view) {
    if (const auto [it, is_new] = index.try_emplace(key, view); !is_new) it->second = -1;
  }
  std::map<std::string, int> by_name_;
  std::map<int, int> by_number_;
};

}  // namespace

Result<std::vector<ObjectPlacement>> resolve_changes(const std::vector<ChangeChain>& chains,
                                                     const std::vector<std::string>& views, std::string_view name) {
  const ViewIndex index(views);
  std::vector<ObjectPlacement> placements;
  for (const ChangeChain& chain : chains) {
    require(!chain.entries.empty(), "resolve_changes: a chain is empty");
    ObjectPlacement placement{chain.entries.front().object, {}};
    for (const ChangeChainEntry& entry : chain.entries) {
      const auto fail = [&](std::string_view what) {
        return Error{fmt::format("{}: {}: {}", name, file_name_of(entry), what)};
      };
      const auto view = index.find(entry);
      if (!view) return fail("the sequence has no such view");
      if (*view < 0) return fail("several views of the sequence have this number");
      if (!placement.entries.empty() && placement.entries.back().view >= *view)
        return fail("its view does not come after that of the annotation before it");
      placement.entries.push_back({*view, entry.instance});
    }
    placements.push_back(std::move(placement));
  }
  return placements;
}

std::vector<ChangeChain> name_placements(const std::vector<ObjectPlacement>& placements,
                                         const std::vector<std::string>& views) {
  std::vector<ChangeChain> chains;
  for (const ObjectPlacement& placement : placements) {
    ChangeChain& chain = chains.emplace_back();
    for (const auto& [view, instance] : placement.entries) {
      const std::string& name = views.at(static_cast<std::size_t>(view));
      chain.entries.push_back({name, io::trailing_number(name).value_or(view), placement.object, instance});
    }
  }
  return chains;
}

Result<std::vector<ChangeChain>> parse_changes(std::string_view text, std::string_view name) {
  std::vector<ChangeChain> chains;
  std::set<std::tuple<int, std::string, int>> seen;
  for (int number = 1; !text.empty(); ++number) {
    const auto fail = [&](std::string_view what) { return Error{fmt::format("{}: line {}: {}", name, number, what)}; };
    ChangeChain chain;
    for (const std::string_view word : io::split_tokens(io::cut_line(text))) {
      auto entry = parse_entry(word);
      if (!entry) return fail("expected names like cloud_03_mug_0.txt");
      if (const auto valid = check_object_name(entry->object); !valid) return fail(valid.error().message);
      if (!chain.entries.empty() && chain.entries.back().object != entry->object)
        return fail("a chain of two different objects");
      if (!chain.entries.empty() && chain.entries.back().view_number >= entry->view_number)
        return fail("its views do not ascend");
      if (!seen.emplace(entry->view_number, entry->object, entry->instance).second)
        return fail("an annotation that another chain has, too");
      chain.entries.push_back(std::move(*entry));
    }
    if (!chain.entries.empty()) chains.push_back(std::move(chain));
  }
  return chains;
}

Result<std::vector<ChangeChain>> read_changes(const std::filesystem::path& file) {
  const auto text = io::read_file(file);
  if (!text) return text.error();
  return parse_changes(*text, file.string());
}

std::string format_changes(std::vector<ChangeChain> chains) {
  for (const ChangeChain& chain : chains) require(!chain.entries.empty(), "format_changes: a chain is empty");
  std::ranges::stable_sort(chains,
                           [](const ChangeChain& a, const ChangeChain& b) { return order_of(a) < order_of(b); });
  std::string text;
  for (const ChangeChain& chain : chains) {
    for (std::size_t i = 0; i < chain.entries.size(); ++i) {
      if (i > 0) text += ' ';
      text += file_name_of(chain.entries[i]);
    }
    text += '\n';
  }
  return text;
}

Result<void> write_changes(const std::filesystem::path& file, std::vector<ChangeChain> chains) {
  return io::write_file(file, format_changes(std::move(chains)));
}

}  // namespace resight
