// SPDX-License-Identifier: Apache-2.0
#include "resight/recognition/track_correspondences.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include "resight/hypotheses/clustering.hpp"

namespace resight {

bool TrackCorrespondences::agrees(const Correspondence& c, const Rigid3& world_from_object) const {
  return (world_from_object * c.model_point.cast<double>().eval() - c.scene_point.cast<double>()).norm() <=
         max_distance_m_;
}

void TrackCorrespondences::add(int track, int view, std::span<const Hypothesis> found, const Rigid3& world_from_object,
                               const ObjectSymmetries& symmetries) {
  Search search{view, {}};
  for (const Hypothesis& h : found)
    append_correspondences(search.found, h, nearest_symmetric_pose(h.world_from_object, world_from_object, symmetries));
  std::erase_if(search.found, [&](const Correspondence& c) { return !agrees(c, world_from_object); });
  if (search.found.empty()) return;
  search.found = without_repeats(search.found);
  std::deque<Search>& searches = searches_[track];
  searches.push_back(std::move(search));
  if (searches.size() > max_searches_) searches.pop_front();
}

std::vector<Correspondence> TrackCorrespondences::of_views(int track, int first_view, int end_view,
                                                           const Rigid3& world_from_object) const {
  std::vector<Correspondence> all;
  const auto searches = searches_.find(track);
  if (searches == searches_.end()) return all;
  for (const Search& search : searches->second)
    if (search.view >= first_view && search.view < end_view)
      std::ranges::copy_if(search.found, std::back_inserter(all),
                           [&](const Correspondence& c) { return agrees(c, world_from_object); });
  return all;
}

void TrackCorrespondences::keep_only(std::span<const int> tracks) {
  std::erase_if(searches_, [&](const auto& entry) { return std::ranges::find(tracks, entry.first) == tracks.end(); });
}

}  // namespace resight
