// SPDX-License-Identifier: Apache-2.0
#include "resight/verification/cues.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "resight/appearance/appearance_match.hpp"
#include "resight/segmentation/surface_continuation.hpp"
#include "resight/verification/acceptance.hpp"
#include "resight/verification/hue_similarity.hpp"
#include "resight/verification/hypothesis_score.hpp"
#include "resight/verification/newest_view_appearance.hpp"
#include "resight/verification/pose_refinement.hpp"
#include "resight/verification/scene_association.hpp"
#include "resight/verification/surface_blur.hpp"
#include "resight/verification/symmetry_resolution.hpp"

namespace resight {
namespace {

constexpr double kPlaneWeight = 0.8;    // How well a plane explains its points (V4R: 0.8, half of it with colour).
constexpr float kMinWeight = 0.05F;     // Smaller weights are dropped, for speed.
constexpr float kWellExplained = 0.5F;  // Weight from which a scene point is a start of a continuing surface.

// Angle between unit vectors whose dot product is not negative, by Abramowitz and Stegun 4.4.45: within 7e-5 rad, and
// several times faster than acos.
float angle_of(float dot) {
  const float x = std::min(dot, 1.0F);
  return std::sqrt(1 - x) * (1.5707288F + x * (-0.2121144F + x * (0.0742610F - 0.0187293F * x)));
}

}  // namespace

// Works out the cues of one hypothesis step by step. Everything in the world frame.
struct CueComputer::Impl {
  Impl(const PreparedModel& model, const Rigid3& world_from_object, std::span<const Correspondence> correspondences,
       const PreparedScene& scene, std::span<const DepthView> views, std::span<const std::uint8_t> allowed,
       const VerifyOptions& options)
      : model_(model),
        scene_(scene),
        views_(views),
        options_(options),
        colors_(color_tolerance(options.appearance)),
        use_normals_(!model.normals.empty() && !scene.normals.empty()),
        use_color_(!model.linear_light.empty() && !scene.linear_light.empty()),
        association_(model, refined(world_from_object, correspondences, views, allowed), scene, views, allowed,
                     options) {
    rotate_by_symmetry(views, allowed);
    cues_.evidence.world_from_object = association_.world_from_object;
    count_agreeing(correspondences);
  }

  // A hypothesis is moved onto the scene before it is assessed.
  Rigid3 refined(const Rigid3& pose, std::span<const Correspondence> correspondences, std::span<const DepthView> views,
                 std::span<const std::uint8_t> allowed) const {
    if (!options_.refine.max_iterations) return pose;
    return refine_pose_on_scene(model_, pose, find_roughly_visible(model_, pose, views, allowed, options_),
                                correspondences, scene_, options_.refine);
  }

  // Applies the symmetry motion of the shape under which the textures agree best. A pose without support stays: no such
  // motion would give it any.
  void rotate_by_symmetry(std::span<const DepthView> views, std::span<const std::uint8_t> allowed) {
    if (model_.symmetry_motions.size() < 2 || !association_.local || !use_color_) return;
    if (association_.supported_share() < options_.acceptance.min_explained_share) return;
    const Rigid3f object_from_world(association_.world_from_object.inverse());
    std::vector<ExplainedPoint> explained;
    for (const PointMatch& m : association_.nearest)
      explained.push_back({object_from_world * association_.local->point(static_cast<std::size_t>(m.local)),
                           association_.local_lab[static_cast<std::size_t>(m.local)]});
    const Rigid3 motion = resolve_symmetry(model_, explained, options_.appearance.chroma_weight);
    if (motion.rotation.isIdentity()) return;
    SceneAssociation rotated(model_, association_.world_from_object * motion, scene_, views, allowed, options_);
    if (rotated.color_fit() > association_.color_fit()) association_ = std::move(rotated);
  }

  void count_agreeing(std::span<const Correspondence> correspondences) {
    const Rigid3f motion(cues_.evidence.world_from_object);
    for (const Correspondence& c : correspondences)
      if ((motion * c.model_point - c.scene_point).norm() <= static_cast<float>(options_.support.max_distance_m))
        ++cues_.evidence.num_correspondences;
  }

