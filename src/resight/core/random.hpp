// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <utility>
#include <vector>

namespace resight {

/// A small random generator (PCG32, O'Neill 2014). Unlike the distributions of <random>, it gives the same numbers on
/// every platform. One stream per item, `Rng::stream(seed, index)`, makes results independent of the number of threads.
class Rng {
 public:
  explicit Rng(std::uint64_t seed) : Rng(seed, 0) {}

  /// The `index`-th independent stream of `seed`.
  [[nodiscard]] static Rng stream(std::uint64_t seed, std::uint64_t index) { return Rng(seed, index); }

  /// Uniform over all 32-bit numbers.
  std::uint32_t next();
  /// Uniform integer in [0, bound). Throws std::invalid_argument if `bound` is 0.
  std::uint32_t below(std::uint32_t bound);
  /// Uniform in [0, 1).
  double uniform();
  /// Uniform in [min, max).
  double uniform(double min, double max) { return min + (max - min) * uniform(); }
  /// Standard normal.
  double normal();

  /// Fisher-Yates shuffle.
  template <typename T>
  void shuffle(std::vector<T>& items) {
    for (std::size_t i = items.size(); i > 1; --i) std::swap(items[i - 1], items[below(static_cast<std::uint32_t>(i))]);
  }

 private:
  Rng(std::uint64_t seed, std::uint64_t stream);
  std::uint64_t state_;
  std::uint64_t increment_;
};

}  // namespace resight
