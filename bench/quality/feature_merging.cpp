// SPDX-License-Identifier: Apache-2.0
// Costs and benefits of training views and of merging repeated features: `bench_feature_merging [MODELS]` (a path as
// for `resight train`; default: procedural objects). Features of held-out views (between the training views, at another
// elevation and several distances, with sensor noise) are matched exactly against all objects together. A match is
// right if its model point belongs to the same object and is within 1 cm of the truth.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <iterator>
#include <numbers>

#include "resight/core/parallel.hpp"
#include "resight/features/coded_features.hpp"
#include "resight/io/model_source.hpp"
#include "resight/rendering/turntable.hpp"
#include "resight/sensor/prepared_view.hpp"
#include "resight/simulation/procedural_objects.hpp"
#include "resight/training/training.hpp"

namespace {

using namespace resight;
using Matrix = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

constexpr std::size_t kMaxObjects = 12;
constexpr std::size_t kMaxQueries = 2000;
constexpr std::array kQueryDistances_m = {0.6, 0.9, 1.3};
constexpr float kRightWithin_m = 0.01F;

struct Object {
  std::string name;
  TriangleMesh mesh;
};

// Features of several objects, with the object of each feature.
struct LabelledFeatures {
  FeatureSet features;
  std::vector<int> objects;
  void append(const FeatureSet& added, int object) {
    features.append(added);
    objects.insert(objects.end(), added.size(), object);
  }
};

struct Both {
  LabelledFeatures sift;
  LabelledFeatures shot;
};

std::vector<Object> load_objects(int argc, char** argv) {
  std::vector<Object> objects;
  if (argc < 2) {
    for (const std::string& name : procedural_object_names())
      objects.push_back({name, make_procedural_object(name).value().mesh});
  } else {
    const std::vector<ModelLocation> locations = find_models({argv[1]}).value();
    for (const ModelLocation& location : locations) {
      ModelSource source = read_model(location).value();
      if (source.mesh.has_value()) objects.push_back({source.name, *std::move(source.mesh)});
    }
  }
  objects.resize(std::min(objects.size(), kMaxObjects));
  return objects;
}

// Turntables whose views are combined.
struct Variant {
  std::string name;
  std::vector<TurntableOptions> turntables;
};

std::vector<Variant> list_variants() {
  const TurntableOptions clean;
  TurntableOptions noisy;
  noisy.sensor_noise = true;
  TurntableOptions near = noisy;
  near.distance_m = 0.7;
  TurntableOptions far = noisy;
  far.distance_m = 0.9;
  far.seed = 2;
  TurntableOptions clean_far = clean;
  clean_far.distance_m = 0.9;
  TurntableOptions farther = noisy;
  farther.distance_m = 1.2;
  farther.seed = 3;
  return {{"default distance, exact", {clean}},
          {"0.9 m, exact", {clean_far}},
          {"default distance, noise", {noisy}},
          {"0.7 m, noise", {near}},
          {"0.9 m, noise", {far}},
          {"0.7 m and 1.2 m, noise", {near, farther}}};
}

Both extract_training(const std::vector<Object>& objects, const Variant& variant, const TrainOptions& options) {
  Both all;
  for (std::size_t i = 0; i < objects.size(); ++i) {
    std::vector<TrainingView> views;
    for (TurntableOptions turntable : variant.turntables) {
      turntable.num_threads = options.num_threads;
      for (TrainingView& view : render_turntable(objects[i].mesh, turntable)) views.push_back(std::move(view));
    }
    const auto features = train_features(objects[i].name, views, options).value();
    all.sift.append(features.sift, static_cast<int>(i));
    all.shot.append(features.shot, static_cast<int>(i));
  }
  return all;
}

// Ground truth: the points are in the object frame.
Both extract_queries(const std::vector<Object>& objects, double distance_m, int num_threads) {
  const Rigid3 turned_from_object = Rigid3::from_axis_angle({0, 0, 1}, 7.5 * std::numbers::pi / 180);
  const TurntableOptions turntable{.step_deg = 90,
                                   .elevation_deg = 22,
                                   .distance_m = distance_m,
                                   .sensor_noise = true,
                                   .seed = 7,
                                   .num_threads = num_threads};
  Both all;
  for (std::size_t i = 0; i < objects.size(); ++i) {
    TriangleMesh turned = objects[i].mesh;
    const Rigid3f motion(turned_from_object);
    for (auto& v : turned.vertices) v = motion * v;
    for (auto& n : turned.normals) n = motion.rotation * n;
    for (const TrainingView& view : render_turntable(turned, turntable)) {
      const PreparedView prepared = prepare_view(view.frame);
      const Rigid3 object_from_camera = turned_from_object.inverse() * view.frame.world_from_camera;
      all.sift.append(transform(object_from_camera, extract_sift(prepared, {}, &view.mask)), static_cast<int>(i));
      all.shot.append(transform(object_from_camera, extract_shot(prepared, {}, &view.mask)), static_cast<int>(i));
    }
  }
  return all;
}

Eigen::Map<const Matrix> rows(const FeatureSet& set, std::size_t begin, std::size_t count) {
  return {set.descriptors.data() + begin * static_cast<std::size_t>(set.dimension), static_cast<Eigen::Index>(count),
          set.dimension};
}

// Share of queries with a right match among the k nearest.
double measure_recall(const LabelledFeatures& model, const LabelledFeatures& queries, int k, int num_threads) {
  constexpr std::size_t kBlock = 64;
  const std::size_t count = queries.features.size();
  std::vector<int> right(count, 0);
  parallel_for_blocks(count, kBlock, num_threads, [&](std::size_t begin, std::size_t end) {
    const Matrix similarity =
        rows(queries.features, begin, end - begin) * rows(model.features, 0, model.features.size()).transpose();
    std::vector<int> order(model.features.size());
    for (std::size_t q = begin; q < end; ++q) {
      const auto row = similarity.row(static_cast<Eigen::Index>(q - begin));
      for (std::size_t j = 0; j < order.size(); ++j) order[j] = static_cast<int>(j);
      const auto nearest = order.begin() + std::min<std::ptrdiff_t>(k, std::ssize(order));
      std::partial_sort(order.begin(), nearest, order.end(), [&](int a, int b) { return row(a) > row(b); });
      for (auto n = order.begin(); n != nearest; ++n) {
        const auto j = static_cast<std::size_t>(*n);
        const float distance = (model.features.points[j] - queries.features.points[q]).norm();
        if (model.objects[j] == queries.objects[q] && distance < kRightWithin_m) right[q] = 1;
      }
    }
  });
  return static_cast<double>(std::ranges::count(right, 1)) / static_cast<double>(std::max<std::size_t>(1, count));
}

LabelledFeatures merge(const LabelledFeatures& all, const FeatureMerging& merging, int num_threads) {
  LabelledFeatures merged;
  const int num_objects = all.objects.empty() ? 0 : all.objects.back() + 1;
  for (int object = 0; object < num_objects; ++object) {
    FeatureSet part{
        .type = all.features.type, .dimension = all.features.dimension, .points = {}, .normals = {}, .descriptors = {}};
    for (std::size_t i = 0; i < all.objects.size(); ++i) {
      if (all.objects[i] != object) continue;
      part.points.push_back(all.features.points[i]);
      part.normals.push_back(all.features.normals[i]);
      const auto descriptor = all.features.descriptor(i);
      part.descriptors.insert(part.descriptors.end(), descriptor.begin(), descriptor.end());
    }
    merged.append(decode(encode(merge_similar_features(part, merging, num_threads))), object);
  }
  return merged;
}

// Keeps every n-th feature, at most kMaxQueries.
LabelledFeatures downsample(const LabelledFeatures& all) {
  const std::size_t step = (all.features.size() + kMaxQueries - 1) / kMaxQueries;
  LabelledFeatures some;
  some.features.type = all.features.type;
  some.features.dimension = all.features.dimension;
  for (std::size_t i = 0; i < all.features.size(); i += step) {
    const auto descriptor = all.features.descriptor(i);
    some.features.points.push_back(all.features.points[i]);
    some.features.normals.push_back(all.features.normals[i]);
    some.features.descriptors.insert(some.features.descriptors.end(), descriptor.begin(), descriptor.end());
    some.objects.push_back(all.objects[i]);
  }
  return some;
}

using Queries = std::vector<LabelledFeatures>;  // Per distance.

void print_row(const std::string& variant, const char* kind, const FeatureMerging& merging,
               const LabelledFeatures& model, const Queries& queries, int num_threads) {
  fmt::print("{} | {} | {:.0f} mm, {:.1f} | {}", variant, kind, 1e3 * merging.max_distance_m,
             merging.max_descriptor_distance, model.features.size());
  for (const LabelledFeatures& q : queries)
    fmt::print(" | {:.1f} | {:.1f}", 100 * measure_recall(model, q, 1, num_threads),
               100 * measure_recall(model, q, 3, num_threads));
  fmt::print("\n");
  std::fflush(stdout);
}

void report(const std::string& variant, const char* kind, const LabelledFeatures& all, const Queries& queries,
            std::initializer_list<FeatureMerging> mergings, int num_threads) {
  print_row(variant, kind, {}, all, queries, num_threads);
  for (const FeatureMerging& merging : mergings)
    print_row(variant, kind, merging, merge(all, merging, num_threads), queries, num_threads);
}

}  // namespace

