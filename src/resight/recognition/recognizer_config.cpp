// SPDX-License-Identifier: Apache-2.0
#include "resight/recognition/recognizer_config.hpp"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <sstream>
#include <variant>

#include "resight/core/check.hpp"

namespace resight {
namespace {

// The one list of what can be set from a file and what summary.json keeps; a test counts the fields of all options
// against it. Thread counts are left out: results do not depend on them.
struct Field {
  const char* name;  // "section.key", or "key" at the top
  std::variant<double*, int*, bool*, std::uint64_t*, RotationTest*, OcclusionTest*> value;
};

constexpr std::pair<const char*, RotationTest> kRotationTests[] = {{"geodesic", RotationTest::kGeodesic},
                                                                   {"absolute_euler", RotationTest::kAbsoluteEuler}};
constexpr std::pair<const char*, OcclusionTest> kOcclusionTests[] = {{"spherical_bins", OcclusionTest::kSphericalBins},
                                                                     {"depth_image", OcclusionTest::kDepthImage}};

void add_feature_fields(RecognizerConfig& c, std::vector<Field>& fields) {
  fields.insert(fields.end(), {
                                  {"prepare.max_depth_m", &c.prepare.max_depth_m},
                                  {"prepare.normals_window_radius_px", &c.prepare.normals.window_radius_px},
                                  {"prepare.normals_max_depth_change", &c.prepare.normals.max_depth_change},
                                  {"prepare.normals_min_neighbors", &c.prepare.normals.min_neighbors},
                                  {"prepare.edge_max_depth_jump", &c.prepare.edges.max_depth_jump},
                                  {"prepare.edge_max_gap_px", &c.prepare.edges.max_gap_px},
                                  {"prepare.edge_max_distance_px", &c.prepare.edges.max_distance_px},
                                  {"sift.contrast_threshold", &c.sift.contrast_threshold},
                                  {"sift.edge_threshold", &c.sift.edge_threshold},
                                  {"sift.num_octave_layers", &c.sift.num_octave_layers},
                                  {"sift.root_sift", &c.sift.root_sift},
                                  {"shot.keypoint_spacing_m", &c.shot.keypoint_spacing_m},
                                  {"shot.support_radius_m", &c.shot.support_radius_m},
                                  {"shot.support_voxel_m", &c.shot.support_voxel_m},
                                  {"shot.min_surface_variation", &c.shot.min_surface_variation},
                                  {"shot.max_keypoint_depth_m", &c.shot.max_keypoint_depth_m},
                                  {"shot.min_neighbors", &c.shot.min_neighbors},
                                  {"match.sift_neighbors", &c.match.sift_neighbors},
                                  {"match.shot_neighbors", &c.match.shot_neighbors},
                                  {"match.max_sift_distance", &c.match.max_sift_distance},
                                  {"match.max_shot_distance", &c.match.max_shot_distance},
                                  {"match.sift_index_num_cells", &c.match.sift_index.num_cells},
                                  {"match.sift_index_num_probes", &c.match.sift_index.num_probes},
                                  {"match.sift_index_exact_below", &c.match.sift_index.exact_below},
                                  {"match.sift_index_num_components", &c.match.sift_index.num_components},
                                  {"match.sift_index_seed", &c.match.sift_index.seed},
                                  {"match.shot_index_num_cells", &c.match.shot_index.num_cells},
                                  {"match.shot_index_num_probes", &c.match.shot_index.num_probes},
                                  {"match.shot_index_exact_below", &c.match.shot_index.exact_below},
                                  {"match.shot_index_num_components", &c.match.shot_index.num_components},
                                  {"match.shot_index_seed", &c.match.shot_index.seed},
                              });
}

void add_pose_fields(RecognizerConfig& c, std::vector<Field>& fields) {
  CorrectCameraOptions& p = c.poses;
  fields.insert(fields.end(), {
                                  {"poses.correct", &p.enabled},
                                  {"poses.num_views", &p.num_views},
                                  {"poses.sigma_m", &p.sigma_m},
                                  {"poses.sigma_rad", &p.sigma_rad},
                                  {"poses.min_overlap", &p.min_overlap},
                                  {"poses.min_surprise", &p.min_surprise},
                                  {"poses.max_sigmas", &p.max_sigmas},
                                  {"poses.view_levels", &p.view.num_levels},
                                  {"poses.num_levels", &p.align.num_levels},
                                  {"poses.min_edge_distance_px", &p.view.min_edge_distance_px},
                                  {"poses.mean_radius", &p.view.mean_radius},
                                  {"poses.max_distance_m", &p.align.max_distance_m},
                                  {"poses.min_distance_m", &p.align.min_distance_m},
                                  {"poses.max_normal_angle_rad", &p.align.max_normal_angle_rad},
                                  {"poses.max_noise_sigmas", &p.align.max_noise_sigmas},
                                  {"poses.information_per_pair", &p.align.information_per_pair},
                                  {"poses.brightness_sigma", &p.align.brightness_sigma},
                                  {"poses.max_iterations", &p.align.max_iterations},
                                  {"poses.max_samples", &p.align.max_samples},
                              });
}

void add_hypothesis_fields(RecognizerConfig& c, std::vector<Field>& fields) {
  GroupCorrespondencesOptions& g = c.generate.grouping;
  fields.insert(fields.end(), {
                                  {"grouping.max_distance_difference_m", &g.max_distance_difference_m},
                                  {"grouping.max_dot_difference", &g.max_dot_difference},
                                  {"grouping.min_distance_m", &g.min_distance_m},
                                  {"grouping.min_group_size", &g.min_group_size},
                                  {"grouping.max_correspondences", &g.max_correspondences},
                                  {"grouping.max_cliques", &g.max_cliques},
                                  {"grouping.max_poses", &g.max_poses},
                                  {"grouping.max_uses", &g.max_uses},
                                  {"grouping.expand_groups", &g.expand_groups},
                                  {"grouping.merge_distance_m", &g.merge_distance_m},
                                  {"grouping.merge_rotation_rad", &g.merge_rotation_rad},
                                  {"grouping.pose_inlier_distance_m", &g.pose.inlier_distance_m},
                                  {"grouping.pose_max_normal_angle_rad", &g.pose.max_normal_angle_rad},
                                  {"grouping.pose_max_iterations", &g.pose.max_iterations},
                                  {"grouping.pose_min_inliers", &g.pose.min_inliers},
                                  {"grouping.pose_seed", &g.pose.seed},
                                  {"cluster.max_translation_m", &c.cluster.max_translation_m},
                                  {"cluster.max_rotation_rad", &c.cluster.max_rotation_rad},
                                  {"cluster.rotation_test", &c.cluster.rotation_test},
                                  {"cluster.pose_inlier_distance_m", &c.cluster.pose.inlier_distance_m},
                                  {"cluster.pose_max_normal_angle_rad", &c.cluster.pose.max_normal_angle_rad},
                                  {"cluster.pose_max_iterations", &c.cluster.pose.max_iterations},
                                  {"cluster.pose_min_inliers", &c.cluster.pose.min_inliers},
                                  {"cluster.pose_seed", &c.cluster.pose.seed},
                              });
}

void add_shape_fields(RecognizerConfig& c, std::vector<Field>& fields) {
  ShapeSearchOptions& s = c.shape;
  fields.insert(fields.end(), {
                                  {"shape.enabled", &s.enabled},
                                  {"shape.scene_spacing_m", &s.scene.spacing_m},
                                  {"shape.scene_max_depth_m", &s.scene.max_depth_m},
                                  {"shape.scene_max_plane_m", &s.scene.max_plane_m},
                                  {"shape.scene_min_edge_distance_px", &s.scene.min_edge_distance_px},
                                  {"shape.max_model_samples", &s.max_model_samples},
                                  {"shape.max_seeds", &s.max_seeds},
                                  {"shape.pairs_per_seed", &s.pairs_per_seed},
                                  {"shape.max_entries", &s.max_entries},
                                  {"shape.coarse_max_samples", &s.coarse.max_samples},
                                  {"shape.coarse_max_wrong", &s.coarse.max_wrong},
                                  {"shape.min_coarse_score", &s.min_coarse_score},
                                  {"shape.coarse_tolerance_m", &s.coarse.tolerance_m},
                                  {"shape.coarse_tolerance_sigmas", &s.coarse.tolerance_sigmas},
                                  {"shape.coarse_max_chroma_difference", &s.coarse.max_chroma_difference},
                                  {"shape.max_refined", &s.max_refined},
                                  {"shape.refine_iterations", &s.refine_iterations},
                                  {"shape.refine_distance_m", &s.refine_distance_m},
                                  {"shape.tolerance_m", &s.tolerance_m},
                                  {"shape.min_explained_share", &s.min_explained_share},
                                  {"shape.max_matches", &s.max_matches},
                                  {"shape.match_distance_m", &s.match_distance_m},
                                  {"shape.max_turns", &s.max_turns},
                                  {"shape.min_visible_share", &s.min_visible_share},
                                  {"shape.max_hypotheses", &s.max_hypotheses},
                                  {"shape.min_feature_share", &s.min_feature_share},
                                  {"shape.same_place_m", &s.same_place_m},
                                  {"shape.same_rotation_rad", &s.same_rotation_rad},
                                  {"shape.seed", &s.seed},
                              });
}

void add_change_fields(RecognizerConfig& c, std::vector<Field>& fields) {
  fields.insert(fields.end(), {
                                  {"attention.max_unseen_share", &c.search.max_new_share},
                                  {"attention.full_look_every", &c.search.full_interval},
                                  {"attention.max_turn_rad", &c.search.max_turn_rad},
                                  {"attention.max_distance_ratio", &c.search.max_distance_ratio},
                                  {"attention.max_depth_m", &c.search.max_depth_m},
                                  {"attention.object_look_every", &c.search.place_interval},
                                  {"attention.object_min_views", &c.search.place_min_views},
                                  {"attention.min_sure_share", &c.search.min_explained_share},
                                  {"changes.tolerance_m", &c.changes.tolerance_m},
                                  {"changes.tolerance_sigmas", &c.changes.tolerance_sigmas},
                                  {"changes.voxel_m", &c.changes.voxel_m},
                                  {"changes.occlusion_test", &c.changes.occlusion_test},
                                  {"changes.bin_size_rad", &c.changes.bin_size_rad},
                                  {"changes.occlusion_margin_m", &c.changes.occlusion_margin_m},
                                  {"changes.occlusion_sigmas", &c.changes.occlusion_sigmas},
                                  {"changes.window_radius_px", &c.changes.window_radius_px},
                                  {"changes.require_return", &c.changes.require_return},
                                  {"changes.novel_needs_free_space", &c.changes.novel_needs_free_space},
                                  {"changes.min_depth_m", &c.changes.min_depth_m},
                                  {"changes.max_depth_m", &c.changes.max_depth_m},
                                  {"changes.frustum_margin_rad", &c.changes.frustum_margin_rad},
                                  {"changes.max_changed_share", &c.changes.max_changed_share},
                                  {"removal.cluster_distance_m", &c.removal.cluster_distance_m},
                                  {"removal.min_cluster_points", &c.removal.min_cluster_points},
                                  {"removal.model_distance_m", &c.removal.model_distance_m},
                                  {"removal.min_overlap", &c.removal.min_overlap},
                                  {"removal.min_support_points", &c.removal.min_support_points},
                                  {"integrate.voxel_m", &c.integrate.voxel_m},
                                  {"integrate.min_edge_distance_px", &c.integrate.min_edge_distance_px},
                                  {"integrate.min_points_per_voxel", &c.integrate.min_points_per_voxel},
                                  {"score.offset", &c.score.offset},
                                  {"score.gain_weight", &c.score.gain_weight},
                                  {"score.correspondence_weight", &c.score.correspondence_weight},
                                  {"score.fit_weight", &c.score.fit_weight},
                                  {"score.visible_weight", &c.score.visible_weight},
                                  {"score.known_weight", &c.score.known_weight},
                                  {"history.same_place_m", &c.history.same_place_m},
                                  {"history.same_rotation_rad", &c.history.same_rotation_rad},
                                  {"history.confirm_removal_views", &c.history.confirm_removal_views},
                                  {"history.correct_views", &c.history.correct_views},
                                  {"history.min_told_score", &c.history.confirm_score},
                                  {"history.min_new_share", &c.history.min_new_share},
                                  {"history.min_displaced_gone_share", &c.history.min_displaced_gone_share},
                                  {"history.presence_depth_margin_m", &c.history.presence.margin.base_m},
                                  {"history.presence_min_seen_points", &c.history.presence.min_seen_points},
                                  {"history.presence_min_seen_share", &c.history.presence.min_seen_share},
                                  {"history.presence_min_gone_share", &c.history.presence.min_gone_share},
                                  {"history.memory_max_views", &c.history.memory.max_views},
                                  {"history.memory_step_px", &c.history.memory.step_px},
                              });
}

std::vector<Field> list_fields(RecognizerConfig& c) {
  std::vector<Field> fields{{"num_previous_views", &c.num_previous_views},
                            {"detect_changes", &c.detect_changes},
                            {"cluster_hypotheses", &c.cluster_hypotheses},
                            {"clear_tolerance_m", &c.clear_tolerance_m},
                            {"min_reported_share", &c.min_reported_share},
                            {"min_carried_share", &c.min_carried_share},
                            {"judge_absent", &c.judge_absent},
                            {"remember_objects", &c.remember_objects},
                            {"skip_planes", &c.skip_planes},
                            {"deadline_ms", &c.deadline_ms}};
  add_pose_fields(c, fields);
  add_feature_fields(c, fields);
  add_hypothesis_fields(c, fields);
  add_shape_fields(c, fields);
  add_change_fields(c, fields);
  return fields;
}

template <typename Enum, std::size_t N>
std::string name_of(Enum value, const std::pair<const char*, Enum> (&names)[N]) {
  for (const auto& [name, entry] : names)
    if (entry == value) return name;
  return "";
}

struct ToText {
  std::string operator()(const double* v) const { return fmt::format("{}", *v); }
  std::string operator()(const int* v) const { return fmt::format("{}", *v); }
  std::string operator()(const bool* v) const { return *v ? "true" : "false"; }
  std::string operator()(const std::uint64_t* v) const { return fmt::format("{}", *v); }
  std::string operator()(const RotationTest* v) const { return name_of(*v, kRotationTests); }
  std::string operator()(const OcclusionTest* v) const { return name_of(*v, kOcclusionTests); }
};

// Takes a TOML value over into a field; returns what was expected if it does not fit.
struct Assign {
  const toml::node& node;
  std::string operator()(double* v) const {
    const auto value = node.value<double>();
    if (value) *v = *value;
    return value ? "" : "a number";
  }
  std::string operator()(int* v) const {
    const auto value = node.value_exact<std::int64_t>();
    const bool fits = value && *value >= -1000000000 && *value <= 1000000000;
    if (fits) *v = static_cast<int>(*value);
    return fits ? "" : "a whole number";
  }
  std::string operator()(bool* v) const {
    const auto value = node.value_exact<bool>();
    if (value) *v = *value;
    return value ? "" : "true or false";
  }
  std::string operator()(std::uint64_t* v) const {
    const auto value = node.value_exact<std::int64_t>();
    const bool fits = value && *value >= 0;
    if (fits) *v = static_cast<std::uint64_t>(*value);
    return fits ? "" : "a whole number >= 0";
  }
  std::string operator()(RotationTest* v) const { return choose(v, kRotationTests); }
  std::string operator()(OcclusionTest* v) const { return choose(v, kOcclusionTests); }

