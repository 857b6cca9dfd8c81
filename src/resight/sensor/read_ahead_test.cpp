// SPDX-License-Identifier: Apache-2.0
#include "resight/sensor/read_ahead.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <thread>

#include "resight/sensor/testing/memory_sequence.hpp"

namespace resight {
namespace {

/// Counts the views that were read, and on which thread.
class CountedSequence : public test::MemorySequence {
 public:
  using MemorySequence::MemorySequence;
  [[nodiscard]] Result<RgbdFrame> read_view(int view) const override {
    ++num_reads;
    if (std::this_thread::get_id() != caller) ++num_elsewhere;
    if (view == bad_view) return Error{"bad"};
    if (view == throwing_view) throw std::runtime_error("thrown");
    return MemorySequence::read_view(view);
  }
  std::thread::id caller = std::this_thread::get_id();
  int bad_view = -1;
  int throwing_view = -1;
  mutable std::atomic<int> num_reads = 0;
  mutable std::atomic<int> num_elsewhere = 0;
};

std::vector<RgbdFrame> make_frames() {
  std::vector<RgbdFrame> frames(4);
  for (std::size_t v = 0; v < frames.size(); ++v) {
    frames[v].name = std::to_string(v);
    frames[v].depth_m = Image<float>(2, 2, 1.0F);
  }
  return frames;
}

TEST(ReadAhead, GivesTheViewsInOrder) {
  for (const int num_threads : {1, 2}) {
    const CountedSequence sequence(make_frames());
    ReadAhead reader(sequence, num_threads);
    for (int v = 0; v < 4; ++v) EXPECT_EQ(reader.read_view(v)->name, std::to_string(v));
    EXPECT_EQ(sequence.num_reads, 4) << "no view is read twice";
    EXPECT_EQ(sequence.num_elsewhere, num_threads == 1 ? 0 : 3);
  }
}

TEST(ReadAhead, AnyOrderIsRight) {
  const CountedSequence sequence(make_frames());
  ReadAhead reader(sequence, 2);
  for (const int v : {2, 0, 3, 3, 1}) EXPECT_EQ(reader.read_view(v)->name, std::to_string(v));
}

TEST(ReadAhead, ErrorsComeWithTheirView) {
  CountedSequence sequence(make_frames());
  sequence.bad_view = 1;
  sequence.throwing_view = 3;
  ReadAhead reader(sequence, 2);
  EXPECT_TRUE(reader.read_view(0).ok());
  EXPECT_EQ(reader.read_view(1).error().message, "bad");
  EXPECT_TRUE(reader.read_view(2).ok());
  EXPECT_THROW((void)reader.read_view(3), std::runtime_error);
}

}  // namespace
}  // namespace resight
