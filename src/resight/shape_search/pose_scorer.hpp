// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "resight/appearance/appearance_match.hpp"
#include "resight/evidence/surface_evidence.hpp"
#include "resight/geometry/rigid3.hpp"
#include "resight/models/object_model.hpp"
#include "resight/registration/point_to_plane.hpp"
#include "resight/segmentation/scene_planes.hpp"
#include "resight/sensor/prepared_view.hpp"
#include "resight/shape_search/match_criteria.hpp"

namespace resight {

/// Eight contiguous samples of a surface, for vector instructions. Unused entries have no normal.
struct SampleBlock {
  static constexpr int kSize = 8;
  std::array<float, kSize> x{}, y{}, z{}, nx{}, ny{}, nz{};
};

/// Samples of an object's surface for scoring poses. Any prefix covers the whole surface. Object frame.
struct SampledModel {
  std::vector<Eigen::Vector3f> points;
  std::vector<Eigen::Vector3f> normals;
  std::vector<SampleBlock> blocks;            ///< The same points and normals.
  std::vector<Rgb8> colors;                   ///< Empty if they are not known or not used.
  std::vector<Eigen::Vector3f> linear_light;  ///< Of these colours.
  /// chroma() of the same, under the white balance that was set; padded to whole blocks.
  std::vector<Eigen::Vector2f> chroma;
  Eigen::Vector3f center = Eigen::Vector3f::Zero();
  double radius_m = 0;  ///< About the centre.
  float diameter_m = 0;
  float spacing_m = 0;  ///< Of the samples.
};

/// Samples about a twentieth of the diameter apart, at most `max_samples`; none if the surface has no normals.
[[nodiscard]] SampledModel make_sampled_model(const ObjectModel& model, int max_samples);
/// The same with colours as a camera without chromaticity shows them (to_grey()).
[[nodiscard]] SampledModel to_grey(SampledModel model);

struct CountSamplesOptions {
  int max_samples = 40;  ///< That face the camera: counting stops with the block that has them.
  int max_wrong = 5;     ///< Counting stops with more wrong samples than this plus a quarter of those seen.
  DepthMargin margin{.base_m = 0.009, .noise_sigmas = 3};  ///< At the depth of the object's centre.
  double max_chroma_difference = 0.3;  ///< Of a* and b*, each over L* + 26: the light is not known yet.
  void check() const;
};

/// What a view says about the samples of an object at a pose.
struct SampleCounts {
  int facing = 0;        ///< Facing the camera. Of these:
  int confirmed = 0;     ///< Present.
  int wrong_color = 0;   ///< Present, but of another chromaticity.
  int seen_through = 0;  ///< Seen through, or on a plane larger than the object.
  int occluded = 0;      ///< Occluded, or outside the image.
  bool gave_up = false;  ///< Stopped early: too many wrong samples, or too low a score.
  /// In [-1, 1): confirmed minus contradicting samples, as a share. Occluded samples count little.
  [[nodiscard]] float score() const {
    constexpr float kOccludedWeight = 0.4F;  // Occlusion neither confirms nor contradicts, but is often a wrong pose.
    constexpr float kPrior = 3;              // Samples: few of them give no high score.
    return static_cast<float>(confirmed - wrong_color - seen_through) /
           (static_cast<float>(confirmed + seen_through) + kOccludedWeight * static_cast<float>(occluded) + kPrior);
  }
};

/// How well a pose fits a view.
struct PoseFit {
  /// Confirmed by depth, normal and fitted colour, of the samples that are not occluded and of the surface that
  /// continues beyond the object.
  double explained_share = 0;
  double visible_share = 0;  ///< Not occluded, of those that face the camera.
  double pattern_similarity = 1;
  int num_explained = 0;
  /// Whether every number is at least that of `least`.
  [[nodiscard]] bool reaches(const PoseFit& least) const {
    return explained_share >= least.explained_share && visible_share >= least.visible_share &&
           pattern_similarity >= least.pattern_similarity && num_explained >= least.num_explained;
  }
};
inline constexpr PoseFit kAnyFit{.pattern_similarity = -1};

/// Tests poses in one view. The view must outlive it; camera frame.
class PoseScorer {
 public:
  /// `planes`: of the view, camera frame. Pixels on a plane larger than an object do not belong to it,
  /// unless they share its texture (MatchCriteria::texture_contrast).
  PoseScorer(const PreparedView& view, std::span<const ScenePlane> planes, int num_threads);

  [[nodiscard]] const PreparedView& view() const { return view_; }
  /// Pixel under a point; -1 outside the image.
  [[nodiscard]] int pixel_of(const Eigen::Vector3f& point_in_camera) const;
  /// chroma() of a pixel.
  [[nodiscard]] const Eigen::Vector2f& chroma_at(int pixel) const {
    return pixels_[static_cast<std::size_t>(pixel)].chroma;
  }

  /// Non-zero where the shape may be that of objects of this diameter: not on a larger plane.
  [[nodiscard]] Image<std::uint8_t> off_larger_planes(float diameter_m) const;

