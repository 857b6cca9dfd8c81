// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <fmt/format.h>

#include <cstdlib>
#include <memory>
#include <stdexcept>
#include <string>

#include "resight/core/result.hpp"
#include "resight/io/sequence.hpp"
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

/// Opens a sequence. SEQUENCE@SENSOR: with the depth noise of that kind of camera (`--sensor` of the program).
inline std::unique_ptr<Sequence> open_or_exit(const std::string& argument) {
  const std::size_t at = argument.rfind('@');
  OpenSequenceOptions options;
  if (at != std::string::npos) options.sensor = find_depth_sensor(argument.substr(at + 1));
  return value_or_exit(open_sequence(options.sensor == nullptr ? argument : argument.substr(0, at), options));
}

inline RecognizerConfig preset_or_exit(const std::string& name) {
  try {
    return RecognizerConfig::from_preset(name);
  } catch (const std::invalid_argument& error) {
    exit_with(error.what());
  }
}

}  // namespace resight
