// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>

#include "resight/core/result.hpp"
#include "resight/features/shot.hpp"
#include "resight/features/sift.hpp"
#include "resight/geometry/triangle_mesh.hpp"
#include "resight/models/object_model.hpp"
#include "resight/rendering/turntable.hpp"
#include "resight/sensor/rgbd_frame.hpp"
#include "resight/training/feature_reduction.hpp"
#include "resight/training/symmetry_detection.hpp"

namespace resight {

struct TrainOptions {
  SiftOptions sift;
  ShotOptions shot{.min_surface_variation = 0.0};  ///< On an object every keypoint counts.
  double surface_voxel_m = 0.003;                  ///< V4R voxelises models at 3 mm.
  TurntableOptions turntable;                      ///< For meshes: the views they are ray-cast from.
  double min_edge_distance_px = 2.0;               ///< Surface points nearer to a depth discontinuity are not used.
  FeatureMerging sift_merging{.max_distance_m = 0.005, .max_descriptor_distance = 0.4};
  FeatureMerging shot_merging{.max_distance_m = 0.007, .max_descriptor_distance = 0.4};
  bool find_symmetries = true;  ///< Of objects whose source does not declare theirs.
  SymmetryOptions symmetry;     ///< How; its num_threads does not count.
  int num_threads = 1;          ///< Not part of the hash: the bytes do not depend on it.
  void check() const;
  [[nodiscard]] std::uint64_t hash() const;  ///< Of every field that changes the result, and of the format version.
};

/// The parts of an object that its training can be given by itself.
struct ObjectFeatures {
  FeatureSet sift{.type = FeatureType::kSift, .dimension = 128, .points = {}, .normals = {}, .descriptors = {}};
  FeatureSet shot{.type = FeatureType::kShot, .dimension = 352, .points = {}, .normals = {}, .descriptors = {}};
};

/// Trains from registered views (frame.world_from_camera is object_from_camera; mask: non-zero = object): SIFT and SHOT
/// of each view in the object frame, merged (TrainOptions.*_merging) and at 8 bits a component (coded_features.hpp),
/// and the surface fused by sensor noise. Symmetries and bop_id are the caller's to set (train_object() of a
/// ModelSource does).
///
/// Colours that are not known (the same in every pixel of all views, a mesh with neither texture nor vertex colours, a
/// cloud with none or one) are left out of the model, and so is SIFT: it is then recognised by its shape alone.
///
/// An error, which names the object and the view: no views, a bad frame or mask size, no object pixel with depth and
/// normal in any view, and an object none of whose views has a feature (one kind is enough).
[[nodiscard]] Result<ObjectModel> train_object(const std::string& name, std::span<const TrainingView> views,
                                               const TrainOptions& options = {});

/// Trains from a mesh: its views are ray-cast, its surface is sampled from all its triangles (also those that no view
/// sees). An error besides the above: no triangles, bad indices or coordinates, or a diameter outside [5 mm, 5 m],
/// which is the sign of a wrong unit.
[[nodiscard]] Result<ObjectModel> train_object(const std::string& name, const TriangleMesh& mesh,
                                               const TrainOptions& options = {});

/// Trains from a cloud of the whole surface, with or without normals (estimate_outward_normals(); given ones are turned
/// outwards as a whole): its views are ray-cast from a splat of each point (make_splat_mesh()). An error: points that
/// are not finite, too few points, or a diameter as above.
[[nodiscard]] Result<ObjectModel> train_object(const std::string& name, const PointCloud& cloud,
                                               const TrainOptions& options = {});

/// The features alone, as train_object() extracts and merges them, before they are coded.
[[nodiscard]] Result<ObjectFeatures> train_features(const std::string& name, std::span<const TrainingView> views,
                                                    const TrainOptions& options = {});

/// The surface of a mesh as train_object() samples it, after the same checks.
[[nodiscard]] Result<PointCloud> train_surface(const std::string& name, const TriangleMesh& mesh,
                                               const TrainOptions& options = {});
/// The same of a cloud of the whole surface.
[[nodiscard]] Result<PointCloud> train_surface(const std::string& name, const PointCloud& cloud,
                                               const TrainOptions& options = {});

}  // namespace resight
