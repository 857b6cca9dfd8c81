// SPDX-License-Identifier: Apache-2.0
#include "resight/annotation/internal/truth_files.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "resight/annotation/annotation_json.hpp"
#include "resight/core/json_text.hpp"

namespace resight::annotation {
namespace {

using Json = nlohmann::ordered_json;

Json rows_json(const std::optional<Rigid3>& pose) {
  if (!pose) return nullptr;
  const Eigen::Matrix<double, 4, 4, Eigen::RowMajor> matrix = pose->matrix();
  return std::vector<double>(matrix.data(), matrix.data() + matrix.size());
}

Json box_json(const PixelRectangle& box) {
  if (box.width == 0) return {-1, -1, -1, -1};  // as BOP writes what is not there
  return {box.left, box.top, box.width, box.height};
}

Json mask_json(const ObjectMask& mask) {
  return {{"bbox_obj", box_json(mask.whole_box)}, {"bbox_visib", box_json(mask.visible_box)},
          {"px_count_all", mask.num_pixels},      {"px_count_valid", mask.num_measured},
          {"px_count_visib", mask.num_visible},   {"visib_fract", mask.visible_share()}};
}

/// "000012" is the key "12" in files of BOP.
std::string bop_key(const std::string& name) { return std::to_string(std::stol(name)); }

}  // namespace

std::string format_events(const std::vector<AnnotatedEvent>& events, const ModelLibrary& library,
                          const std::string& scene, int num_views) {
  Json list = Json::array();
  for (const AnnotatedEvent& event : events)
    list.push_back({{"view", event.view},
                    {"kind", to_text(event.kind)},
                    {"object", event.name},
                    {"instance", event.track < 0 ? event.name : fmt::format("track_{}", event.track)},
                    {"known", event.object >= 0},
                    {"world_from_object_before", rows_json(event.world_from_object_before)},
                    {"world_from_object_after", rows_json(event.world_from_object_after)}});
  Json ids = Json::object();
  for (const ObjectModel& model : library.objects) ids[model.name] = model.bop_id;
  const Json json{{"scene", scene}, {"num_views", num_views}, {"obj_ids", ids}, {"events", list}};
  return to_json_text(json, kIndentedJson) + "\n";
}

std::string format_mask_info(const std::vector<std::vector<ObjectMask>>& masks, const std::vector<std::string>& names) {
  Json views = Json::object();
  for (std::size_t v = 0; v < masks.size(); ++v) {
    Json& view = views[bop_key(names[v])] = Json::array();
    for (const ObjectMask& mask : masks[v]) view.push_back(mask_json(mask));
  }
  return views.dump(1) + "\n";
}

std::string format_anno(const std::vector<GroundTruthObject>& objects) {
  std::string text;
  for (const GroundTruthObject& object : objects) {
    text += fmt::format("{} ({}):", object.object, object.visible_share);
    const Eigen::Matrix<double, 4, 4, Eigen::RowMajor> matrix = object.camera_from_object.matrix();
    for (Eigen::Index i = 0; i < 16; ++i) text += fmt::format(" {}", matrix.data()[i]);
    text += '\n';
  }
  return text;
}

}  // namespace resight::annotation
