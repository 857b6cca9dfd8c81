// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <map>
#include <optional>

#include "resight/core/crc32.hpp"
#include "resight/core/files.hpp"
#include "resight/recordings/internal/byte_reader.hpp"
#include "resight/recordings/internal/chunk_cache.hpp"
#include "resight/recordings/internal/containers.hpp"
#include "resight/recordings/internal/decompress.hpp"
#include "resight/recordings/internal/random_access_file.hpp"

/// MCAP (mcap.dev/spec): records of an opcode, a length and content. Messages lie in chunks or between them. A summary
/// before the end lists channels and chunks; each chunk is followed by the index of its messages.
namespace resight::recordings {
namespace {

enum class McapOp : std::uint8_t {
  kHeader = 0x01,
  kFooter = 0x02,
  kSchema = 0x03,
  kChannel = 0x04,
  kMessage = 0x05,
  kChunk = 0x06,
  kMessageIndex = 0x07,
  kChunkIndex = 0x08,
  kDataEnd = 0x0F
};

constexpr std::uint64_t kRecordHeaderBytes = 9;
constexpr std::uint64_t kFooterBytes = 20;
constexpr std::uint64_t kChunkHeadBytes = 8 + 8 + 8 + 4 + 4 + 32 + 8;  ///< With a name of up to 32 bytes.
constexpr std::uint64_t kMaxSummaryBytes = std::uint64_t{1} << 28;
constexpr std::uint32_t kOutsideChunks = 0;  ///< Part of messages that lie in no chunk; the chunks begin at 1.

struct McapChunk {
  std::string compression;
  std::uint64_t offset = 0;  ///< Of the compressed records in the file.
  std::uint64_t stored_bytes = 0;
  std::uint64_t size = 0;  ///< Uncompressed.
  std::uint32_t crc = 0;   ///< 0: none.
};

struct McapRecord {
  McapOp op = McapOp::kHeader;
  std::uint64_t offset = 0;  ///< Of the content.
  std::uint64_t bytes = 0;
  [[nodiscard]] std::uint64_t end() const { return offset + bytes; }
};

/// The part of a chunk record before its compressed records.
struct ChunkHead {
  std::string compression;
  std::uint64_t size = 0;
  std::uint32_t crc = 0;
  std::uint64_t stored_bytes = 0;
  std::uint64_t head_bytes = 0;
};

std::optional<ChunkHead> parse_chunk_head(std::string_view bytes) {
  ByteReader reader(bytes);
  ChunkHead head;
  reader.take(16);  // first and last time
  head.size = reader.value<std::uint64_t>();
  head.crc = reader.value<std::uint32_t>();
  head.compression = reader.counted<std::uint32_t>();
  head.stored_bytes = reader.value<std::uint64_t>();
  head.head_bytes = bytes.size() - reader.rest().size();
  return reader.ok() ? std::optional(head) : std::nullopt;
}

class McapFile final : public IndexedRecording {
 public:
  explicit McapFile(RandomAccessFile file) : file_(std::move(file)), chunk_sizes_(file_.size()) {}

  [[nodiscard]] std::string format() const override { return "mcap"; }

  [[nodiscard]] Result<std::string> read(const MessageEntry& entry, std::size_t max_bytes) const override;

  /// Reads the summary; without a usable one, walks over the whole file.
  [[nodiscard]] Result<void> build_index();

