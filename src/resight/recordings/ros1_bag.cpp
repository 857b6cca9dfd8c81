// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>

#include "resight/core/files.hpp"
#include "resight/recordings/internal/byte_reader.hpp"
#include "resight/recordings/internal/chunk_cache.hpp"
#include "resight/recordings/internal/containers.hpp"
#include "resight/recordings/internal/decompress.hpp"
#include "resight/recordings/internal/random_access_file.hpp"

/// ROS bag format 2.0 (wiki.ros.org/Bags/Format/2.0): records of a header (fields name=value) and data. Messages lie in
/// chunks; behind each chunk is its index, and at the end of the file are connections and a list of all chunks.
namespace resight::recordings {
namespace {

enum class BagOp : std::uint8_t {
  kMessage = 0x02,
  kBagHeader = 0x03,
  kIndexData = 0x04,
  kChunk = 0x05,
  kChunkInfo = 0x06,
  kConnection = 0x07
};

constexpr std::uint64_t kMaxHeaderBytes = 1U << 20;
constexpr std::uint64_t kMaxIndexBytes = std::uint64_t{1} << 28;

/// The fields of a header. They borrow its bytes.
class BagFields {
 public:
  [[nodiscard]] static std::optional<BagFields> parse(std::string_view header) {
    BagFields fields;
    ByteReader reader(header);
    while (reader.ok() && !reader.at_end()) {
      const std::string_view field = reader.counted<std::uint32_t>();
      const std::size_t equal = field.find('=');
      if (!reader.ok() || equal == field.npos) return std::nullopt;
      fields.fields_[field.substr(0, equal)] = field.substr(equal + 1);
    }
    return fields;
  }
  [[nodiscard]] std::optional<std::string_view> text(std::string_view name) const {
    const auto it = fields_.find(name);
    return it == fields_.end() ? std::nullopt : std::optional(it->second);
  }
  template <typename T>
  [[nodiscard]] std::optional<T> number(std::string_view name) const {
    const auto bytes = text(name);
    if (!bytes || bytes->size() != sizeof(T)) return std::nullopt;
    return ByteReader(*bytes).value<T>();
  }
  [[nodiscard]] bool is(BagOp op) const { return number<std::uint8_t>("op") == static_cast<std::uint8_t>(op); }

 private:
  std::map<std::string_view, std::string_view> fields_;
};

std::int64_t to_nanoseconds(std::uint64_t time) {
  return static_cast<std::int64_t>(time & 0xFFFFFFFFU) * 1000000000 + static_cast<std::int64_t>(time >> 32);
}

struct BagChunk {
  std::string compression;
  std::uint64_t data_offset = 0;
  std::uint32_t stored_bytes = 0;
  std::uint32_t size = 0;  ///< Uncompressed.
};

/// A record of the file, whose data are not read yet.
struct BagRecord {
  std::string header;
  std::uint64_t data_offset = 0;
  std::uint32_t data_bytes = 0;
  [[nodiscard]] std::uint64_t end() const { return data_offset + data_bytes; }
};

class Ros1Bag final : public IndexedRecording {
 public:
  explicit Ros1Bag(RandomAccessFile file) : file_(std::move(file)), chunk_sizes_(file_.size()) {}

  [[nodiscard]] std::string format() const override { return "rosbag"; }

  [[nodiscard]] Result<std::string> read(const MessageEntry& entry, std::size_t max_bytes) const override;

  /// Reads the index at the end of the file; without a usable one, walks over the whole file.
  [[nodiscard]] Result<void> build_index();

 private:
  [[nodiscard]] Result<BagRecord> read_record(std::uint64_t offset) const;
  [[nodiscard]] Result<void> read_end_index(std::uint64_t offset);
  /// Both return where the index of the chunk ends.
  [[nodiscard]] Result<std::uint64_t> index_chunk_at(std::uint64_t offset);
  [[nodiscard]] Result<std::uint64_t> add_index_records(std::uint64_t offset, std::uint32_t chunk);
  [[nodiscard]] Result<std::uint64_t> add_chunk(const BagRecord& record);
  [[nodiscard]] Result<void> scan(std::uint64_t begin);
  [[nodiscard]] Result<void> scan_chunk(std::uint32_t chunk);
  [[nodiscard]] Result<void> add_connection(const BagFields& fields, std::string_view data);
  [[nodiscard]] Result<void> add_message(std::uint32_t connection, std::uint64_t time, std::uint32_t chunk,
                                         std::uint64_t offset);
  [[nodiscard]] Result<ChunkCache::Chunk> load_chunk(std::uint32_t number) const;
  [[nodiscard]] Error fail(std::string_view what) const { return file_error(file_.path(), what); }

