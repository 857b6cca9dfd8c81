// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <map>
#include <string>
#include <string_view>

namespace resight {

/// Splits the target of a request at "?", and the query into its pairs. Nothing is decoded: our own queries hold
/// numbers only. Of a key that occurs twice, the first value counts.
inline void split_target(std::string_view target, std::string& path, std::map<std::string, std::string>& query) {
  const std::size_t end = target.find('?');
  path = std::string(target.substr(0, end));
  std::string_view rest = end == target.npos ? std::string_view() : target.substr(end + 1);
  while (!rest.empty()) {
    const std::size_t pair_end = rest.find('&');
    const std::string_view pair = rest.substr(0, pair_end);
    const std::size_t equals = pair.find('=');
    query.emplace(pair.substr(0, equals), equals == pair.npos ? std::string_view() : pair.substr(equals + 1));
    rest.remove_prefix(pair_end == rest.npos ? rest.size() : pair_end + 1);
  }
}

}  // namespace resight
