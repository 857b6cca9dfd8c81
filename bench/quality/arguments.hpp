// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <fmt/format.h>

#include <cstdlib>
#include <stdexcept>
#include <string>

#include "resight/core/result.hpp"
#include "resight/recognition/recognizer_config.hpp"

namespace resight {

/// Reaction of the bench programs to unusable input: one line, status 2.
[[noreturn]] inline void exit_with(const std::string& message) {
  fmt::print(stderr, "{}\n", message);
  std::exit(2);
}

template <typename T>
T value_or_exit(Result<T> result) {
  if (!result.ok()) exit_with(result.error().message);
  return std::move(*result);
}

inline RecognizerConfig preset_or_exit(const std::string& name) {
  try {
    return RecognizerConfig::from_preset(name);
  } catch (const std::invalid_argument& error) {
    exit_with(error.what());
  }
}

}  // namespace resight
