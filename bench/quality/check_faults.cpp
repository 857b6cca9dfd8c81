// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <exception>

#include "resight/inspection/find_faults.hpp"
#include "resight/inspection/testing/broken_sequence.hpp"
#include "resight/io/sequence.hpp"

/// Breaks sequences in all ways of broken_sequence.hpp and counts how many of them `resight check` finds, and what it
/// finds on the sequences as they are. Usage: bench_check_faults SEQUENCE....
namespace {

using namespace resight;  // NOLINT(google-build-using-namespace): a program, no header

constexpr int kInspectedViews = 12;

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

}  // namespace

int main(int argc, char** argv) {
  try {
    Count count;
    for (int i = 1; i < argc; ++i) {
      const auto sequence = open_sequence(argv[i]);
      if (!sequence.ok()) {
        fmt::print("{}\n", sequence.error().message);
        continue;
      }
      fmt::print("{}\n", argv[i]);
      break_all(**sequence, count);
    }
    fmt::print("{} of {} found\n", count.found, count.tried);
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 1;
  }
  return 0;
}