  template <typename Enum, std::size_t N>
  std::string choose(Enum* v, const std::pair<const char*, Enum> (&names)[N]) const {
    const auto text = node.value<std::string>();
    std::string expected = "one of";
    for (const auto& [name, entry] : names) {
      if (text && *text == name) {
        *v = entry;
        return "";
      }
      expected += fmt::format(" \"{}\"", name);
    }
    return expected;
  }
};

OptionValue value_of(const toml::node& node) {
  if (const auto flag = node.value_exact<bool>()) return *flag;
  if (const auto whole = node.value_exact<std::int64_t>()) return *whole;
  if (const auto number = node.value_exact<double>()) return *number;
  return node.value_or(std::string());
}

// Options of the verification. Choices first: they decide which other options there are.
std::string assign_verify(VerifyOptions& verify, const std::map<std::string, const toml::node*>& nodes) {
  for (const bool choices : {true, false})
    for (const auto& [name, node] : nodes) {
      std::vector<Option> options = list_options(verify);
      const auto found = std::ranges::find(options, name, &Option::key);
      if (found == options.end())
        return fmt::format("unknown key verify.{} (did you mean verify.{}?)", name, nearest_key(options, name));
      if (std::holds_alternative<OptionChoice>(found->pointer) != choices) continue;
      if (!found->condition.empty())
        return fmt::format("verify.{} has no effect unless verify.{}", name, found->condition);
      const std::string expected = assign_option(*found, value_of(*node));
      if (!expected.empty()) return fmt::format("verify.{} must be {}", name, expected);
    }
  return "";
}

void collect_nodes(const toml::table& table, const std::string& prefix,
                   std::map<std::string, const toml::node*>& nodes) {
  for (const auto& [key, node] : table) {
    const std::string name = prefix + std::string(key.str());
    if (const toml::table* entries = node.as_table())
      collect_nodes(*entries, name + ".", nodes);
    else
      nodes[name] = &node;
  }
}

std::string assign(std::vector<Field>& fields, const std::string& name, const toml::node& node) {
  for (Field& field : fields) {
    if (name != field.name) continue;
    const std::string expected = std::visit(Assign{node}, field.value);
    return expected.empty() ? "" : fmt::format("{} must be {}", name, expected);
  }
  return fmt::format("unknown key {}", name);
}

}  // namespace

RecognizerConfig RecognizerConfig::from_preset(const std::string& name) {
  RecognizerConfig config;
  config.preset = name;
  // The paper's thresholds are the defaults of the stages; here stands what tells the presets apart, and what the paper
  // leaves open: keypoints beyond 2 m are noise (later V4R: 1.8 m).
  config.shot.max_keypoint_depth_m = 2.0;
  if (name == "mvr-chd" || name == "mvr") {
    config.detect_changes = name == "mvr-chd";
    config.changes.occlusion_test = OcclusionTest::kSphericalBins;
    config.verify.refine.max_iterations = 0;
    config.score = {.offset = -13.18, .gain_weight = 4.71, .correspondence_weight = 1.21, .fit_weight = 10.91};
    return config;
  }
  if (name == "default") {
    config.changes.occlusion_test = OcclusionTest::kDepthImage;
    VerifyOptions& verify = config.verify;
    verify.support.max_distance_m = 0.01;  // Poses are refined.
    verify.visibility.free_space = NewestViewFreeSpace{};
    verify.visibility.arrival_share = 0.6;
    verify.appearance.sigma_l = 0.45;                 // An object in shadow is darker than the fit has it,
    verify.appearance.sigma_ab = 0.17;                // but not of another chromaticity.
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
                         .untextured = UntexturedOptions{},
                         .require_unary_gain = true};
    config.prepare.normals.window_radius_px = 4;  // On things at a metre 6 deg off; 20 with 2.
    config.min_reported_share = 0.01;
    config.history.min_new_share = 0.01;
    config.history.confirm_score = 0.7;
    config.score = {.offset = -4.24,
                    .gain_weight = 5.14,
                    .correspondence_weight = 0.71,
                    .visible_weight = 6.87,
                    .known_weight = 0.83};
    config.remember_objects = true;
    config.poses.enabled = true;
    config.min_carried_share = 0.8;
    config.judge_absent = true;
    config.search.max_new_share = 0.003;  // 30 x 30 px.
    config.search.place_interval = 4;
    config.shape.max_seeds = 600;
    config.skip_planes = true;
    config.shape.enabled = true;
    config.match.shot_neighbors = 3;
    config.match.shot_index.num_components = 64;
    config.match.shot_index.num_probes = 8;
    config.match.shot_index.exact_below = 1024;  // A single object has thousands.
    return config;
  }
  throw std::invalid_argument(fmt::format("unknown preset '{}' (there are mvr, mvr-chd, default)", name));
}

