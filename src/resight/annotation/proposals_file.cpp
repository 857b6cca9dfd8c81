// SPDX-License-Identifier: Apache-2.0
#include "resight/annotation/proposals_file.hpp"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "resight/annotation/annotated_inputs.hpp"
#include "resight/annotation/annotation_json.hpp"
#include "resight/annotation/internal/hash_values.hpp"
#include "resight/core/files.hpp"
#include "resight/core/hash.hpp"
#include "resight/core/input_file.hpp"
#include "resight/core/json_integer.hpp"
#include "resight/io/parse_json.hpp"

namespace resight {
namespace {

using annotation::hash_values;
using nlohmann::json;

constexpr const char* kFormat = "resight proposals 1";

std::uint64_t hash_pose(const Rigid3& world_from_camera, std::uint64_t seed) {
  const Eigen::Matrix4d pose = world_from_camera.matrix();
  return hash_values(std::span<const double>(pose.data(), static_cast<std::size_t>(pose.size())), seed);
}

std::uint64_t hash_frame(const RgbdFrame& frame, std::uint64_t seed) {
  const Camera& camera = frame.camera;
  const double numbers[] = {camera.fx, camera.fy, camera.cx, camera.cy};
  const int sizes[] = {camera.width, camera.height};
  seed = hash_values(std::span<const double>(numbers), seed);
  seed = hash_values(std::span<const int>(sizes), seed);
  seed = hash_values(frame.depth_m.data(), seed);
  return hash_values(frame.color.data(), seed);
}

json proposal_to_json(const ChangeProposal& p) {
  json points = json::array();
  for (const Eigen::Vector3f& point : p.points_in_world)
    for (const float value : point) points.push_back(value);
  return {{"view", p.view},
          {"kind", to_string(p.kind)},
          {"num_points", p.num_points},
          {"points", std::move(points)},
          {"pose", annotation::pose_to_json(p.box.world_from_box)},
          {"size_m", annotation::point_to_json(p.box.size_m)},
          {"pixels", annotation::runs_to_json(p.pixels)}};
}

/// Finite numbers; none for anything else.
std::optional<std::vector<double>> numbers_of(const json& list) {
  if (!list.is_array()) return std::nullopt;
  std::vector<double> numbers;
  for (const json& number : list) {
    if (!number.is_number() || !std::isfinite(number.get<double>())) return std::nullopt;
    numbers.push_back(number.get<double>());
  }
  return numbers;
}

std::optional<ChangeProposal> proposal_from_json(const json& object, int num_views) {
  if (!object.is_object()) return std::nullopt;
  static const json kNone;
  // No copies: copying is recursive, and a stranger's file may be nested deeply.
  const auto at = [&](const char* key) -> const json& {
    const auto found = object.find(key);
    return found == object.end() ? kNone : *found;
  };
  const auto view = json_integer(at("view"), 0, num_views - 1);
  const auto num_points = json_integer(at("num_points"), 0, 1 << 30);
  const auto points = numbers_of(at("points"));
  const auto size_m = numbers_of(at("size_m"));
  const auto pose = annotation::pose_from_json(at("pose"));
  auto pixels = annotation::runs_from_json(at("pixels"));
  if (!view || !num_points || !points || points->size() % 3 != 0 || !size_m || size_m->size() != 3 || !pose || !pixels)
    return std::nullopt;
  ChangeProposal proposal;
  proposal.view = *view;
  proposal.kind = at("kind") == to_string(RegionKind::kRemoved) ? RegionKind::kRemoved : RegionKind::kNovel;
  proposal.num_points = *num_points;
  for (std::size_t i = 0; i < points->size(); i += 3)
    proposal.points_in_world.push_back(Eigen::Vector3d((*points)[i], (*points)[i + 1], (*points)[i + 2]).cast<float>());
  proposal.box = {.world_from_box = *pose, .size_m = Eigen::Vector3d((*size_m)[0], (*size_m)[1], (*size_m)[2])};
  proposal.pixels = *std::move(pixels);
  return proposal;
}

}  // namespace

Result<std::string> digest_inputs(const Sequence& sequence, const std::string& settings) {
  std::uint64_t hash = hash_text(settings);
  for (int v = 0; v < sequence.num_views(); ++v) {
    const auto world_from_camera = sequence.read_pose(v);
    if (!world_from_camera) return world_from_camera.error();
    hash = hash_pose(*world_from_camera, hash_text(sequence.view_name(v), hash));
  }
  for (const int v : views_that_identify(sequence.num_views())) {
    const auto frame = sequence.read_view(v);
    if (!frame) return frame.error();
    hash = hash_frame(*frame, hash);
  }
  return fmt::format("{} views {:016x}", sequence.num_views(), hash);
}

Result<void> write_proposals(const std::filesystem::path& file, const std::string& digest,
                             const std::vector<ChangeProposal>& proposals) {
  json regions = json::array();
  for (const ChangeProposal& proposal : proposals) regions.push_back(proposal_to_json(proposal));
  const json content = {{"format", kFormat}, {"digest", digest}, {"regions", std::move(regions)}};
  return write_file(file, content.dump() + "\n");
}

std::optional<std::vector<ChangeProposal>> read_proposals(const std::filesystem::path& file, const std::string& digest,
                                                          int num_views) {
  const auto text = read_file(file);
  if (!text) return std::nullopt;
  const auto parsed = parse_json(*text);
  if (!parsed) return std::nullopt;
  const json& content = *parsed;
  if (!content.is_object() || !content.contains("format") || content["format"] != kFormat ||
      !content.contains("digest") || content["digest"] != digest || !content.contains("regions") ||
      !content["regions"].is_array())
    return std::nullopt;
  std::vector<ChangeProposal> proposals;
  for (const json& region : content["regions"]) {
    auto proposal = proposal_from_json(region, num_views);
    if (!proposal) return std::nullopt;
    proposals.push_back(*std::move(proposal));
  }
  return proposals;
}

}  // namespace resight
