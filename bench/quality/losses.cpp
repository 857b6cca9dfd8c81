// SPDX-License-Identifier: Apache-2.0
// Where objects are lost: the stage per view and missed object, the evidence per wrong detection, and their sums.
//   resight simulate --preset demo --seed 3 --out scene; resight train scene/models --out models.resight
//   bench_losses scene models.resight [preset] [config.toml] [K] [min_visible_share]
#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <map>
#include <string>

#include "arguments.hpp"
#include "resight/evaluation/loss.hpp"
#include "resight/evaluation/match_view.hpp"
#include "resight/io/settings_file.hpp"
#include "resight/models/library_file.hpp"
#include "resight/recognition/recognize_sequence.hpp"
#include "resight/sensor/sequence.hpp"

namespace {

using namespace resight;

void print_evidence(const HypothesisEvidence& e) {
  fmt::print(
      "  {} score {:.4f} fit {:.3f} visible {} of it {:.3f} explained {:.2f} pattern {:.2f} contrast {:.2f} of {:.2f} "
      "newest {:.2f} hue {:.3f} through {:.3f} silhouette {:.3f} ",
      to_string(e.verdict), e.score, e.fit, e.num_visible, e.visible_share, e.explained_share,
      e.appearance.pattern_similarity, e.appearance.shared_texture, e.appearance.texture_contrast,
      e.appearance.newest_similarity, e.appearance.hue_similarity, e.seen_through_share, e.appearance.silhouette_error);
  fmt::print("matches {} | scene {:.0f} outlier {:.0f} clutter {:.0f} plane {:.0f} unary {:.0f}\n",
             e.num_correspondences, e.costs.explained_scene, e.costs.outlier, e.costs.clutter, e.costs.plane,
             e.costs.unary);
  if (e.accepted) return;
  fmt::print("    visible and explained per view:");
  for (std::size_t v = 0; v < e.visible_share_per_view.size(); ++v)
    fmt::print(" {:.2f}/{:.2f}", e.visible_share_per_view[v], e.explained_share_per_view[v]);
  fmt::print("\n");
}

void print_loss(int view, const GroundTruthObject& truth, const Loss& loss, const RecognitionTrace& trace,
                const ModelLibrary& library) {
  fmt::print("view {:2} missed {:16} vis {:.2f} {:13} keypoints {} matches {} right {}", view, truth.object,
             truth.visible_share, to_string(loss.stage), loss.num_keypoints, loss.num_correspondences, loss.num_right);
  if (loss.best)
    fmt::print(" best {:.1f} mm {:.1f} deg", 1e3 * loss.best->center_distance_m, 57.2958 * loss.best->rotation_rad);
  if (loss.evidence && loss.evidence->suppressed_by >= 0)
    fmt::print(" by {}", library.objects[trace.verified[loss.evidence->suppressed_by].object].name);
  if (loss.evidence)
    print_evidence(*loss.evidence);
  else
    fmt::print("\n");
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) {
    fmt::print(stderr,
               "usage: bench_losses SEQUENCE LIBRARY [preset] [config.toml|-] [K] [min_visible_share] [strict]\n");
    return 2;
  }
  const auto sequence = open_or_exit(argv[1]);
  const ModelLibrary library = value_or_exit(load_library(argv[2]));
  RecognizerConfig config = preset_or_exit(argc > 3 ? argv[3] : "default");
  if (argc > 4 && std::string(argv[4]) != "-") config = value_or_exit(read_settings(argv[4], config));
  if (argc > 5) config.num_previous_views = std::atoi(argv[5]);
  config.set_num_threads(2);
  FindLossOptions options;
  if (argc > 7) options.match.max_center_distance_m = 0.01, options.match.max_rotation_rad = 10.0 * 0.0174533;
  if (argc > 6) options.match.min_visible_share = std::atof(argv[6]);

  SceneRecognizer recognizer(library, config);
  std::map<LossStage, int> losses;
  std::vector<PoseDifference> differences;
  std::vector<double> errors_in_sigmas;  // Of the centre.
  RecognitionScore score;
  StageTimes times;
  RecognitionTrace trace;
  const auto print_view = [&](const RgbdFrame& frame, const SceneUpdate& update) {
    const int v = update.view;
    const auto truth = value_or_exit(sequence->read_ground_truth(v));
    const auto matched = match_view(v, {update.world_from_camera, truth}, to_detected_objects(update, library), {},
                                    frame.camera, library, options.match)
                             .loose;
    score += matched.score;
    times.add(update.times);
    for (const DetectionMatch& m : matched.matches) {
      differences.push_back(m.difference);
      const PoseUncertainty& uncertainty = update.detections[m.detection].uncertainty;
      if (uncertainty.is_known())
        errors_in_sigmas.push_back(m.difference.center_distance_m /
                                   std::sqrt(uncertainty.covariance.bottomRightCorner<3, 3>().trace()));
      fmt::print("view {:2} right  {:16} {:.1f} mm {:.1f} deg", v, truth[m.truth].object,
                 1e3 * m.difference.center_distance_m, 57.2958 * m.difference.rotation_rad);
      print_evidence(trace.evidence_of(update.detections[m.detection].hypothesis_id));
    }
    for (const int t : matched.false_negatives) {
      const Loss loss = find_loss(truth[t], update.world_from_camera, trace, library, options);
      ++losses[loss.stage];
      print_loss(v, truth[t], loss, trace, library);
    }
    for (const int d : matched.false_positives) {
      const Detection& detection = update.detections[d];
      fmt::print("view {:2} WRONG  {:16}", v, library.objects[detection.object].name);
      print_evidence(trace.evidence_of(detection.hypothesis_id));
    }
    for (const ObjectEvent& e : update.events)
      if (is_change(e.kind)) fmt::print("view {:2} {} {}\n", v, to_string(e.kind), library.objects[e.object].name);
  };
  (void)value_or_exit(recognize_sequence(recognizer, *sequence, print_view, &trace));
  for (const StageTime& t : times.stages())
    fmt::print("time: {:26} {:.3f} s CPU per view\n", t.stage, t.cpu_s / sequence->num_views());
  for (const auto& [stage, count] : losses) fmt::print("lost: {:14} {}\n", to_string(stage), count);
  std::sort(differences.begin(), differences.end(),
            [](const auto& a, const auto& b) { return a.center_distance_m < b.center_distance_m; });
  if (!differences.empty())
    fmt::print("median centre error {:.1f} mm\n", 1e3 * differences[differences.size() / 2].center_distance_m);
  std::sort(errors_in_sigmas.begin(), errors_in_sigmas.end());
  if (!errors_in_sigmas.empty())
    fmt::print("centre error over its standard deviation: median {:.1f}, 95 % {:.1f}\n",
               errors_in_sigmas[errors_in_sigmas.size() / 2], errors_in_sigmas[errors_in_sigmas.size() * 95 / 100]);
  fmt::print("P {:.3f} R {:.3f} F {:.3f}  TP {} FP {} FN {}\n", score.precision(), score.recall(), score.f_score(),
             score.true_positives, score.false_positives, score.false_negatives);
  return 0;
}