  /// Coarse score of a rough pose. Stops if `min_score` is out of reach.
  [[nodiscard]] SampleCounts score_coarse(const SampledModel& model, const Rigid3f& camera_from_object,
                                          const CountSamplesOptions& options, double min_score = -1) const;
  /// Point-to-plane ICP with the scene points in the same pixels (Blais and Levine 1995). The pose as far as it got.
  [[nodiscard]] Rigid3 refine(const SampledModel& model, const Rigid3& camera_from_object, int max_iterations,
                              double max_distance_m) const;
  /// Photometric fit of the object at a pose that is about right (photometric_fit.hpp); its chromaticity is not
  /// limited.
  [[nodiscard]] PhotometricFit fit_photometry(const SampledModel& model, const Rigid3& camera_from_object,
                                              const DepthMargin& margin, const PhotometricLimits& limits) const;
  /// Whether the pose can reach `least` by depth and normals alone.
  [[nodiscard]] bool fits_in_shape(const SampledModel& model, const Rigid3& camera_from_object,
                                   const DepthMargin& margin, const PoseFit& least) const;
  /// Fine score: all samples, with fitted colours (photometric_fit.hpp). Stops early if `least` is out of reach; the
  /// result is then an upper bound that does not reach it.
  [[nodiscard]] PoseFit score_fine(const SampledModel& model, const Rigid3& camera_from_object,
                                   const DepthMargin& margin, const MatchCriteria& criteria,
                                   const PoseFit& least = kAnyFit) const;

 private:
  // Samples that depth and normal confirm.
  struct SeenSamples {
    std::vector<std::size_t> pixels;
    ColorPairs colors;  // Empty if the model has no colours. Normals: camera frame.
  };
  // The samples of a pose that depth and normal confirm, and how many they do not.
  struct Confirmed : SeenSamples {
    SeenSamples on_plane;                  // Those on a plane larger than the object.
    std::vector<Eigen::Vector2f> outline;  // Pixels of all that face the camera.
    int facing = 0;
    int occluded = 0;
    int wrong = 0;
  };
  // Eight samples at a pose, and the pixels they fall into.
  struct PosedBlock {
    SampleBlock samples;                         // Camera frame.
    std::array<int, SampleBlock::kSize> faces;   // The camera: 1.
    std::array<int, SampleBlock::kSize> inside;  // The image: 1.
    std::array<int, SampleBlock::kSize> column;  // Of the pixel; the first if outside.
    std::array<int, SampleBlock::kSize> row;
    std::array<int, SampleBlock::kSize> pixel;
  };
  [[nodiscard]] PosedBlock project(const SampleBlock& block, const Rigid3f& camera_from_object) const;
  [[nodiscard]] StepEquations linearize(const SampledModel& model, const Rigid3& camera_from_object,
                                        double max_distance_m) const;
  [[nodiscard]] Confirmed confirm(const SampledModel& model, const Rigid3& camera_from_object,
                                  const DepthMargin& margin) const;
  void confirm_sample(const SampledModel& model, std::size_t sample, const PosedBlock& posed, std::size_t k,
                      float margin_m, Confirmed& confirmed) const;
  [[nodiscard]] static PoseFit shape_fit(const Confirmed& confirmed);
  [[nodiscard]] bool shares_texture(const SeenSamples& samples, const MatchCriteria& criteria) const;
  void assign_planes(Confirmed& confirmed, bool belong_to_object) const;
  [[nodiscard]] std::vector<LabColor> lab_of(const SeenSamples& samples) const;
  void compare_colors(const Confirmed& confirmed, const MatchCriteria& criteria, PoseFit& fit) const;
  [[nodiscard]] double count_continuing(const SampledModel& model, const Confirmed& confirmed, bool use_color) const;
  [[nodiscard]] float margin_at_center(const SampledModel& model, const Rigid3f& camera_from_object,
                                       const DepthMargin& margin) const;

  // What the coarse test reads of a pixel, contiguous in memory.
  struct Pixel {
    float z_m = 0;             // NaN: no return.
    float plane_extent_m = 0;  // Of the plane that it lies on; 0: none.
    Eigen::Vector2f chroma = Eigen::Vector2f::Zero();
  };
  // What the refinement reads of a pixel.
  struct OrientedPixel {
    float z_m = 0;
    float nx = 0, ny = 0, nz = 0;  // NaN: no normal.
    [[nodiscard]] Eigen::Vector3f normal() const { return {nx, ny, nz}; }
  };

  const PreparedView& view_;
  Image<Pixel> pixels_;
  Image<OrientedPixel> oriented_;
  Image<LabColor> lab_;
  float fx_, fy_, cx_, cy_;  // Of the camera; centres with half a pixel, so that truncation finds the pixel.
};

/// The chromaticities of the samples for the coarse test, under the white balance of the scene
/// (PhotometricFit::chroma()).
void set_white_balance(SampledModel& model, const Eigen::Array3f& white_balance);

/// Chromaticity as a* and b* over L* + 26, nearly independent of brightness except for dark colours. Used by the coarse
/// score, where the light is unknown.
[[nodiscard]] inline Eigen::Vector2f chroma(const LabColor& color) {
  const float scale = 128 / (50 * color.l + 76);
  return {scale * color.a, scale * color.b};
}

/// Whether two chroma() differ by at most this.
[[nodiscard]] inline bool is_similar_chroma(const Eigen::Vector2f& a, const Eigen::Vector2f& b, float max_difference) {
  return (a - b).squaredNorm() <= max_difference * max_difference;
}

}  // namespace resight