int main(int argc, char** argv) {
  TrainOptions options;
  options.num_threads = num_hardware_threads();
  options.sift_merging = {};
  options.shot_merging = {};
  const std::vector<Object> objects = load_objects(argc, argv);
  Queries sift;
  Queries shot;
  fmt::print("{} objects; right matches of queries at", objects.size());
  for (const double distance_m : kQueryDistances_m) {
    const Both queries = extract_queries(objects, distance_m, options.num_threads);
    sift.push_back(downsample(queries.sift));
    shot.push_back(downsample(queries.shot));
    fmt::print(" {} m ({} SIFT, {} SHOT)", distance_m, sift.back().features.size(), shot.back().features.size());
  }
  fmt::print("\ntraining views | kind | merging | features | nearest %, among three % (each distance)\n");
  for (const Variant& variant : list_variants()) {
    const Both training = extract_training(objects, variant, options);
    report(variant.name, "SIFT", training.sift, sift,
           {{.max_distance_m = 0.005, .max_descriptor_distance = 0.3},
            {.max_distance_m = 0.005, .max_descriptor_distance = 0.4},
            {.max_distance_m = 0.005, .max_descriptor_distance = 0.5}},
           options.num_threads);
    report(variant.name, "SHOT", training.shot, shot,
           {{.max_distance_m = 0.007, .max_descriptor_distance = 0.3},
            {.max_distance_m = 0.007, .max_descriptor_distance = 0.4}},
           options.num_threads);
  }
}