void RecognizerConfig::set_num_threads(int num_threads) {
  check_positive("num_threads", num_threads);
  for (int* field :
       {&prepare.num_threads, &prepare.normals.num_threads, &shot.num_threads, &match.sift_index.num_threads,
        &match.shot_index.num_threads, &generate.num_threads, &shape.num_threads, &cluster.num_threads,
        &poses.align.num_threads, &changes.num_threads, &integrate.num_threads, &verify.num_threads})
    *field = num_threads;
}

void RecognizerConfig::set_seed(std::uint64_t seed) {
  for (std::uint64_t* field : {&match.sift_index.seed, &match.shot_index.seed, &generate.grouping.pose.seed,
                               &shape.seed, &cluster.pose.seed, &verify.seed})
    *field = seed;
}

void RecognizerConfig::check() const {
  check_in_range("num_previous_views", num_previous_views, 0, 1000);
  check_positive("clear_tolerance_m", clear_tolerance_m);
  check_in_range("min_reported_share", min_reported_share, 0, 1);
  check_in_range("min_carried_share", min_carried_share, 0, 1);
  check_not_negative("deadline_ms", deadline_ms);
  poses.check();
  prepare.check();
  sift.check();
  search.check();
  shot.check();
  match.check();
  generate.check();
  shape.check();
  cluster.check();
  changes.check();
  removal.check();
  integrate.check();
  verify.check();
  score.check();
  history.check();
}