  RandomAccessFile file_;
  std::vector<BagChunk> chunks_;
  std::map<std::uint32_t, int> topic_of_connection_;
  ChunkSizes chunk_sizes_;
  ChunkCache cache_;
};

Result<BagRecord> Ros1Bag::read_record(std::uint64_t offset) const {
  BagRecord record;
  const auto header_size = file_.read(offset, 4);
  if (!header_size) return header_size.error();
  const auto header_bytes = ByteReader(*header_size).value<std::uint32_t>();
  if (header_bytes > kMaxHeaderBytes)
    return fail(fmt::format("the record at byte {} declares a header of {} bytes (damaged)", offset, header_bytes));
  auto rest = file_.read(offset + 4, std::uint64_t{header_bytes} + 4);
  if (!rest) return rest.error();
  record.data_bytes = ByteReader(std::string_view(*rest).substr(header_bytes)).value<std::uint32_t>();
  record.data_offset = offset + 8 + header_bytes;
  rest->resize(header_bytes);
  record.header = std::move(*rest);
  if (record.end() > file_.size()) return fail(fmt::format("ends within the record at byte {} (cut off)", offset));
  return record;
}

Result<void> Ros1Bag::add_connection(const BagFields& fields, std::string_view data) {
  const auto number = fields.number<std::uint32_t>("conn");
  const auto topic = fields.text("topic");
  const auto content = BagFields::parse(data);
  if (!number || !topic || !content) return fail("a connection record is damaged");
  if (topic_of_connection_.contains(*number)) return {};
  const std::string type(content->text("type").value_or(""));
  // Several publishers of one topic have connections of their own.
  const auto added = index_.add_topic({std::string(*topic), type, MessageLayout::kRos1});
  if (!added) return fail(added.error().message);
  topic_of_connection_[*number] = *added;
  return {};
}

Result<void> Ros1Bag::add_message(std::uint32_t connection, std::uint64_t time, std::uint32_t chunk,
                                  std::uint64_t offset) {
  const auto topic = topic_of_connection_.find(connection);
  if (topic == topic_of_connection_.end()) return fail("a message belongs to no connection (damaged)");
  if (index_.messages.size() >= kMaxMessages) return fail("holds too many messages");
  index_.messages.push_back({to_nanoseconds(time), topic->second, chunk, offset});
  return {};
}

Result<std::uint64_t> Ros1Bag::add_chunk(const BagRecord& record) {
  const auto fields = BagFields::parse(record.header);
  const auto compression = fields ? fields->text("compression") : std::nullopt;
  const auto size = fields ? fields->number<std::uint32_t>("size") : std::nullopt;
  if (!compression || !size || !fields->is(BagOp::kChunk)) return fail("a chunk record is damaged");
  if (const auto done = chunk_sizes_.add(*size); !done) return fail(done.error().message);
  if (*compression == "none" && *size != record.data_bytes) return fail("the size of a chunk is wrong (damaged)");
  chunks_.push_back({std::string(*compression), record.data_offset, record.data_bytes, *size});
  return chunks_.size() - 1;
}

/// The records that follow a chunk say where its messages are.
Result<std::uint64_t> Ros1Bag::add_index_records(std::uint64_t offset, std::uint32_t chunk) {
  while (offset < file_.size()) {
    const auto record = read_record(offset);
    if (!record) return record.error();
    const auto fields = BagFields::parse(record->header);
    if (!fields || !fields->is(BagOp::kIndexData)) return offset;
    const auto connection = fields->number<std::uint32_t>("conn");
    if (!connection || record->data_bytes > kMaxIndexBytes) return fail("an index record is damaged");
    const auto data = file_.read(record->data_offset, record->data_bytes);
    if (!data) return data.error();
    ByteReader reader(*data);
    while (!reader.at_end()) {
      const auto time = reader.value<std::uint64_t>();
      const auto place = reader.value<std::uint32_t>();
      if (!reader.ok() || place >= chunks_[chunk].size) return fail("an index record is damaged");
      if (const auto done = add_message(*connection, time, chunk, place); !done) return done.error();
    }
    offset = record->end();
  }
  return offset;
}

Result<std::uint64_t> Ros1Bag::index_chunk_at(std::uint64_t offset) {
  const auto record = read_record(offset);
  if (!record) return record.error();
  const auto chunk = add_chunk(*record);
  if (!chunk) return chunk.error();
  return add_index_records(record->end(), static_cast<std::uint32_t>(*chunk));
}

Result<void> Ros1Bag::read_end_index(std::uint64_t offset) {
  std::vector<std::uint64_t> chunk_offsets;
  while (offset < file_.size()) {
    const auto record = read_record(offset);
    if (!record) return record.error();
    const auto fields = BagFields::parse(record->header);
    if (!fields) return fail("the index is damaged");
    if (fields->is(BagOp::kConnection)) {
      const auto data = file_.read(record->data_offset, record->data_bytes);
      if (!data) return data.error();
      if (const auto done = add_connection(*fields, *data); !done) return done;
    } else if (fields->is(BagOp::kChunkInfo)) {
      chunk_offsets.push_back(fields->number<std::uint64_t>("chunk_pos").value_or(file_.size()));
    } else {
      return fail("the index is damaged");
    }
    offset = record->end();
  }
  std::ranges::sort(chunk_offsets);
  // Of chunks within each other, each would read the same bytes again.
  std::uint64_t end_of_last = 0;
  for (const std::uint64_t chunk : chunk_offsets) {
    if (chunk < end_of_last) return fail("the index is damaged");
    const auto chunk_end = index_chunk_at(chunk);
    if (!chunk_end) return chunk_end.error();
    end_of_last = *chunk_end;
  }
  return {};
}

Result<void> Ros1Bag::scan_chunk(std::uint32_t number) {
  const auto chunk = load_chunk(number);
  if (!chunk) return chunk.error();
  const std::string_view content = **chunk;
  ByteReader reader(content);
  while (!reader.at_end()) {
    const std::uint64_t place = content.size() - reader.rest().size();
    const auto fields = BagFields::parse(reader.counted<std::uint32_t>());
    const std::string_view data = reader.counted<std::uint32_t>();
    if (!reader.ok() || !fields) return fail("a record in a chunk is damaged");
    if (fields->is(BagOp::kConnection)) {
      if (const auto done = add_connection(*fields, data); !done) return done;
    } else if (fields->is(BagOp::kMessage)) {
      const auto connection = fields->number<std::uint32_t>("conn");
      const auto time = fields->number<std::uint64_t>("time");
      if (!connection || !time) return fail("a message record is damaged");
      if (const auto done = add_message(*connection, *time, number, place); !done) return done;
    }
  }
  return {};
}

/// Walks over the file. Connections lie within the chunks, so that all of these are decompressed.
Result<void> Ros1Bag::scan(std::uint64_t begin) {
  for (std::uint64_t offset = begin; offset < file_.size();) {
    const auto record = read_record(offset);
    if (!record) return record.error();
    const auto fields = BagFields::parse(record->header);
    if (!fields) return fail(fmt::format("the record at byte {} is damaged", offset));
    if (fields->is(BagOp::kChunk)) {
      const auto chunk = add_chunk(*record);
      if (!chunk) return chunk.error();
      if (const auto done = scan_chunk(static_cast<std::uint32_t>(*chunk)); !done) return done;
    } else if (fields->is(BagOp::kConnection)) {
      const auto data = file_.read(record->data_offset, record->data_bytes);
      if (!data) return data.error();
      if (const auto done = add_connection(*fields, *data); !done) return done;
    } else if (!fields->is(BagOp::kIndexData) && !fields->is(BagOp::kChunkInfo)) {
      return fail(fmt::format("the record at byte {} is damaged", offset));
    }
    offset = record->end();
  }
  return {};
}

Result<void> Ros1Bag::build_index() {
  const auto first = read_record(kRos1BagMagic.size());
  if (!first) return first.error();
  const auto fields = BagFields::parse(first->header);
  if (!fields || !fields->is(BagOp::kBagHeader)) return fail("its bag header is damaged");
  const auto end_index = fields->number<std::uint64_t>("index_pos").value_or(0);
  const auto num_chunks = fields->number<std::uint32_t>("chunk_count").value_or(0);
  if (end_index > first->end() && end_index <= file_.size()) {
    if (read_end_index(end_index).ok() && chunks_.size() == num_chunks) return {};
    index_ = {};
    chunks_.clear();
    chunk_sizes_.clear();
    cache_.clear();
    topic_of_connection_.clear();
  } else if (num_chunks == 0 && end_index == first->end()) {
    return {};  // an empty bag
  }
  if (const auto done = scan(first->end()); !done) index_.damage = done.error().message;
  return {};
}

Result<ChunkCache::Chunk> Ros1Bag::load_chunk(std::uint32_t number) const {
  return cache_.get(number, [&]() -> Result<std::string> {
    const BagChunk& chunk = chunks_.at(number);
    auto stored = file_.read(chunk.data_offset, chunk.stored_bytes);
    if (!stored || chunk.compression == "none") return stored;
    auto content = decompress(chunk.compression, *stored, chunk.size);
    if (!content) return fail(content.error().message);
    return content;
  });
}

Result<std::string> Ros1Bag::read(const MessageEntry& entry, std::size_t max_bytes) const {
  const BagChunk& chunk = chunks_.at(entry.part);
  if (chunk.compression == "none") {  // straight from the file
    const auto record = read_record(chunk.data_offset + entry.offset);
    if (!record) return record.error();
    if (record->end() > chunk.data_offset + chunk.size) return fail("a message ends beyond its chunk (damaged)");
    return file_.read(record->data_offset, std::min<std::uint64_t>(record->data_bytes, max_bytes));
  }
  const auto content = load_chunk(entry.part);
  if (!content) return content.error();
  ByteReader reader(std::string_view(**content).substr(std::min<std::size_t>(entry.offset, (*content)->size())));
  reader.counted<std::uint32_t>();
  const std::string_view data = reader.counted<std::uint32_t>();
  if (!reader.ok()) return fail("a message ends beyond its chunk (damaged)");
  return std::string(data.substr(0, max_bytes));
}

}  // namespace

RecordingResult open_ros1_bag(const std::filesystem::path& file) {
  auto opened = RandomAccessFile::open(file);
  if (!opened) return opened.error();
  auto bag = std::make_unique<Ros1Bag>(std::move(*opened));
  if (const auto done = bag->build_index(); !done) return done.error();
  return RecordingResult(std::move(bag));
}

}  // namespace resight::recordings
