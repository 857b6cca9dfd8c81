// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <functional>
#include <list>
#include <memory>
#include <mutex>
#include <string>
#include <utility>

#include "resight/core/result.hpp"

namespace resight::recordings {

/// The decompressed chunks that were used last. May be used from several threads.
class ChunkCache {
 public:
  using Chunk = std::shared_ptr<const std::string>;
  /// The chunk with this number; `load` reads it if it is not in the cache.
  [[nodiscard]] Result<Chunk> get(std::uint32_t number, const std::function<Result<std::string>()>& load) const {
    const std::lock_guard lock(mutex_);
    for (auto it = chunks_.begin(); it != chunks_.end(); ++it)
      if (it->first == number) {
        chunks_.splice(chunks_.begin(), chunks_, it);
        return chunks_.front().second;
      }
    Result<std::string> loaded = load();
    if (!loaded) return loaded.error();
    chunks_.emplace_front(number, std::make_shared<const std::string>(std::move(*loaded)));
    if (chunks_.size() > kMaxChunks) chunks_.pop_back();
    return chunks_.front().second;
  }
  void clear() {
    const std::lock_guard lock(mutex_);
    chunks_.clear();
  }

 private:
  static constexpr std::size_t kMaxChunks = 3;  ///< Colour and depth of a view may lie in neighbouring chunks.
  mutable std::mutex mutex_;
  mutable std::list<std::pair<std::uint32_t, Chunk>> chunks_;
};

}  // namespace resight::recordings