std::vector<std::pair<std::string, std::string>> RecognizerConfig::to_settings() const {
  RecognizerConfig copy = *this;
  std::vector<std::pair<std::string, std::string>> settings{{"preset", preset}};
  for (const Field& field : list_fields(copy)) settings.emplace_back(field.name, std::visit(ToText{}, field.value));
  for (const auto& [key, value] : settings_of(list_options(copy.verify))) settings.emplace_back("verify." + key, value);
  return settings;
}

Result<RecognizerConfig> read_config(const std::filesystem::path& path, RecognizerConfig config) {
  const auto fail = [&](const std::string& what) { return Error{fmt::format("{}: {}", path.string(), what)}; };
  std::error_code code;
  std::ifstream file(path);
  if (!file || std::filesystem::is_directory(path, code)) return fail("cannot be read (a TOML file was expected)");
  std::stringstream text;
  text << file.rdbuf();
  toml::table table;
  try {
    table = toml::parse(text.str());
  } catch (const toml::parse_error& error) {
    return fail(fmt::format("line {}: {}", error.source().begin.line, error.description()));
  }
  std::vector<Field> fields = list_fields(config);
  for (const auto& [key, node] : table) {
    const std::string section(key.str());
    std::string problem;
    if (const toml::table* entries = node.as_table(); entries != nullptr && section == "verify") {
      std::map<std::string, const toml::node*> nodes;
      collect_nodes(*entries, "", nodes);
      if (problem = assign_verify(config.verify, nodes); !problem.empty()) return fail(problem);
    } else if (entries != nullptr) {
      for (const auto& [name, value] : *entries) {
        problem = assign(fields, fmt::format("{}.{}", section, std::string_view(name.str())), value);
        if (!problem.empty()) return fail(problem);
      }
    } else if (problem = assign(fields, section, node); !problem.empty()) {
      return fail(problem);
    }
  }
  try {
    config.check();
  } catch (const std::invalid_argument& error) {
    return fail(error.what());
  }
  return config;
}

}  // namespace resight
