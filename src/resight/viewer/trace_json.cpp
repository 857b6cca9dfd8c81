// SPDX-License-Identifier: Apache-2.0
#include "resight/viewer/internal/trace_json.hpp"

#include "resight/viewer/internal/view_json.hpp"

namespace resight::viewer {
namespace {

Json verification_json(const StoredVerification& v, const SequenceNumbers& numbers) {
  Json views = Json::array();
  for (const StoredHypothesisView& view : v.views)
    views.push_back({{"view", numbers.of(view.view)},
                     {"visible_share", view.visible_share},
                     {"explained_share", view.explained_share}});
  Json json = {{"suppressed_by", v.suppressed_by},
               {"score", v.score},
               {"fit", v.fit},
               {"visible_share", v.visible_share},
               {"explained_share", v.explained_share},
               {"pattern_similarity", v.pattern_similarity},
               {"newest_similarity", v.newest_similarity},
               {"shared_texture", v.shared_texture},
               {"texture_contrast", v.texture_contrast},
               {"explained_scene", v.explained_scene},
               {"outlier", v.outlier},
               {"clutter", v.clutter},
               {"plane", v.plane},
               {"views", views},
               {"test", nullptr}};
  if (v.failed_test)
    json["test"] = {
        {"quantity", v.failed_test->quantity}, {"value", v.failed_test->value}, {"limit", v.failed_test->limit}};
  return json;
}

Json hypothesis_json(const StoredHypothesis& h, const ObjectTable& objects, const SequenceNumbers& numbers) {
  Json origin_views = Json::array();
  for (const int view : h.origin_views) origin_views.push_back(numbers.of(view));
  return {{"object", objects.find(h.object)},
          {"name", h.object},
          {"verdict", h.verdict},
          {"origin_views", origin_views},
          {"correspondences", h.num_correspondences},
          {"start", matrix_json(h.start)},
          {"pose", matrix_json(h.verification ? h.verification->world_from_object : h.start)},
          {"verification", h.verification ? verification_json(*h.verification, numbers) : Json(nullptr)}};
}

Json loss_json(const StoredLoss& loss, const ObjectTable& objects) {
  return {{"object", objects.find(loss.object)},
          {"name", loss.object},
          {"pose", matrix_json(loss.world_from_object)},
          {"visible_share", loss.visible_share},
          {"stage", loss.stage},
          {"keypoints", loss.num_keypoints},
          {"correspondences", loss.num_correspondences},
          {"right_correspondences", loss.num_right_correspondences},
          {"center_error_m", loss.center_error_m},
          {"rotation_error_rad", loss.rotation_error_rad},
          {"hypothesis", loss.hypothesis}};
}

}  // namespace

std::string format_trace(const StoredTrace& trace, const ObjectTable& objects, const SequenceNumbers& numbers) {
  Json json = {{"is_searched", trace.is_searched}, {"num_generated", trace.num_generated},
               {"num_merged", trace.num_merged},   {"num_clustered", trace.num_clustered},
               {"hypotheses", Json::array()},      {"lost", Json::array()}};
  for (const StoredHypothesis& h : trace.hypotheses) json["hypotheses"].push_back(hypothesis_json(h, objects, numbers));
  for (const StoredLoss& loss : trace.lost) json["lost"].push_back(loss_json(loss, objects));
  return to_text(json);
}

}  // namespace resight::viewer
