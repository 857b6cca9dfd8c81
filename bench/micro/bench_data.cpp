// SPDX-License-Identifier: Apache-2.0
#include "bench_data.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "resight/core/random.hpp"
#include "resight/features/descriptor_index.hpp"

namespace resight::bench {
namespace {

struct Ball {
  Eigen::Vector3d center;
  double radius_m;
};

/// Distance along the ray to the table, 0.75 m from an inclined camera, or to the nearest ball.
double cast(const Eigen::Vector3d& ray, const std::vector<Ball>& balls) {
  const Eigen::Vector3d up = Eigen::Vector3d(0, -0.75, -0.66).normalized();
  const double down = -up.dot(ray);
  double best = down > 1e-3 ? 0.75 / down : 1e9;
  for (const Ball& ball : balls) {
    const double a = ray.squaredNorm();
    const double b = ray.dot(ball.center);
    const double root = b * b - a * (ball.center.squaredNorm() - ball.radius_m * ball.radius_m);
    if (root > 0) best = std::min(best, (b - std::sqrt(root)) / a);
  }
  return best;
}

/// Value noise of three octaves: enough texture for a thousand keypoints.
double shade(double x, double y) {
  double sum = 0;
  for (int octave = 0; octave < 3; ++octave) {
    const double scale = std::pow(2.2, octave) / 9;
    const auto lattice = [&](double u, double v) {
      Rng rng = Rng::stream(static_cast<std::uint64_t>(octave),
                            static_cast<std::uint64_t>(u + 1000) * 100003 + static_cast<std::uint64_t>(v + 1000));
      return rng.uniform(-1, 1);
    };
    const double u = std::floor(x * scale);
    const double v = std::floor(y * scale);
    const double a = x * scale - u;
    const double b = y * scale - v;
    sum += 13 * ((1 - a) * (1 - b) * lattice(u, v) + a * (1 - b) * lattice(u + 1, v) + (1 - a) * b * lattice(u, v + 1) +
                 a * b * lattice(u + 1, v + 1));
  }
  return sum;
}

}  // namespace

RgbdFrame make_table_frame() {
  RgbdFrame frame;
  frame.name = "table";
  frame.camera = make_kinect_camera();
  frame.color = Image<Rgb8>(640, 480);
  frame.depth_m = Image<float>(640, 480);
  Rng rng(1);
  std::vector<Ball> balls;
  for (int i = 0; i < 14; ++i) {
    const double radius = rng.uniform(0.04, 0.09);
    balls.push_back({{rng.uniform(-0.45, 0.45), rng.uniform(-0.2, 0.3), rng.uniform(0.75, 0.95)}, radius});
  }
  for (int v = 0; v < 480; ++v)
    for (int u = 0; u < 640; ++u) {
      const double z = cast(frame.camera.unproject(u, v, 1), balls);
      const double noisy = z + 0.0015 * z * z * rng.normal();
      const bool missing = z > 1.6 || rng.uniform() < 0.02;
      frame.depth_m(u, v) = missing ? std::numeric_limits<float>::quiet_NaN() : static_cast<float>(noisy);
      const auto level = static_cast<std::uint8_t>(std::clamp(128 + shade(u, v), 0.0, 255.0));
      frame.color(u, v) = {level, level, level};
    }
  return frame;
}

std::vector<float> make_descriptors(int count, int dimension, std::uint64_t seed) {
  std::vector<float> result;
  result.reserve(static_cast<std::size_t>(count) * static_cast<std::size_t>(dimension));
  std::vector<double> row(static_cast<std::size_t>(dimension));
  for (int i = 0; i < count; ++i) {
    Rng member = Rng::stream(seed, static_cast<std::uint64_t>(i));
    Rng center = Rng::stream(7, member.below(5000));
    double norm_sq = 0;
    for (double& x : row) {
      x = center.normal() + 0.6 * member.normal();
      norm_sq += x * x;
    }
    for (const double x : row) result.push_back(static_cast<float>(x / std::sqrt(norm_sq)));
  }
  return result;
}

const MatchingTask& matching_task(int dimension) {
  static std::map<int, MatchingTask> tasks;
  const auto [it, is_new] = tasks.try_emplace(dimension);
  MatchingTask& task = it->second;
  if (is_new) {
    task.model = make_descriptors(kNumModelDescriptors, dimension, 1);
    task.queries = make_descriptors(kNumQueries, dimension, 2);
    const DescriptorIndex exact(task.model, dimension, {.search = IndexSearch::kExact});
    for (const DescriptorMatch& match : exact.search(task.queries, 1)) task.nearest.push_back(match.index);
  }
  return task;
}

}  // namespace resight::bench