 private:
  [[nodiscard]] Result<McapRecord> record_at(std::uint64_t offset) const;
  [[nodiscard]] Result<void> read_summary(std::uint64_t begin, std::uint64_t end);
  /// Returns where the chunk ends, with the index behind it.
  [[nodiscard]] Result<std::uint64_t> index_chunk(std::string_view chunk_index);
  [[nodiscard]] Result<void> read_message_indexes(std::uint64_t begin, std::uint64_t bytes, std::uint32_t part);
  [[nodiscard]] Result<std::uint32_t> add_chunk(const McapRecord& record);
  /// Reads the records from `begin` on, until one ends at `end`, or until that which ends the data.
  [[nodiscard]] Result<void> scan(std::uint64_t begin, std::uint64_t end);
  [[nodiscard]] std::optional<std::uint64_t> content_of_cut_chunk(std::uint64_t offset) const;
  [[nodiscard]] Result<void> scan_record(const McapRecord& record);
  [[nodiscard]] Result<void> scan_chunk(std::uint32_t part);
  [[nodiscard]] Result<void> add_schema(std::string_view content);
  [[nodiscard]] Result<void> add_channel(std::string_view content);
  [[nodiscard]] Result<void> add_message(std::uint16_t channel, std::uint64_t time, std::uint32_t part,
                                         std::uint64_t offset);
  [[nodiscard]] Result<ChunkCache::Chunk> load_chunk(std::uint32_t part) const;
  [[nodiscard]] Error fail(std::string_view what) const { return file_error(file_.path(), what); }

