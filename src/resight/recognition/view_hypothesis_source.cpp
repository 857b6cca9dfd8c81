// SPDX-License-Identifier: Apache-2.0
#include "resight/recognition/view_hypothesis_source.hpp"

#include <utility>

namespace resight {

ViewHypothesisSource::ViewHypothesisSource(const ModelLibrary& library, const RecognizerConfig& config,
                                           std::shared_ptr<ViewHypothesisStore> store)
    : library_(library), config_(config), store_(std::move(store)) {
  if (!store_) generator_.emplace(library_, config_);
}

const ViewHypotheses& ViewHypothesisSource::generate(const PreparedView& view, int number, const Deadline& deadline,
                                                     const Image<std::uint8_t>& skipped,
                                                     const StageTimes& planning_times) {
  if (!generator_) generator_.emplace(library_, config_);
  ViewHypotheses made = generator_->generate(view, number, next_id_, deadline, skipped);
  made.times.add(planning_times);
  if (store_) return store_->add(number, std::move(made));
  made_ = std::move(made);
  return made_;
}

}  // namespace resight