  HypothesisCues finish(const Eigen::Array3f& white_balance) {
    cues_.state.assign(association_.points.size(), ModelPointState::kNotVisible);
    cues_.evidence.appearance.is_compared = use_color_;
    if (association_.local) {
      adapt_model_colors(limit_chromaticity(association_.light, white_balance));
      weigh_matches(*association_.local);
      classify_model_points();
    }
    fill_evidence(association_.visibility.evidence.size());
    if (has_support(cues_.evidence, options_.acceptance)) compare_appearance(white_balance);
    cues_.evidence.verdict = assess_evidence(cues_.evidence, options_.acceptance);
    if (cues_.evidence.verdict == Verdict::kCost) {
      add_costs(*association_.local);
      if (newest_view_appearance_)
        cues_.evidence.appearance.silhouette_error = newest_view_appearance_->silhouette_error(white_balance);
      cues_.evidence.score = hypothesis_score(cues_.evidence, options_.score);
    }
    return std::move(cues_);
  }

  void add_costs(const LocalScene& local) {
    claim_scene_points(local);
    excuse_noise(local);
    find_clutter(local);
    add_pierced_planes();
  }

  // The model's colours under the light of the scene.
  void adapt_model_colors(const PhotometricFit& light) {
    if (!use_color_) return;
    ColorPairs visible;
    for (const int i : association_.visibility.visible) {
      visible.model.push_back(model_.linear_light[i]);
      if (!association_.normals.empty()) visible.normals.push_back(association_.normals[i]);
    }
    lab_ = adapt_colors(visible, light);
  }

  // Takes long, and most wrong hypotheses have no support.
  void compare_appearance(const Eigen::Array3f& white_balance) {
    if (!use_color_) return;
    compare_patterns();
    newest_view_appearance_.emplace(model_, association_, views_, options_);
    cues_.evidence.appearance.newest_similarity = newest_view_appearance_->similarity(white_balance);
  }

  void compare_patterns() {
    std::vector<LabColor> own_colors;
    std::vector<LabColor> model_colors;
    std::vector<LabColor> scene_colors;
    std::vector<Eigen::Vector3f> places;
    for (const PointMatch& m : association_.nearest) {
      places.push_back(association_.points[association_.visibility.visible[m.visible]]);
      own_colors.push_back(model_.lab[association_.visibility.visible[m.visible]]);
      model_colors.push_back(lab_[m.visible]);
      scene_colors.push_back(association_.local_lab[m.local]);
    }
    const TextureMatch match =
        match_surface_texture(places, own_colors, model_colors, scene_colors, options_.appearance);
    cues_.evidence.appearance.pattern_similarity = match.similarity;
    cues_.evidence.appearance.texture_contrast = match.texture_contrast;
    cues_.evidence.appearance.shared_texture = match.shared_texture;
    if (match.texture_contrast >= kMinTextureContrast)
      cues_.evidence.appearance.hue_similarity =
          hue_similarity(places, model_colors, scene_colors, options_.appearance);
  }

  // -log of the colour similarity.
  float color_exponent(const PointMatch& m) const {
    return use_color_ ? colors_.exponent(lab_[m.visible], association_.local_lab[m.local]) : 0;
  }

  void weigh_matches(const LocalScene& local) {
    const float t = static_cast<float>(options_.support.max_distance_m);
    const float wide = t + static_cast<float>(options_.resolution_m);
    const float min_dot = static_cast<float>(std::cos(kMaxInlierAngle_rad));
    scene_weight_.assign(local.size(), 0);
    beside_model_.assign(local.size(), 1);
    fit_exponent_.assign(association_.visibility.visible.size(), std::numeric_limits<float>::infinity());
    for (const PointMatch& m : association_.matches) {
      const float dot = association_.normal_dot(m);
      if (dot <= 0) continue;
      if (dot >= min_dot) beside_model_[m.local] = 0;
      const float color = color_exponent(m);
      if (dot >= min_dot)
        fit_exponent_[m.visible] = std::min(fit_exponent_[m.visible], m.distance_sq / (2 * wide * wide) + color);
      const float upright = 1 - angle_of(dot) * (2 / std::numbers::pi_v<float>);
      if (upright <= scene_weight_[m.local]) continue;  // The exponential is at most 1.
      scene_weight_[m.local] =
          std::max(scene_weight_[m.local], upright * std::exp(-m.distance_sq / (2 * t * t) - color));
    }
  }

