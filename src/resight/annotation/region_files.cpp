// SPDX-License-Identifier: Apache-2.0
#include "resight/annotation/internal/region_files.hpp"

#include <fmt/format.h>

#include <map>
#include <nlohmann/json.hpp>

#include "resight/annotation/annotated_events.hpp"
#include "resight/annotation/annotation_json.hpp"
#include "resight/annotation/matched_regions.hpp"
#include "resight/core/files.hpp"
#include "resight/core/json_text.hpp"
#include "resight/io/images.hpp"

namespace resight::annotation {
namespace {

using Json = nlohmann::ordered_json;

/// A region that the user has accepted.
struct AcceptedRegion {
  const RegionJudgement* judgement = nullptr;
  const PixelRuns* pixels = nullptr;
};

/// In the order of the document. A region that is no longer proposed counts if it has a mask of its own.
std::vector<AcceptedRegion> find_accepted(const AnnotationDocument& document,
                                          std::span<const ChangeProposal> proposals) {
  std::map<RegionKey, AcceptedRegion> accepted;
  const auto add = [&](const RegionJudgement& judgement, const PixelRuns* proposed) {
    const PixelRuns* pixels = judgement.mask ? &*judgement.mask : proposed;
    if (judgement.verdict == RegionVerdict::kAccepted && pixels != nullptr)
      accepted[judgement.region] = {&judgement, pixels};
  };
  const MatchedRegions matched = match_regions(document, proposals);
  for (std::size_t p = 0; p < proposals.size(); ++p)
    if (matched.of_proposal[p] != nullptr) add(*matched.of_proposal[p], &proposals[p].pixels);
  for (const RegionJudgement* judgement : matched.unmatched) add(*judgement, nullptr);
  std::vector<AcceptedRegion> list;
  for (const auto& [key, region] : accepted) list.push_back(region);
  return list;
}

/// Name of the model of a track; null for a thing without model.
Json object_of(const AnnotationDocument& document, const ModelLibrary& library, int track) {
  const auto placements = placements_of_track(document, track);
  if (track < 0 || placements.empty()) return nullptr;
  return library.objects[static_cast<std::size_t>(placements.front().object)].name;
}

}  // namespace

Result<void> write_regions(const AnnotationDocument& document, std::span<const ChangeProposal> proposals,
                           const ModelLibrary& library, ViewStore& views, const std::filesystem::path& folder) {
  Json list = Json::array();
  std::map<int, int> counts;  // Per view.
  for (const AcceptedRegion& region : find_accepted(document, proposals)) {
    const RegionJudgement& judgement = *region.judgement;
    const RegionKey& key = judgement.region;
    const auto frame = views.get(key.view);
    if (!frame) return frame.error();
    const std::string name = views.sequence().view_name(key.view);
    const std::string file = fmt::format("{}_{}.png", name, counts[key.view]++);
    const Camera& camera = (*frame)->camera;
    if (const auto done = write_mask(folder / file, make_mask(*region.pixels, camera.width, camera.height)); !done)
      return done;
    list.push_back({{"view", key.view},
                    {"name", name},
                    {"kind", to_string(key.kind)},
                    {"object", object_of(document, library, judgement.track)},
                    {"center_in_world_m", point_to_json(key.center_in_world_m)},
                    {"mask", file},
                    {"corrected", judgement.mask.has_value()}});
  }
  return write_file(folder / "regions.json", to_json_text(Json{{"regions", list}}, kIndentedJson) + "\n");
}

}  // namespace resight::annotation
