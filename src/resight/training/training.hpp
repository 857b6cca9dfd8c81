// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>

#include "resight/core/options.hpp"
#include "resight/core/result.hpp"
#include "resight/features/shot.hpp"
#include "resight/features/sift.hpp"
#include "resight/geometry/triangle_mesh.hpp"
#include "resight/models/object_model.hpp"
#include "resight/rendering/turntable.hpp"
#include "resight/training/feature_reduction.hpp"
#include "resight/training/symmetry_detection.hpp"

namespace resight {

struct TrainOptions {
  SiftOptions sift{};
  /// On an object every keypoint counts.
  ShotOptions shot{.min_surface_variation = 0.0, .max_keypoint_depth_m = std::nullopt};
  double surface_voxel_m = 0.003;
  TurntableOptions turntable{};
  double min_edge_distance_px = 2.0;
  FeatureMerging sift_merging{.max_distance_m = 0.005, .max_descriptor_distance = 0.4};
  FeatureMerging shot_merging{.max_distance_m = 0.007, .max_descriptor_distance = 0.4};
  bool find_symmetries = true;
  SymmetryOptions symmetry{};
  int num_threads = 1;  ///< Not part of the hash: the bytes do not depend on it.
  void check() const { check_options("TrainOptions", *this); }
  [[nodiscard]] std::uint64_t hash() const;  ///< Of every field that changes the result, and of the format version.
};

inline void declare(OptionVisitor& v, TrainOptions& o) {
  v.group("sift", o.sift);
  v.group("shot", o.shot);
  v.field("surface_voxel_m", o.surface_voxel_m, positive(), "Voxel of the models' surfaces.", "V4R");
  v.group("turntable", o.turntable);
  v.field("min_edge_distance_px", o.min_edge_distance_px, at_least(0),
          "Surface points nearer to a depth edge of a training view are not used. 0: all are.");
  v.group("sift_merging", o.sift_merging);
  v.group("shot_merging", o.shot_merging);
  v.field("find_symmetries", o.find_symmetries, "Of objects whose source does not declare theirs.");
  v.group("symmetry", o.symmetry);
  v.num_threads(o.num_threads);
}

/// Features of one object, before they are coded.
struct ObjectFeatures {
  FeatureSet sift{.type = FeatureType::kSift, .dimension = 128, .points = {}, .normals = {}, .descriptors = {}};
  FeatureSet shot{.type = FeatureType::kShot, .dimension = 352, .points = {}, .normals = {}, .descriptors = {}};
};

/// Trains from registered views (frame.world_from_camera is object_from_camera; mask: non-zero = object). Extracts SIFT
/// and SHOT of each view in the object frame, merges them (TrainOptions.*_merging) and stores them with 8 bits per
/// component (coded_features.hpp). Fuses the surface weighted by sensor noise. The caller must set symmetries and
/// bop_id, as train_object(ModelSource) does.
///
/// The model omits unknown colours (the same colour in all pixels of all views; a mesh with neither texture nor vertex
/// colours; a cloud with no or only one colour). It then omits SIFT as well, and the object is recognised by its shape
/// alone.
///
/// Errors name the object and the view: no views, an invalid frame or mask size, no object pixel with depth and normal
/// in any view, or no feature in any view (one kind is enough).
[[nodiscard]] Result<ObjectModel> train_object(const std::string& name, std::span<const TrainingView> views,
                                               const TrainOptions& options = {});

/// Trains from a mesh: ray-casts its views and samples its surface from all triangles, including hidden ones.
/// Additional errors: no triangles, invalid indices or coordinates, or a diameter outside [5 mm, 5 m], which indicates
/// a wrong unit.
[[nodiscard]] Result<ObjectModel> train_object(const std::string& name, const TriangleMesh& mesh,
                                               const TrainOptions& options = {});

/// Trains from a cloud of the whole surface. Missing normals are estimated (estimate_outward_normals()); given ones are
/// oriented outwards as a whole. Views are ray-cast from a splat per point (make_splat_mesh()). Additional errors:
/// points that are not finite, too few points, or a diameter outside [5 mm, 5 m].
[[nodiscard]] Result<ObjectModel> train_object(const std::string& name, const PointCloud& cloud,
                                               const TrainOptions& options = {});

/// What train_object() refuses before it begins: views without a pixel of the object, of an invalid frame or mask size;
/// a mesh or a cloud that it cannot use. Takes little time.
[[nodiscard]] Result<void> check_training_input(const std::string& name, std::span<const TrainingView> views);
[[nodiscard]] Result<void> check_training_input(const std::string& name, const TriangleMesh& mesh);
[[nodiscard]] Result<void> check_training_input(const std::string& name, const PointCloud& cloud);

/// Extracts and merges only the features, as train_object() does before it codes them.
[[nodiscard]] Result<ObjectFeatures> train_features(const std::string& name, std::span<const TrainingView> views,
                                                    const TrainOptions& options = {});

/// Samples only the surface of a mesh, as train_object() does after the same checks.
[[nodiscard]] Result<PointCloud> train_surface(const std::string& name, const TriangleMesh& mesh,
                                               const TrainOptions& options = {});
/// Computes only the surface of a cloud of the whole surface. Keeps its colours even if they are all the same.
[[nodiscard]] Result<PointCloud> train_surface(const std::string& name, const PointCloud& cloud,
                                               const TrainOptions& options = {});

}  // namespace resight
