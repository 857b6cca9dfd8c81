// SPDX-License-Identifier: Apache-2.0
#include "resight/core/random.hpp"

#include <cmath>
#include <numbers>

#include "resight/core/check.hpp"

namespace resight {
namespace {

std::uint64_t mix(std::uint64_t x) {  // splitmix64: adjacent seeds give unrelated states
  x += 0x9E3779B97F4A7C15ULL;
  x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9ULL;
  x = (x ^ (x >> 27)) * 0x94D049BB133111EBULL;
  return x ^ (x >> 31);
}

}  // namespace

Rng::Rng(std::uint64_t seed, std::uint64_t stream) : state_(mix(seed)), increment_((mix(stream) << 1U) | 1U) { next(); }

std::uint32_t Rng::next() {  // PCG-XSH-RR, O'Neill 2014
  const std::uint64_t old = state_;
  state_ = old * 6364136223846793005ULL + increment_;
  const auto shifted = static_cast<std::uint32_t>(((old >> 18U) ^ old) >> 27U);
  const auto rotation = static_cast<std::uint32_t>(old >> 59U);
  return (shifted >> rotation) | (shifted << ((32U - rotation) & 31U));
}

std::uint32_t Rng::below(std::uint32_t bound) {
  require(bound > 0, "Rng::below: bound = 0 (must be > 0)");
  // Numbers below the threshold are rejected, which avoids the bias of an incomplete last block.
  const std::uint32_t threshold = (0U - bound) % bound;
  for (;;) {
    const std::uint32_t value = next();
    if (value >= threshold) return value % bound;
  }
}

double Rng::uniform() {
  const std::uint64_t high = next();
  return static_cast<double>((high << 21U) ^ (next() >> 11U)) * 0x1.0p-53;
}

double Rng::normal() {  // Box-Muller; the second value is discarded, so that the only state is that of the stream
  const double u = 1.0 - uniform();
  return std::sqrt(-2.0 * std::log(u)) * std::cos(2.0 * std::numbers::pi * uniform());
}

}  // namespace resight
