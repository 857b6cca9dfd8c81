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

/// Eight samples of a surface side by side, for vector instructions. Places that are not filled have no normal.
struct SampleBlock {
  static constexpr int kSize = 8;
  std::array<float, kSize> x{}, y{}, z{}, nx{}, ny{}, nz{};
};

/// An object as poses of it are tested: samples of its surface, any first part of them spread over all of it. Object
/// frame.
struct SampledModel {
  std::vector<Eigen::Vector3f> points;
  std::vector<Eigen::Vector3f> normals;
  std::vector<SampleBlock> blocks;            ///< Both again.
  std::vector<Eigen::Vector3f> linear_light;  ///< Empty if its colours are not known.
  std::vector<Eigen::Vector2f> chroma;        ///< chroma() of the same, under the white balance that was set; as many
                                              ///< as the blocks have places.
  Eigen::Vector3f center = Eigen::Vector3f::Zero();
  double radius_m = 0;  ///< About the centre.
  float diameter_m = 0;
  float spacing_m = 0;  ///< Of the samples.
};

/// Samples about a twentieth of the diameter apart, at most `max_samples`; none if the surface has no normals.
[[nodiscard]] SampledModel make_sampled_model(const ObjectModel& model, int max_samples);

struct CountSamplesOptions {
  int max_samples = 40;  ///< That face the camera: counting stops with the block that has them.
  int max_wrong = 5;     ///< Beside a quarter of those seen so far: with more, counting stops.
  DepthMargin margin{.base_m = 0.009, .noise_sigmas = 3};  ///< At the depth of the object's centre.
  double max_chroma_difference = 0.3;  ///< Of a* and b*, each over L* + 26: the light is not known yet.
  void check() const;
};

/// What a view says about the samples of an object at a pose.
struct SampleCounts {
  int facing = 0;        ///< Turned to the camera; of these:
  int confirmed = 0;     ///< At the measured depth,
  int wrong_color = 0;   ///< of which of another hue.
  int seen_through = 0;  ///< The camera looks through them, or a plane that is larger than the object lies there.
  int occluded = 0;      ///< Behind what was measured, or outside the image.
  bool gave_up = false;  ///< Too many wrong (off_color, through), or a score too low: the rest was not counted.
  /// In [-1, 1): share of the samples that the view confirms, less what speaks against the pose. Hidden ones count
  /// little.
  [[nodiscard]] float score() const {
    constexpr float kOccludedWeight = 0.4F;
    constexpr float kPrior = 3;
    return static_cast<float>(confirmed - wrong_color - seen_through) /
           (static_cast<float>(confirmed + seen_through) + kOccludedWeight * static_cast<float>(occluded) + kPrior);
  }
};

/// How well a pose fits a view.
struct PoseFit {
  double explained_share = 0;  ///< Confirmed by depth, normal and (in the fitted light) colour, of those not hidden and
                               ///< of what goes on beyond the object where it should end.
  double visible_share = 0;    ///< Not hidden, of those that face the camera.
  double pattern_similarity = 1;
  int num_explained = 0;
  /// None of its numbers is less.
  [[nodiscard]] bool reaches(const PoseFit& least) const {
    return explained_share >= least.explained_share && visible_share >= least.visible_share &&
           pattern_similarity >= least.pattern_similarity && num_explained >= least.num_explained;
  }
};
inline constexpr PoseFit kAnyFit{.pattern_similarity = -1};

/// Tests poses in one view. The view must outlive it; camera frame.
class PoseScorer {
 public:
  /// `planes`: of the view, camera frame. What lies on one that is larger than an object is not the object's.
  PoseScorer(const PreparedView& view, std::span<const ScenePlane> planes, int num_threads);

  [[nodiscard]] const PreparedView& view() const { return view_; }
  /// Pixel under a point; -1 outside the image.
  [[nodiscard]] int pixel_of(const Eigen::Vector3f& point_in_camera) const;
  /// chroma() of a pixel.
  [[nodiscard]] const Eigen::Vector2f& chroma_at(int pixel) const {
    return pixels_[static_cast<std::size_t>(pixel)].chroma;
  }

  /// Non-zero where no plane lies that is larger than objects of this diameter: where keypoints may be theirs.
  [[nodiscard]] Image<std::uint8_t> off_larger_planes(float diameter_m) const;

  /// The first test: quick, of rough poses. It gives up on those that will hardly reach `min_score`.
  [[nodiscard]] SampleCounts score_coarse(const SampledModel& model, const Rigid3f& camera_from_object,
                                          const CountSamplesOptions& options, double min_score = -1) const;
  /// Point-to-plane ICP with the scene points in the same pixels (Blais and Levine 1995). The pose as far as it got.
  [[nodiscard]] Rigid3 refine(const SampledModel& model, const Rigid3& camera_from_object, int max_iterations,
                              double max_distance_m) const;
  /// The light on the object at a pose that is known to be about right (photometric_fit.hpp); its chroma is not
  /// limited.
  [[nodiscard]] PhotometricFit fit_photometry(const SampledModel& model, const Rigid3& camera_from_object,
                                              const DepthMargin& margin, const PhotometricLimits& limits) const;
  /// Whether the last test, without colours and what goes on beyond the object, would reach `least`.
  [[nodiscard]] bool fits_in_shape(const SampledModel& model, const Rigid3& camera_from_object,
                                   const DepthMargin& margin, const PoseFit& least) const;
  /// The last test: all samples, their colours in the light that fits them best (photometric_fit.hpp). What cannot
  /// reach `least` is not looked at to the end: its fit is then better than it should be, but does not reach it either.
  [[nodiscard]] PoseFit score_fine(const SampledModel& model, const Rigid3& camera_from_object,
                                   const DepthMargin& margin, const MatchCriteria& criteria,
                                   const PoseFit& least = kAnyFit) const;

 private:
  // The samples of a pose that depth and normal confirm, and how many they do not.
  struct Confirmed {
    std::vector<int> samples;
    std::vector<std::size_t> pixels;
    ColorPairs colors;                     // Empty if the model has no colours. Normals: camera frame.
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
  void compare_colors(const Confirmed& confirmed, const MatchCriteria& criteria, PoseFit& fit) const;
  [[nodiscard]] double count_continuing(const SampledModel& model, const Confirmed& confirmed,
                                        const MatchCriteria& criteria) const;
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

/// a* and b* over L* + 26: what is darker has less of both, and hence the same of it (but for the dark, whose hue is
/// noise). The first test compares colours by it, since the light is not known yet.
[[nodiscard]] inline Eigen::Vector2f chroma(const LabColor& color) {
  const float scale = 128 / (50 * color.l + 76);
  return {scale * color.a, scale * color.b};
}

}  // namespace resight
