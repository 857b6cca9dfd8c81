// SPDX-License-Identifier: Apache-2.0
#include "resight/io/tuw_changes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <tuple>

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

}  // namespace

Result<std::vector<ChangeChain>> parse_changes(std::string_view text, std::string_view name) {
  std::vector<ChangeChain> chains;
  std::set<std::tuple<int, std::string, int>> seen;
  for (int number = 1; !text.empty(); ++number) {
    const auto fail = [&](std::string_view what) { return Error{fmt::format("{}: line {}: {}", name, number, what)}; };
    ChangeChain chain;
    for (const std::string_view word : io::split_tokens(io::cut_line(text))) {
      auto entry = parse_entry(word);
      if (!entry) return fail("expected names like cloud_03_mug_0.txt");
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

Result<void> write_changes(const std::filesystem::path& file, std::vector<ChangeChain> chains) {
  for (const ChangeChain& chain : chains) require(!chain.entries.empty(), "write_changes: a chain is empty");
  std::ranges::stable_sort(chains,
                           [](const ChangeChain& a, const ChangeChain& b) { return order_of(a) < order_of(b); });
  std::string text;
  for (const ChangeChain& chain : chains)
    for (std::size_t i = 0; i < chain.entries.size(); ++i) {
      const ChangeChainEntry& e = chain.entries[i];
      text += fmt::format("{}{}_{}_{}.txt{}", i > 0 ? " " : "", e.view, e.object, e.instance,
                          i + 1 == chain.entries.size() ? "\n" : "");
    }
  return io::write_file(file, text);
}

}  // namespace resight
