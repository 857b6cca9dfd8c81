// SPDX-License-Identifier: Apache-2.0
#include "resight/core/hash.hpp"

#include <gtest/gtest.h>

#include <numeric>
#include <set>
#include <string>
#include <vector>

namespace resight {
namespace {

std::uint64_t checksum_text(const std::string& text) {
  return checksum_bytes({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

TEST(HashText, PublishedFnv1aValues) {
  EXPECT_EQ(hash_text(""), 0xCBF29CE484222325ULL);
  EXPECT_EQ(hash_text("a"), 0xAF63DC4C8601EC8CULL);
  EXPECT_EQ(hash_text("foobar"), 0x85944171F73967E8ULL);
}

TEST(HashBytes, ChainsBySeed) { EXPECT_EQ(hash_text("bar", hash_text("foo")), hash_text("foobar")); }

TEST(HashBytes, ReadsBytesAsUnsigned) {
  const std::vector<std::uint8_t> bytes{0xFF, 0x80};
  EXPECT_EQ(hash_bytes(bytes), hash_text("\xFF\x80"));
}

// Values from an independent implementation.
TEST(ChecksumBytes, GoldenValues) {
  std::vector<std::uint8_t> all(256);
  std::iota(all.begin(), all.end(), std::uint8_t{0});
  EXPECT_EQ(checksum_text(""), kHashSeed);
  EXPECT_EQ(checksum_text("a"), 0xBFAAC9F9737E9950ULL);
  EXPECT_EQ(checksum_text("resight!"), 0x66C7A2D428F16B1FULL);
  EXPECT_EQ(checksum_text("nine byte"), 0x7644E7250C3B261FULL);
  EXPECT_EQ(checksum_bytes(all), 0x371C9B9DE711D9DFULL);
}

TEST(ChecksumBytes, NoticesEveryBitFlipAndEveryTruncation) {
  for (const std::size_t size : {1U, 7U, 8U, 9U, 33U, 64U}) {
    std::vector<std::uint8_t> bytes(size);
    for (std::size_t i = 0; i < size; ++i) bytes[i] = static_cast<std::uint8_t>(31 * i);
    std::set<std::uint64_t> sums{checksum_bytes(bytes)};
    for (std::size_t bit = 0; bit < 8 * size; ++bit) {
      bytes[bit / 8] ^= static_cast<std::uint8_t>(1U << (bit % 8));
      sums.insert(checksum_bytes(bytes));
      bytes[bit / 8] ^= static_cast<std::uint8_t>(1U << (bit % 8));
    }
    for (std::size_t cut = 0; cut < size; ++cut) sums.insert(checksum_bytes(std::span(bytes).first(cut)));
    EXPECT_EQ(sums.size(), 1 + 8 * size + size) << size << " bytes";
  }
}

TEST(ChecksumBytes, NoticesZerosAppendedAndWordsSwapped) {
  EXPECT_NE(checksum_text(std::string(8, '\0')), checksum_text(std::string(9, '\0')));
  EXPECT_NE(checksum_text("aaaaaaaabbbbbbbb"), checksum_text("bbbbbbbbaaaaaaaa"));
}

}  // namespace
}  // namespace resight
