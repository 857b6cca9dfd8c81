// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <exception>
#include <optional>
#include <string_view>
#include <utility>

#include "resight/inspection/find_faults.hpp"
#include "resight/inspection/object_scale.hpp"
#include "resight/inspection/testing/broken_sequence.hpp"
#include "resight/io/sequence.hpp"
#include "resight/models/library_file.hpp"

/// Breaks sequences in all ways of broken_sequence.hpp and counts how many of them `resight check` finds, and what it
/// finds on the sequences as they are. A library given before sequences, of objects that are in them, is broken, too:
/// its models get another unit. Usage: bench_check_faults [--models LIBRARY] SEQUENCE...
namespace {

using namespace resight;  // NOLINT(google-build-using-namespace): a program, no header

constexpr int kInspectedViews = 12;
constexpr double kMaxStep_px = 40;

struct Count {
  int tried = 0;
  int found = 0;
};

std::vector<Finding> check(const Sequence& sequence) {
  const auto measured = measure_sequence(sequence, {.max_views = kInspectedViews, .num_threads = 1});
  if (!measured.ok()) throw std::runtime_error(measured.error().message);
  return find_faults(*measured);
}

std::string describe(const std::vector<Finding>& findings) {
  std::string text;
  for (const Finding& f : findings) text += fmt::format("\n      {} (margin {:.2f}): {}", f.fault, f.margin, f.message);
  return text;
}

void break_all(const Sequence& sequence, Count& count) {
  const auto measured = measure_sequence(sequence, {.max_views = kInspectedViews, .num_threads = 1});
  if (!measured.ok()) throw std::runtime_error(measured.error().message);
  const std::vector<Finding> sound = find_faults(*measured);
  fmt::print("  as it is: {} findings{}\n", sound.size(), describe(sound));
  const bool moves = measured->poses && !measured->poses->all_equal;
  for (const test::Breakage& breakage : test::breakages()) {
    if (breakage.needs_motion && !moves) continue;
    if (breakage.needs_near_views && measured->pair_shift_px > kMaxStep_px) {
      fmt::print("  {:26} not tried: views are {:.0f} px apart\n", breakage.name, measured->pair_shift_px);
      continue;
    }
    if (breakage.name == "poses_100_km_away" && !sequence.has_poses()) continue;
    const std::vector<Finding> findings = check(test::BrokenSequence(sequence, breakage.name));
    const bool is_found = std::ranges::any_of(findings, [&](const Finding& f) {
      return std::ranges::find(breakage.expected, f.fault) != breakage.expected.end();
    });
    ++count.tried;
    count.found += is_found ? 1 : 0;
    fmt::print("  {:26} {}{}\n", breakage.name, is_found ? "found" : "MISSED", describe(findings));
    std::fflush(stdout);
  }
}

ModelLibrary scale_library(ModelLibrary library, float scale) {
  for (ObjectModel& object : library.objects) {
    object.diameter_m *= scale;
    for (Eigen::Vector3f& p : object.sift.points) p *= scale;
  }
  return library;
}

void break_models(const Sequence& sequence, const ModelLibrary& library, Count& count) {
  const MeasureObjectScalesOptions options{.max_views = kInspectedViews, .num_threads = 1};
  for (const float scale : {1.0F, 1000.0F, 0.0254F, 10.0F, 0.1F, 1.25F, 0.8F}) {
    const ModelLibrary broken = scale_library(library, scale);
    const auto scales = measure_object_scales(sequence, broken, options);
    if (!scales.ok()) throw std::runtime_error(scales.error().message);
    const std::vector<Finding> findings = find_scale_faults(*scales, broken);
    if (scale == 1) {
      fmt::print("  models as they are: {} findings; {}{}\n", findings.size(), describe_scales(*scales),
                 describe(findings));
      if (!scales->is_measured()) return;
      continue;
    }
    ++count.tried;
    count.found += findings.empty() ? 0 : 1;
    fmt::print("  models x {:<16} {}{}\n", scale, findings.empty() ? "MISSED" : "found", describe(findings));
    std::fflush(stdout);
  }
}

}  // namespace

int main(int argc, char** argv) {
  try {
    Count count;
    std::optional<ModelLibrary> library;
    for (int i = 1; i < argc; ++i) {
      if (std::string_view(argv[i]) == "--models" && i + 1 < argc) {
        auto loaded = load_library(argv[++i]);
        if (!loaded.ok()) throw std::runtime_error(loaded.error().message);
        library = std::move(loaded).value();
        continue;
      }
      const auto sequence = open_sequence(argv[i]);
      if (!sequence.ok()) {
        fmt::print("{}\n", sequence.error().message);
        continue;
      }
      fmt::print("{}\n", argv[i]);
      break_all(**sequence, count);
      if (library) break_models(**sequence, *library, count);
    }
    fmt::print("{} of {} found\n", count.found, count.tried);
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 1;
  }
  return 0;
}
