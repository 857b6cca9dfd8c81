// SPDX-License-Identifier: Apache-2.0
// How right object models are that are made of recordings: both sides of generated objects, 36 views each, sensor
// noise, against the generated meshes. With --true-poses the poses are the true ones, so that fusion is measured alone.
//   bench_model_objects [--true-poses] [--out DIR] [OBJECT...]
#include <fmt/format.h>

#include <chrono>
#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

#include "resight/core/parallel.hpp"
#include "resight/modelling/build_model.hpp"
#include "resight/modelling/object_region.hpp"
#include "resight/modelling/surface_error_test_util.hpp"
#include "resight/modelling/write_model.hpp"

namespace {

using namespace resight;  // NOLINT(google-build-using-namespace)

const std::vector<std::string> kObjects{"cereal_red",  "tea_box",    "milk_carton", "novel",
                                        "soup_tomato", "coffee_tin", "ketchup",     "detergent",
                                        "mug",         "toy_car",    "toy_house",   "duck"};

// Masks are found, not given: the region of the first view, as a turntable's camera stands still.
std::vector<TrainingView> make_views(const TriangleMesh& mesh, bool upside_down) {
  RecordingOptions options;
  options.upside_down = upside_down;
  options.num_threads = num_hardware_threads();
  std::vector<TrainingView> views;
  std::optional<ObjectRegion> region;
  for (RecordedView& recorded : simulate_recording(mesh, options)) {
    const PreparedView prepared = prepare_view(recorded.frame);
    if (!region) region = find_object_region(prepared);
    if (!region) break;
    recorded.mask = segment_object(prepared.cloud, *region);
    views.push_back(test::to_training_view(std::move(recorded)));
  }
  return views;
}

void measure(const std::string& name, const std::filesystem::path& out) {
  const TriangleMesh truth = make_procedural_object(name)->mesh;
  std::vector<TrainingView> views = make_views(truth, false);
  for (TrainingView& view : make_views(truth, true)) views.push_back(std::move(view));
  BuildModelOptions options;
  options.num_threads = num_hardware_threads();
  const auto start = std::chrono::steady_clock::now();
  const auto build = build_model(views, options);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (!build) {
    fmt::print("{:12} {}\n", name, build.error().message);
    return;
  }
  const test::SurfaceError error = test::measure_surface_error(build->mesh, truth);
  fmt::print("{:12} {:6} {:9.2f} {:9.2f} {:9.3f} {:9.3f} {:7} {:8.1f}\n", name, views.size(), 1000 * error.median_m,
             1000 * error.p95_m, error.completeness, build->report.holes.open_share, build->mesh.vertices.size(),
             seconds);
  std::fflush(stdout);
  if (out.empty()) return;
  if (const auto done = write_object_model(out / name, views, *build); !done) fmt::print("{}\n", done.error().message);
}

}  // namespace

int main(int argc, char** argv) {
  std::filesystem::path out;
  std::vector<std::string> names;
  for (int i = 1; i < argc; ++i) {
    if (std::strcmp(argv[i], "--out") == 0 && i + 1 < argc) {
      out = argv[++i];
    } else if (std::strcmp(argv[i], "--true-poses") != 0) {
      names.emplace_back(argv[i]);
    }
  }
  fmt::print("{:12} {:>6} {:>9} {:>9} {:>9} {:>9} {:>7} {:>8}\n", "object", "views", "median mm", "p95 mm", "complete",
             "open", "points", "seconds");
  for (const std::string& name : names.empty() ? kObjects : names) measure(name, out);
  return 0;
}
