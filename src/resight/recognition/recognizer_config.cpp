// SPDX-License-Identifier: Apache-2.0
#include "resight/recognition/recognizer_config.hpp"

#include "resight/core/check.hpp"

namespace resight {

void RecognizerConfig::set_num_threads(int num_threads) {
  check_positive("num_threads", num_threads);
  set_all_num_threads(*this, num_threads);
}

void RecognizerConfig::set_seed(std::uint64_t seed) {
  run.seed = seed;
  set_all_seeds(*this, seed);
}

void RecognizerConfig::check() const { check_options("", *this); }

std::vector<std::pair<std::string, std::string>> RecognizerConfig::to_settings() const {
  RecognizerConfig copy = *this;
  std::vector<std::pair<std::string, std::string>> settings = settings_of(list_options(copy));
  settings.insert(settings.begin(), {"preset", preset});
  return settings;
}

}  // namespace resight
