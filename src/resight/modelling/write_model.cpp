// SPDX-License-Identifier: Apache-2.0
#include "resight/modelling/write_model.hpp"

#include <cmath>
#include <nlohmann/json.hpp>
#include <system_error>

#include "resight/core/files.hpp"
#include "resight/io/ply.hpp"
#include "resight/io/tuw_models.hpp"

namespace resight {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

ordered_json number_or_null(double value) { return std::isnan(value) ? ordered_json(nullptr) : ordered_json(value); }

ordered_json vector_json(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

ordered_json report_json(const ModelReport& r) {
  return {{"format", "resight model report 1"},
          {"num_views", r.num_views},
          {"num_key_views", r.num_key_views},
          {"extent_m", vector_json(r.extent_m)},
          {"diameter_m", r.diameter_m},
          {"coverage",
           {{"share", r.coverage.share},
            {"share_above", r.coverage.share_above},
            {"share_below", r.coverage.share_below},
            {"largest_gap", vector_json(r.coverage.largest_gap)},
            {"largest_gap_rad", r.coverage.largest_gap_rad}}},
          {"holes",
           {{"count", r.holes.count},
            {"boundary_length_m", r.holes.boundary_length_m},
            {"area_sq_m", r.holes.area_sq_m},
            {"open_share", r.holes.open_share}}},
          {"keypoints_per_view", r.keypoints_per_view},
          {"no_return_share", r.no_return_share},
          {"thin_share", r.thin_share},
          {"num_symmetry_axes", r.symmetries.continuous.size()},
          {"num_symmetry_motions", r.symmetries.discrete.size()},
          {"closure_error_m", number_or_null(r.closure_error_m)},
          {"warnings", r.troubles}};
}

// write_tuw_model() creates a folder with the model's name; this moves its contents up into ours.
Result<void> write_views(const fs::path& folder, std::span<const TrainingView> views, const PointCloud& cloud,
                         const DeclaredModelInfo& declared) {
  if (auto done = write_tuw_model(folder, "model", views, &cloud, declared.symmetries, declared.bop_id,
                                  declared.symmetries_known);
      !done)
    return done;
  for (const char* part : {"views", "3D_model.pcd", "model_info.json"}) {
    std::error_code failure;
    fs::rename(folder / "model" / part, folder / part, failure);
    if (failure == std::errc::no_such_file_or_directory) continue;
    if (failure) return file_error(folder / part, failure.message());
  }
  std::error_code ignored;
  fs::remove(folder / "model", ignored);
  return {};
}

}  // namespace

Result<void> write_object_model(const fs::path& directory, std::span<const TrainingView> views,
                                const ObjectModelBuild& build, const DeclaredModelInfo& declared) {
  auto pending = PendingDirectory::create(directory);
  if (!pending) return pending.error();
  std::vector<TrainingView> key_views;
  for (const int i : build.key_views) {
    key_views.push_back(views[i]);
    key_views.back().frame.name.clear();  // Numbered from 0, because two recordings may use the same names.
  }
  if (auto done = write_views(pending->path(), key_views, build.cloud, declared); !done) return done;
  if (auto done = write_ply(pending->path() / "mesh.ply", build.mesh); !done) return done;
  const std::string report = report_json(build.report).dump(1) + "\n";
  if (auto done = write_file(pending->path() / "model_report.json", report); !done) return done;
  return pending->commit();
}

}  // namespace resight