  // What lies in front of the model or behind its face by no more than the noise of the views is no rest of a surface.
  void excuse_noise(const LocalScene& local) {
    const auto* rule = std::get_if<ContinuationClutter>(&options_.clutter.rule);
    if (!use_normals_ || rule == nullptr) return;
    const float reach_m = std::min(static_cast<float>(rule->noise_sigmas) * association_.depth_noise_m,
                                   static_cast<float>(options_.clutter.radius_m));
    if (reach_m <= static_cast<float>(options_.support.max_distance_m)) return;
    const float beside_sq = static_cast<float>(options_.resolution_m * options_.resolution_m);
    const float min_dot = static_cast<float>(std::cos(kMaxInlierAngle_rad));
    for (const int i : association_.visibility.visible)
      local.visit_within(association_.points[i], reach_m, [&](std::size_t q, float distance_sq) {
        const float along = association_.normals[i].dot(local.point(q) - association_.points[i]);
        if (distance_sq - along * along <= beside_sq &&
            association_.normals[i].dot(association_.local_normals[q]) >= min_dot)
          beside_model_[q] = 0;
        return true;
      });
  }

  void classify_model_points() {
    const float grazing_cosine = static_cast<float>(std::cos(kGrazingAngle_rad));
    double sum_weight = 0;
    double sum_explained = 0;
    double sum_fit = 0;
    for (std::size_t v = 0; v < association_.visibility.visible.size(); ++v) {
      const double weight = association_.visibility.facing[v] < grazing_cosine ? kGrazingWeight : 1.0;
      const double fit = std::exp(-static_cast<double>(fit_exponent_[v]));
      const bool explained = fit > options_.support.min_weight && association_.visibility.seen_through[v] == 0;
      sum_weight += weight;
      if (explained) {
        ++cues_.evidence.num_explained;
        sum_explained += weight;
        sum_fit += weight * fit;
      } else {
        cues_.evidence.costs.outlier += options_.selection.outlier_weight * weight;
      }
      cues_.state[association_.visibility.visible[v]] =
          explained ? ModelPointState::kExplained : ModelPointState::kOutlier;
    }
    if (sum_weight > 0) {
      cues_.evidence.explained_share = sum_explained / sum_weight;
      cues_.evidence.fit = sum_fit / sum_weight;
    }
  }

  // The plane is larger than the object, so that it can be no face of the object alone.
  bool is_background(int scene_point) const {
    const int plane = scene_.plane[scene_point];
    return plane >= 0 && is_larger_than_object(scene_.planes[plane].extent_m, model_.diameter_m);
  }

  // The matches whose scene points lie on each plane that is larger than the object.
  std::vector<std::vector<PointMatch>> matches_on_planes(const LocalScene& local) const {
    std::vector<std::vector<PointMatch>> on_plane(scene_.planes.size());
    for (const PointMatch& m : association_.nearest) {
      const int q = local.scene_index(static_cast<std::size_t>(m.local));
      if (is_background(q)) on_plane[static_cast<std::size_t>(scene_.plane[q])].push_back(m);
    }
    return on_plane;
  }

  double shared_texture_at(const std::vector<PointMatch>& matches) const {
    std::vector<LabColor> own_colors;
    std::vector<LabColor> model_colors;
    std::vector<LabColor> scene_colors;
    for (const PointMatch& m : matches) {
      own_colors.push_back(model_.lab[association_.visibility.visible[m.visible]]);
      model_colors.push_back(lab_[m.visible]);
      scene_colors.push_back(association_.local_lab[m.local]);
    }
    return match_texture(own_colors, model_colors, scene_colors, options_.appearance).shared_texture;
  }

  // How much of what lies on each larger plane is the object's own: the faces of boxes in a row lie in one plane.
  std::vector<double> own_share_of_planes(const LocalScene& local) const {
    std::vector<double> shares(scene_.planes.size(), 0);
    const auto* rule = std::get_if<ContinuationClutter>(&options_.clutter.rule);
    if (!use_color_ || rule == nullptr || !rule->texture_contrast) return shares;
    std::ranges::transform(matches_on_planes(local), shares.begin(), [&](const std::vector<PointMatch>& matches) {
      return weigh_shared_texture(shared_texture_at(matches), *rule->texture_contrast);
    });
    return shares;
  }