  RandomAccessFile file_;
  std::vector<McapChunk> chunks_;
  std::map<std::uint16_t, std::string> type_of_schema_;
  std::map<std::uint16_t, int> topic_of_channel_;
  ChunkSizes chunk_sizes_;
  ChunkCache cache_;
};

Result<McapRecord> McapFile::record_at(std::uint64_t offset) const {
  const auto head = file_.read(offset, kRecordHeaderBytes);
  if (!head) return head.error();
  ByteReader reader(*head);
  McapRecord record;
  record.op = static_cast<McapOp>(reader.value<std::uint8_t>());
  record.bytes = reader.value<std::uint64_t>();
  record.offset = offset + kRecordHeaderBytes;
  if (record.bytes > file_.size() - record.offset)
    return fail(fmt::format("ends within the record at byte {} (cut off or damaged)", offset));
  return record;
}

Result<void> McapFile::add_schema(std::string_view content) {
  ByteReader reader(content);
  const auto id = reader.value<std::uint16_t>();
  const std::string_view name = reader.counted<std::uint32_t>();
  if (!reader.ok()) return fail("a schema record is damaged");
  if (const auto done = check_name(name); !done) return fail(done.error().message);
  type_of_schema_[id] = without_msg(name);
  return {};
}

Result<void> McapFile::add_channel(std::string_view content) {
  ByteReader reader(content);
  const auto id = reader.value<std::uint16_t>();
  const auto schema = reader.value<std::uint16_t>();
  const std::string_view topic = reader.counted<std::uint32_t>();
  const std::string_view encoding = reader.counted<std::uint32_t>();
  if (!reader.ok()) return fail("a channel record is damaged");
  if (topic_of_channel_.contains(id)) return {};
  const MessageLayout layout = encoding == "cdr"    ? MessageLayout::kCdr
                               : encoding == "ros1" ? MessageLayout::kRos1
                                                    : MessageLayout::kOther;
  const auto number = index_.add_topic({std::string(topic), type_of_schema_[schema], layout});
  if (!number) return fail(number.error().message);
  topic_of_channel_[id] = *number;
  return {};
}

Result<void> McapFile::add_message(std::uint16_t channel, std::uint64_t time, std::uint32_t part,
                                   std::uint64_t offset) {
  const auto topic = topic_of_channel_.find(channel);
  if (topic == topic_of_channel_.end()) return fail("a message belongs to no channel (damaged)");
  if (index_.messages.size() >= kMaxMessages) return fail("holds too many messages");
  index_.messages.push_back({static_cast<std::int64_t>(time), topic->second, part, offset});
  return {};
}

Result<std::uint32_t> McapFile::add_chunk(const McapRecord& record) {
  const auto bytes = file_.read(record.offset, std::min(record.bytes, kChunkHeadBytes));
  if (!bytes) return bytes.error();
  const auto head = parse_chunk_head(*bytes);
  if (!head || head->stored_bytes > record.bytes - head->head_bytes) return fail("a chunk record is damaged");
  if (const auto done = chunk_sizes_.add(head->size); !done) return fail(done.error().message);
  if (head->compression.empty() && head->size != head->stored_bytes)
    return fail("the size of a chunk is wrong (damaged)");
  chunks_.push_back({head->compression, record.offset + head->head_bytes, head->stored_bytes, head->size, head->crc});
  return static_cast<std::uint32_t>(chunks_.size());
}

Result<void> McapFile::read_message_indexes(std::uint64_t begin, std::uint64_t bytes, std::uint32_t part) {
  if (bytes > kMaxSummaryBytes) return fail("an index record is damaged");
  const auto content = file_.read(begin, bytes);
  if (!content) return content.error();
  ByteReader reader(*content);
  while (!reader.at_end()) {
    const auto op = static_cast<McapOp>(reader.value<std::uint8_t>());
    ByteReader record(reader.counted<std::uint64_t>());
    const auto channel = record.value<std::uint16_t>();
    ByteReader entries(record.counted<std::uint32_t>());
    if (!reader.ok() || !record.ok() || op != McapOp::kMessageIndex) return fail("an index record is damaged");
    while (!entries.at_end()) {
      const auto time = entries.value<std::uint64_t>();
      const auto offset = entries.value<std::uint64_t>();
      if (!entries.ok() || offset >= chunks_[part - 1].size) return fail("an index record is damaged");
      if (const auto done = add_message(channel, time, part, offset); !done) return done;
    }
  }
  return {};
}

Result<std::uint64_t> McapFile::index_chunk(std::string_view chunk_index) {
  ByteReader reader(chunk_index);
  reader.take(16);  // first and last time
  const auto chunk_begin = reader.value<std::uint64_t>();
  const auto chunk_bytes = reader.value<std::uint64_t>();
  const std::string_view offsets = reader.counted<std::uint32_t>();
  const auto index_bytes = reader.value<std::uint64_t>();
  if (!reader.ok() || chunk_begin > file_.size() || chunk_bytes > file_.size() - chunk_begin)
    return fail("the list of chunks is damaged");
  const auto record = record_at(chunk_begin);
  if (!record) return record.error();
  if (record->op != McapOp::kChunk || record->end() != chunk_begin + chunk_bytes)
    return fail("the list of chunks is damaged");
  const auto part = add_chunk(*record);
  if (!part) return part.error();
  if (offsets.empty()) {
    if (const auto done = scan_chunk(*part); !done) return done.error();
    return record->end();
  }
  if (const auto done = read_message_indexes(record->end(), index_bytes, *part); !done) return done.error();
  return record->end() + index_bytes;
}

Result<void> McapFile::read_summary(std::uint64_t begin, std::uint64_t end) {
  if (end - begin > kMaxSummaryBytes) return fail("its summary is too large");
  const auto summary = file_.read(begin, end - begin);
  if (!summary) return summary.error();
  std::vector<std::string_view> chunk_indexes;
  ByteReader reader(*summary);
  while (!reader.at_end()) {
    const auto op = static_cast<McapOp>(reader.value<std::uint8_t>());
    const std::string_view content = reader.counted<std::uint64_t>();
    if (!reader.ok()) return fail("its summary is damaged");
    Result<void> done;
    if (op == McapOp::kSchema) done = add_schema(content);
    if (op == McapOp::kChannel) done = add_channel(content);
    if (op == McapOp::kChunkIndex) chunk_indexes.push_back(content);
    if (!done) return done;
  }
  // Without chunk indexes, the messages lie outside of chunks, or the writer has left the indexes out.
  if (chunk_indexes.empty()) return fail("holds no list of chunks");
  const auto begin_of = [](std::string_view index) {
    ByteReader fields(index);
    fields.take(16);
    return fields.value<std::uint64_t>();
  };
  std::ranges::sort(chunk_indexes, {}, begin_of);
  // Of chunks within each other, each would read the same bytes again. Messages may lie between them.
  const auto scan_gap = [&](std::uint64_t gap_begin, std::uint64_t gap_end) {
    if (const auto done = scan(gap_begin, gap_end); !done) index_.damage = done.error().message;
  };
  std::uint64_t end_of_last = kMcapMagic.size();
  for (const std::string_view index : chunk_indexes) {
    if (begin_of(index) < end_of_last) return fail("the list of chunks is damaged");
    scan_gap(end_of_last, begin_of(index));
    const auto chunk_end = index_chunk(index);
    if (!chunk_end) return chunk_end.error();
    end_of_last = *chunk_end;
  }
  scan_gap(end_of_last, begin);
  return {};
}

Result<void> McapFile::scan_chunk(std::uint32_t part) {
  const auto chunk = load_chunk(part);
  if (!chunk) return chunk.error();
  const std::string_view content = **chunk;
  ByteReader reader(content);
  while (!reader.at_end()) {
    const std::uint64_t place = content.size() - reader.rest().size();
    const auto op = static_cast<McapOp>(reader.value<std::uint8_t>());
    const std::string_view record = reader.counted<std::uint64_t>();
    if (!reader.ok()) return fail("a record in a chunk is damaged");
    Result<void> done;
    if (op == McapOp::kSchema) done = add_schema(record);
    if (op == McapOp::kChannel) done = add_channel(record);
    if (op == McapOp::kMessage) {
      ByteReader message(record);
      const auto channel = message.value<std::uint16_t>();
      message.value<std::uint32_t>();  // sequence number
      const auto time = message.value<std::uint64_t>();
      if (!message.ok()) return fail("a message record is damaged");
      done = add_message(channel, time, part, place);
    }
    if (!done) return done;
  }
  return {};
}

Result<void> McapFile::scan_record(const McapRecord& record) {
  if (record.op == McapOp::kChunk) {
    const auto part = add_chunk(record);
    if (!part) return part.error();
    return scan_chunk(*part);
  }
  if (record.op == McapOp::kMessage) {
    const auto head = file_.read(record.offset, std::min<std::uint64_t>(record.bytes, 14));
    if (!head) return head.error();
    ByteReader reader(*head);
    const auto channel = reader.value<std::uint16_t>();
    reader.value<std::uint32_t>();
    const auto time = reader.value<std::uint64_t>();
    if (!reader.ok()) return fail("a message record is damaged");
    return add_message(channel, time, kOutsideChunks, record.offset - kRecordHeaderBytes);
  }
  if (record.op != McapOp::kSchema && record.op != McapOp::kChannel) return {};
  if (record.bytes > kMaxMessageBytes) return fail("a schema or channel record is too large (damaged)");
  const auto content = file_.read(record.offset, record.bytes);
  if (!content) return content.error();
  return record.op == McapOp::kSchema ? add_schema(*content) : add_channel(*content);
}

/// Where the records of an uncompressed chunk begin that the file ends in. They are records like those between chunks.
std::optional<std::uint64_t> McapFile::content_of_cut_chunk(std::uint64_t offset) const {
  const auto bytes = file_.read(offset, std::min(kRecordHeaderBytes + kChunkHeadBytes, file_.size() - offset));
  if (!bytes || bytes->size() < kRecordHeaderBytes) return std::nullopt;
  if (static_cast<McapOp>(bytes->front()) != McapOp::kChunk) return std::nullopt;
  const auto head = parse_chunk_head(std::string_view(*bytes).substr(kRecordHeaderBytes));
  if (!head || !head->compression.empty()) return std::nullopt;
  return offset + kRecordHeaderBytes + head->head_bytes;
}

Result<void> McapFile::scan(std::uint64_t begin, std::uint64_t end) {
  for (std::uint64_t offset = begin; offset != end;) {
    const auto record = record_at(offset);
    if (!record) {
      const auto content = content_of_cut_chunk(offset);
      if (!content) return record.error();
      offset = *content;
      continue;
    }
    if (record->op == McapOp::kDataEnd || record->op == McapOp::kFooter) return {};
    if (record->end() > end) return fail("the list of chunks is damaged");
    if (static_cast<std::uint8_t>(record->op) == 0)
      return fail(fmt::format("the record at byte {} is damaged", offset));
    if (const auto done = scan_record(*record); !done) return done;
    offset = record->end();
  }
  return {};
}

Result<void> McapFile::build_index() {
  const std::uint64_t end_bytes = kRecordHeaderBytes + kFooterBytes + kMcapMagic.size();
  if (file_.size() >= end_bytes + kMcapMagic.size()) {
    const std::uint64_t footer = file_.size() - end_bytes;
    const auto bytes = file_.read(footer, end_bytes);
    if (!bytes) return bytes.error();
    ByteReader reader(*bytes);
    const auto op = static_cast<McapOp>(reader.value<std::uint8_t>());
    reader.value<std::uint64_t>();
    const auto summary = reader.value<std::uint64_t>();
    const auto summary_offsets = reader.value<std::uint64_t>();
    const std::uint64_t summary_end = summary_offsets == 0 ? footer : summary_offsets;
    const bool usable = op == McapOp::kFooter && bytes->ends_with(kMcapMagic) && summary != 0 &&
                        summary < summary_end && summary_end <= footer;
    if (usable && read_summary(summary, summary_end).ok()) return {};
  }
  index_ = {};
  chunks_.clear();
  chunk_sizes_.clear();
  cache_.clear();
  topic_of_channel_.clear();
  if (const auto done = scan(kMcapMagic.size(), std::numeric_limits<std::uint64_t>::max()); !done)
    index_.damage = done.error().message;
  return {};
}

Result<ChunkCache::Chunk> McapFile::load_chunk(std::uint32_t part) const {
  return cache_.get(part, [&]() -> Result<std::string> {
    const McapChunk& chunk = chunks_.at(part - 1);
    auto content = file_.read(chunk.offset, chunk.stored_bytes);
    if (!content) return content;
    if (!chunk.compression.empty()) content = decompress(chunk.compression, *content, chunk.size);
    if (!content) return fail(content.error().message);
    if (chunk.crc != 0 && compute_crc32(*content) != chunk.crc)
      return fail("a chunk is damaged (its checksum does not match)");
    return content;
  });
}

Result<std::string> McapFile::read(const MessageEntry& entry, std::size_t max_bytes) const {
  constexpr std::uint64_t kMessageHead = 2 + 4 + 8 + 8;
  // A chunk with a checksum is read as a whole, to compare it.
  const bool in_file = entry.part == kOutsideChunks ||
                       (chunks_.at(entry.part - 1).compression.empty() && chunks_[entry.part - 1].crc == 0);
  if (in_file) {
    const std::uint64_t begin = entry.part == kOutsideChunks ? 0 : chunks_[entry.part - 1].offset;
    const auto record = record_at(begin + entry.offset);
    if (!record) return record.error();
    const bool fits = entry.part == kOutsideChunks || record->end() <= begin + chunks_[entry.part - 1].size;
    if (record->op != McapOp::kMessage || record->bytes < kMessageHead || !fits)
      return fail("a message record is damaged");
    return file_.read(record->offset + kMessageHead, std::min<std::uint64_t>(record->bytes - kMessageHead, max_bytes));
  }
  const auto content = load_chunk(entry.part);
  if (!content) return content.error();
  ByteReader reader(std::string_view(**content).substr(std::min<std::size_t>(entry.offset, (*content)->size())));
  const auto op = static_cast<McapOp>(reader.value<std::uint8_t>());
  const std::string_view record = reader.counted<std::uint64_t>();
  if (!reader.ok() || op != McapOp::kMessage || record.size() < kMessageHead)
    return fail("a message record is damaged");
  return std::string(record.substr(kMessageHead, max_bytes));
}

}  // namespace

RecordingResult open_mcap(const std::filesystem::path& file) {
  auto opened = RandomAccessFile::open(file);
  if (!opened) return opened.error();
  auto mcap = std::make_unique<McapFile>(std::move(*opened));
  if (const auto done = mcap->build_index(); !done) return done.error();
  return RecordingResult(std::move(mcap));
}

}  // namespace resight::recordings
