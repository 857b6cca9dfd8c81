// SPDX-License-Identifier: Apache-2.0
#include "resight/recognition/view_hypothesis_source.hpp"

#include <utility>

namespace resight {

ViewHypothesisSource::ViewHypothesisSource(const ModelLibrary& library, const RecognizerConfig& config,
                                           std::shared_ptr<ViewHypothesisStore> store)
    : library_(library), config_(config), store_(std::move(store)) {
  if (!store_) generator_.emplace(library_, config_);
}

std::shared_ptr<const ViewHypotheses> ViewHypothesisSource::find_stored(int number) const {
  const ViewHypotheses* stored = store_ ? store_->find(number) : nullptr;
  return stored != nullptr ? std::shared_ptr<const ViewHypotheses>(store_, stored) : nullptr;  // Owned by the store.
}

std::shared_ptr<const ViewHypotheses> ViewHypothesisSource::generate(const PreparedView& view, int number,
                                                                     const Deadline& deadline,
                                                                     const Image<std::uint8_t>& skipped,
                                                                     const StageTimes& planning_times) {
  if (!generator_) generator_.emplace(library_, config_);
  ViewHypotheses made = generator_->generate(view, number, next_id_, deadline, skipped);
  made.times.add(planning_times);
  if (store_) return {store_, &store_->add(number, std::move(made))};
  return std::make_shared<const ViewHypotheses>(std::move(made));
}

}  // namespace resight
