// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <stdexcept>

#include "resight/recognition/recognizer_config.hpp"

namespace resight {
namespace {

// The paper's thresholds are the defaults of the stages; here stands what tells the presets apart, and what the paper
// leaves open.

void set_paper(RecognizerConfig& config) {
  config.verify.refine.max_iterations.reset();
  config.verify.score = {.offset = -13.18, .gain_weight = 4.71, .correspondence_weight = 1.21, .fit_weight = 10.91};
}

void set_default_verification(VerifyOptions& verify) {
  verify.support.max_distance_m = 0.01;        // Poses are refined.
  verify.visibility.min_edge_distance_px = 3;  // As integrate.min_edge_distance_px.
  verify.visibility.free_space = NewestViewFreeSpace{};
  verify.appearance.sigma_l = 0.45;          // An object in shadow is darker than the fit has it.
  verify.appearance.sigma_ab = 0.1;          // Grey stays grey;
  verify.appearance.sigma_saturation = 0.8;  // cameras, gloss and light from other objects scale saturation.
  verify.appearance.chroma_weight = 2.65;
  verify.appearance.pattern_radius_m = 0.015;       // Three voxels.
  verify.appearance.light.max_log_darkening = 1.2;  // Objects in a shelf
  verify.appearance.light.max_log_shading = 1.2;    // are lit from one side.
  verify.refine.symmetry_step_rad = 0.1745;         // 10 deg.
  verify.clutter.weight = 6;
  verify.clutter.rule = ContinuationClutter{.max_offset_m = 0.005, .texture_contrast = 2, .noise_sigmas = 3};
  verify.planes->spacing_m = 0.01;
  verify.acceptance = {.min_visible_share = 0.05,
                       .min_explained_share = 0.5,     // Half of an object may lie in a hard shadow,
                       .min_pattern_similarity = 0.5,  // but its texture stays its own,
                       .min_newest_similarity = 0.4,   // whatever stood there before.
                       .min_shared_texture = 0.08,
                       .require_unary_gain = true};
}

void set_default(RecognizerConfig& config) {
  config.remember_objects = true;
  config.camera.poses.correct = true;
  config.camera.color_offset.correct = true;
  config.camera.depth_bias.correct = true;
  config.prepare.color_width_m = 0.005;         // As verify.resolution_m.
  config.prepare.normals.window_radius_px = 4;  // At 1 m, normals of objects are off by 6 deg; by 20 with 2.
  config.features.match.shot_neighbors = 3;
  config.features.match.shot_index.num_components = 64;
  config.features.match.shot_index.num_probes = 8;
  config.features.match.shot_index.exact_below = 1024;  // A single object has thousands.
  config.hypotheses.min_carried_share = 0.8;
  config.shape.enabled = true;
  config.shape.skip_planes = true;
  config.shape.max_seeds = 600;
  config.changes.detection.test = DepthTestOptions{};
  set_default_verification(config.verify);
  config.detections.min_reported_share = 0.002;
  config.detections.min_score = 0.3;
  config.detections.further_instance_odds = 0.2;
  config.detections.weigh_competing_poses = true;
  config.verify.selection.score_power = 0.5;
  config.verify.score = {.offset = -34.6,
                         .correspondence_weight = 0.6,
                         .fit_weight = 5.3,
                         .visible_weight = 0.8,
                         .texture_weight = 1.86,
                         .beside_planes_weight = 4.25,
                         .newest_weight = 4.35,
                         .seen_through_weight = 10.3,
                         .silhouette_weight = 1.11,
                         .hue_weight = 20,
                         .uncolored_weight = 26};
  config.history.min_new_share = 0.002;
  config.history.confirm_score = 0.7;
  config.search.max_new_share = 0.003;  // 30 x 30 pixels.
  config.search.place_interval = 4;
}

}  // namespace

RecognizerConfig RecognizerConfig::from_preset(const std::string& name) {
  RecognizerConfig config;
  config.preset = name;
  config.prepare.max_pixels = kMaxWorkingPixels;
  if (name == "default") {
    set_default(config);
  } else if (name == "mvr-chd" || name == "mvr") {
    set_paper(config);
    config.changes.enabled = name == "mvr-chd";
  } else {
    throw std::invalid_argument(fmt::format("unknown preset '{}' (there are mvr, mvr-chd, default)", name));
  }
  return config;
}

}  // namespace resight
