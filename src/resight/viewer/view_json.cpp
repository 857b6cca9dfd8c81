// SPDX-License-Identifier: Apache-2.0
#include "resight/viewer/internal/view_json.hpp"

#include "resight/core/json_text.hpp"

namespace resight::viewer {

std::string to_text(const Json& json) { return to_json_text(json); }

Json matrix_json(const Rigid3& pose) {
  const Eigen::Matrix4d matrix = pose.matrix();  // stored column by column
  return std::vector<double>(matrix.data(), matrix.data() + matrix.size());
}
Json matrix_json(const std::optional<Rigid3>& pose) { return pose ? matrix_json(*pose) : Json(nullptr); }

Json camera_json(const Camera& camera) {
  return {{"width", camera.width}, {"height", camera.height}, {"fx", camera.fx},
          {"fy", camera.fy},       {"cx", camera.cx},         {"cy", camera.cy}};
}

Json contours_json(const std::vector<std::vector<Pixel>>& contours) {
  Json list = Json::array();
  for (const std::vector<Pixel>& contour : contours) {
    Json line = Json::array();
    for (const Pixel& pixel : contour) {
      line.push_back(pixel.u);
      line.push_back(pixel.v);
    }
    list.push_back(std::move(line));
  }
  return list;
}

}  // namespace resight::viewer