  void claim_scene_points(const LocalScene& local) {
    const double plane_weight = kPlaneWeight * (use_color_ ? 0.5 : 1.0);
    const std::vector<double> own_share = own_share_of_planes(local);
    for (std::size_t q = 0; q < local.size(); ++q) {
      const float weight = scene_weight_[q];
      if (weight < kMinWeight) continue;
      const int scene_q = local.scene_index(q);
      const double share = is_background(scene_q) ? own_share[static_cast<std::size_t>(scene_.plane[scene_q])] : 1;
      cues_.evidence.costs.plane += (1 - share) * std::min<double>(weight, plane_weight);
      const auto explained = static_cast<float>(share * weight);
      if (explained < kMinWeight) continue;
      cues_.explained.push_back({scene_q, explained});
      cues_.evidence.costs.explained_scene += explained;
    }
    std::sort(cues_.explained.begin(), cues_.explained.end(),
              [](const WeightedPoint& a, const WeightedPoint& b) { return a.point < b.point; });
  }

  // Whether the surface continues from scene point p to q, in shape and colour.
  bool continues(int p, int q, const ContinuationClutter& rule) const {
    return continues_shape({scene_.points[p], scene_.normals[p]}, {scene_.points[q], scene_.normals[q]},
                           static_cast<float>(rule.max_offset_m)) &&
           (!use_color_ || continues_color(scene_.lab[p], scene_.lab[q]));
  }

  // Cost of leaving q unexplained where the surface of well explained points continues to it.
  float continuation_weight(const LocalScene& local, const LocalScene& well_explained, std::size_t q,
                            const ContinuationClutter& rule) const {
    if (beside_model_[q] == 0) return 0;  // Of another colour: the model's points there are outliers already.
    bool goes_on = false;
    well_explained.visit_within(local.point(q), static_cast<float>(options_.clutter.radius_m),
                                [&](std::size_t p, float) {
                                  goes_on = continues(well_explained.scene_index(p), local.scene_index(q), rule);
                                  return !goes_on;
                                });
    if (!goes_on) return 0;
    const double texture = rule.texture_contrast
                               ? weigh_shared_texture(cues_.evidence.appearance.shared_texture, *rule.texture_contrast)
                               : 0;
    return static_cast<float>(options_.clutter.weight * (1 - texture));
  }

  // Cost of leaving q unexplained beside the explained points around it.
  float segment_weight(const LocalScene& local, std::size_t q, const SegmentClutter& rule) const {
    const int scene_q = local.scene_index(q);
    const int segment = scene_.segment[scene_q];
    const float radius = static_cast<float>(options_.clutter.radius_m);
    const float near_weight = static_cast<float>(rule.near_weight);
    float weight = 0;
    local.visit_within(local.point(q), radius, [&](std::size_t p, float distance_sq) {
      const int scene_p = local.scene_index(p);
      if (scene_weight_[p] < kMinWeight || is_background(scene_p)) return true;
      if (segment >= 0 && scene_.segment[scene_p] == segment) {
        weight = static_cast<float>(options_.clutter.weight);
        return false;  // Nothing else can be said of it.
      }
      // A segment that is not explained at all is another surface, such as what the object stands on.
      if (segment < 0) {
        const float dot = std::max(0.0F, scene_.normals[scene_p].dot(scene_.normals[scene_q]));
        weight = std::max(weight, near_weight * dot * (1 - distance_sq / (radius * radius)));
      }
      return true;
    });
    return weight;
  }

  // The scene points that this hypothesis explains well.
  LocalScene find_well_explained(const LocalScene& local) const {
    std::vector<std::uint8_t> kept(local.size(), 0);
    for (std::size_t p = 0; p < local.size(); ++p)
      kept[p] = scene_weight_[p] >= kWellExplained && !is_background(local.scene_index(p)) ? 1 : 0;
    return local.subset(kept);
  }

  void find_clutter(const LocalScene& local) {
    if (scene_.normals.empty() || cues_.explained.empty()) return;
    const auto* continuation = std::get_if<ContinuationClutter>(&options_.clutter.rule);
    const auto* segments = std::get_if<SegmentClutter>(&options_.clutter.rule);
    std::optional<LocalScene> well_explained;
    if (continuation != nullptr) well_explained.emplace(find_well_explained(local));
    for (std::size_t q = 0; q < local.size(); ++q) {
      if (scene_weight_[q] >= kMinWeight || is_background(local.scene_index(q))) continue;
      const float weight = continuation != nullptr ? continuation_weight(local, *well_explained, q, *continuation)
                                                   : segment_weight(local, q, *segments);
      if (weight < kMinWeight) continue;
      cues_.clutter.push_back({local.scene_index(q), weight});
      cues_.evidence.costs.clutter += weight;
    }
    std::sort(cues_.clutter.begin(), cues_.clutter.end(),
              [](const WeightedPoint& a, const WeightedPoint& b) { return a.point < b.point; });
  }

