// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <list>
#include <map>
#include <memory>
#include <string>
#include <utility>

namespace resight {

/// Keeps the contents that were used last, up to a number of bytes. Contents that are larger are not kept.
class ByteCache {
 public:
  using Bytes = std::shared_ptr<const std::string>;
  explicit ByteCache(std::size_t max_bytes) : max_bytes_(max_bytes) {}

  /// Null if the content is not here.
  [[nodiscard]] Bytes find(const std::string& key) {
    const auto found = places_.find(key);
    if (found == places_.end()) return nullptr;
    entries_.splice(entries_.begin(), entries_, found->second);
    return found->second->second;
  }
  void add(const std::string& key, Bytes bytes) {
    if (bytes->size() > max_bytes_ || places_.contains(key)) return;
    num_bytes_ += bytes->size();
    entries_.emplace_front(key, std::move(bytes));
    places_[key] = entries_.begin();
    while (num_bytes_ > max_bytes_) drop_oldest();
  }
  void clear() {
    entries_.clear();
    places_.clear();
    num_bytes_ = 0;
  }
  [[nodiscard]] std::size_t num_bytes() const { return num_bytes_; }

 private:
  using Entries = std::list<std::pair<std::string, Bytes>>;
  void drop_oldest() {
    num_bytes_ -= entries_.back().second->size();
    places_.erase(entries_.back().first);
    entries_.pop_back();
  }
  std::size_t max_bytes_;
  std::size_t num_bytes_ = 0;
  Entries entries_;  ///< The one that was used last comes first.
  std::map<std::string, Entries::iterator> places_;
};

}  // namespace resight
