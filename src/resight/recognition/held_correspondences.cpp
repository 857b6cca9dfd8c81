// SPDX-License-Identifier: Apache-2.0
#include "resight/recognition/held_correspondences.hpp"

#include <algorithm>
#include <utility>

namespace resight {

void HeldCorrespondences::add(int track, int view, std::vector<Correspondence> found) {
  std::deque<Search>& searches = searches_[track];
  searches.push_back({view, std::move(found)});
  if (searches.size() > max_searches_) searches.pop_front();
}

std::vector<Correspondence> HeldCorrespondences::of_views(int track, int first_view, int end_view) const {
  std::vector<Correspondence> all;
  const auto searches = searches_.find(track);
  if (searches == searches_.end()) return all;
  for (const Search& search : searches->second)
    if (search.view >= first_view && search.view < end_view)
      all.insert(all.end(), search.found.begin(), search.found.end());
  return all;
}

void HeldCorrespondences::keep_only(std::span<const int> tracks) {
  std::erase_if(searches_, [&](const auto& entry) { return std::ranges::find(tracks, entry.first) == tracks.end(); });
}

}  // namespace resight