  // The smaller of the two parts that a plane cuts the model into, over the part of the plane that was seen.
  void add_pierced_planes() {
    const float clearance = static_cast<float>(options_.support.max_distance_m);
    std::vector<float> distances(association_.points.size());
    for (const ScenePlane& plane : scene_.planes) {
      if (!is_larger_than_object(plane.extent_m, model_.diameter_m)) continue;
      std::ranges::transform(association_.points, distances.begin(),
                             [&](const auto& p) { return plane.signed_distance(p); });
      const auto [lowest, highest] = std::ranges::minmax(distances);
      if (lowest >= -clearance || highest <= clearance) continue;
      int above = 0;
      int below = 0;
      for (std::size_t i = 0; i < association_.points.size(); ++i) {
        if (std::abs(distances[i]) <= clearance || !plane.covers(association_.points[i])) continue;
        ++(distances[i] > 0 ? above : below);
      }
      cues_.evidence.costs.plane += std::min(above, below);
    }
  }

  void fill_evidence(std::size_t num_views) {
    HypothesisEvidence& evidence = cues_.evidence;
    evidence.num_visible = static_cast<int>(association_.visibility.visible.size());
    evidence.visible_share = association_.points.empty() ? 0
                                                         : static_cast<double>(evidence.num_visible) /
                                                               static_cast<double>(association_.points.size());
    const auto num_seen_through = std::ranges::count(association_.visibility.seen_through, 1);
    evidence.seen_through_share =
        evidence.num_visible == 0 ? 0 : static_cast<double>(num_seen_through) / evidence.num_visible;
    evidence.visible_share_per_view.assign(num_views, 0);
    evidence.explained_share_per_view.assign(num_views, 0);
    for (std::size_t view = 0; view < num_views; ++view) {
      int visible = 0;
      int explained = 0;
      for (std::size_t i = 0; i < association_.visibility.evidence[view].size(); ++i) {
        const Evidence point = association_.visibility.evidence[view][i];
        if (!is_observed(point)) continue;
        ++visible;
        if (point == Evidence::kPresent && cues_.state[i] == ModelPointState::kExplained) ++explained;
      }
      if (visible == 0) continue;
      evidence.visible_share_per_view[view] =
          static_cast<float>(visible) / static_cast<float>(association_.points.size());
      evidence.explained_share_per_view[view] = static_cast<float>(explained) / static_cast<float>(visible);
    }
  }

  const PreparedModel& model_;
  const PreparedScene& scene_;
  std::span<const DepthView> views_;
  const VerifyOptions& options_;
  ColorTolerance colors_;
  bool use_normals_;
  bool use_color_;
  SceneAssociation association_;
  std::optional<NewestViewAppearance> newest_view_appearance_;
  std::vector<LabColor> lab_;               // Per visible point, under the scene's light.
  std::vector<float> scene_weight_;         // Per local scene point.
  std::vector<std::uint8_t> beside_model_;  // Per local scene point: no visible model point of similar normal is near,
                                            // nor as near as noise explains.
  std::vector<float> fit_exponent_;         // Per visible point: -log of its best fit.
  HypothesisCues cues_;
};

CueComputer::CueComputer(const PreparedModel& model, const Rigid3& world_from_object,
                         std::span<const Correspondence> correspondences, const PreparedScene& scene,
                         std::span<const DepthView> views, std::span<const std::uint8_t> allowed,
                         const VerifyOptions& options)
    : impl_(std::make_unique<Impl>(model, world_from_object, correspondences, scene, views, allowed, options)) {}
CueComputer::~CueComputer() = default;
CueComputer::CueComputer(CueComputer&&) noexcept = default;

const PhotometricFit& CueComputer::light() const { return impl_->association_.light; }
HypothesisCues CueComputer::finish(const Eigen::Array3f& white_balance) { return impl_->finish(white_balance); }

}  // namespace resight
