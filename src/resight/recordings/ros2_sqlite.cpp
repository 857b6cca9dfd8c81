// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <sqlite3.h>

#include <algorithm>
#include <map>
#include <mutex>

#include "resight/core/files.hpp"
#include "resight/core/printable.hpp"
#include "resight/recordings/internal/containers.hpp"
#include "resight/recordings/internal/decompress.hpp"
#include "resight/recordings/internal/random_access_file.hpp"

/// ROS 2 bags in SQLite: tables `topics` and `messages`.
namespace resight::recordings {
namespace {

struct DatabaseCloser {
  void operator()(sqlite3* database) const { sqlite3_close_v2(database); }
};
struct StatementCloser {
  void operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
};
using Database = std::unique_ptr<sqlite3, DatabaseCloser>;
struct BlobCloser {
  void operator()(sqlite3_blob* blob) const { sqlite3_blob_close(blob); }
};
using Blob = std::unique_ptr<sqlite3_blob, BlobCloser>;
using Statement = std::unique_ptr<sqlite3_stmt, StatementCloser>;

/// The tables of a hostile file may be views that never end.
constexpr int kStepsPerCheck = 1000000;
constexpr int kMaxChecks = 20000;

int count_steps(void* checks) { return ++*static_cast<int*>(checks) > kMaxChecks ? 1 : 0; }

std::string_view column_text(sqlite3_stmt* statement, int column) {
  const auto* text = reinterpret_cast<const char*>(sqlite3_column_text(statement, column));
  const int bytes = sqlite3_column_bytes(statement, column);
  return text == nullptr ? std::string_view() : std::string_view(text, static_cast<std::size_t>(bytes));
}

class Ros2Sqlite final : public IndexedRecording {
 public:
  Ros2Sqlite(std::filesystem::path file, Database database) : file_(std::move(file)), database_(std::move(database)) {
    sqlite3_limit(database_.get(), SQLITE_LIMIT_LENGTH, static_cast<int>(kMaxMessageBytes));
    sqlite3_db_config(database_.get(), SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
    sqlite3_db_config(database_.get(), SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
    sqlite3_db_config(database_.get(), SQLITE_DBCONFIG_ENABLE_TRIGGER, 0, nullptr);
    sqlite3_db_config(database_.get(), SQLITE_DBCONFIG_ENABLE_VIEW, 0, nullptr);
    sqlite3_progress_handler(database_.get(), kStepsPerCheck, &count_steps, &checks_);
  }

  [[nodiscard]] std::string format() const override { return "rosbag2-sqlite3"; }

  [[nodiscard]] Result<std::string> read(const MessageEntry& entry, std::size_t max_bytes) const override;
  [[nodiscard]] Result<void> build_index();

 private:
  [[nodiscard]] Result<Statement> prepare(const char* sql) const;
  [[nodiscard]] Result<std::string> read_blob(const MessageEntry& entry, std::size_t max_bytes) const;
  [[nodiscard]] Result<void> read_topics();
  [[nodiscard]] Result<std::uint64_t> declared_bytes() const;
  [[nodiscard]] Error fail() const {
    return file_error(file_,
                      fmt::format("cannot be read as a ROS 2 bag ({})", printable(sqlite3_errmsg(database_.get()))));
  }

  std::filesystem::path file_;
  mutable std::mutex mutex_;
  mutable int checks_ = 0;
  Database database_;
  std::map<std::int64_t, int> topic_of_id_;
};

Result<Statement> Ros2Sqlite::prepare(const char* sql) const {
  sqlite3_stmt* raw = nullptr;
  const int code = sqlite3_prepare_v2(database_.get(), sql, -1, &raw, nullptr);
  Statement statement(raw);
  if (code != SQLITE_OK) return fail();
  return Result<Statement>(std::move(statement));
}

Result<void> Ros2Sqlite::read_topics() {
  const auto statement = prepare("SELECT id, name, type, serialization_format FROM topics ORDER BY id");
  if (!statement) return statement.error();
  sqlite3_stmt* row = statement->get();
  int code = SQLITE_ROW;
  while ((code = sqlite3_step(row)) == SQLITE_ROW) {
    const bool is_cdr = column_text(row, 3) == "cdr";
    const auto number = index_.add_topic({std::string(column_text(row, 1)), without_msg(column_text(row, 2)),
                                          is_cdr ? MessageLayout::kCdr : MessageLayout::kOther});
    if (!number) return file_error(file_, number.error().message);
    topic_of_id_[sqlite3_column_int64(row, 0)] = *number;
  }
  if (code != SQLITE_DONE) return fail();
  return {};
}

/// Size of the whole database, by its header.
Result<std::uint64_t> Ros2Sqlite::declared_bytes() const {
  std::uint64_t bytes = 1;
  for (const char* factor : {"PRAGMA page_count", "PRAGMA page_size"}) {
    const auto statement = prepare(factor);
    if (!statement) return statement.error();
    if (sqlite3_step(statement->get()) != SQLITE_ROW) return fail();
    bytes *= static_cast<std::uint64_t>(sqlite3_column_int64(statement->get(), 0));
  }
  return bytes;
}

Result<void> Ros2Sqlite::build_index() {
  if (const auto done = read_topics(); !done) return done;
  const auto statement = prepare("SELECT rowid, topic_id, timestamp FROM messages ORDER BY id, rowid");
  if (!statement) return statement.error();
  sqlite3_stmt* row = statement->get();
  int code = SQLITE_ROW;
  std::size_t num_without_topic = 0;
  while ((code = sqlite3_step(row)) == SQLITE_ROW) {
    const auto topic = topic_of_id_.find(sqlite3_column_int64(row, 1));
    if (topic == topic_of_id_.end()) {
      ++num_without_topic;
      continue;
    }
    if (index_.messages.size() >= kMaxMessages) return file_error(file_, "holds too many messages");
    index_.messages.push_back(
        {sqlite3_column_int64(row, 2), topic->second, 0, static_cast<std::uint64_t>(sqlite3_column_int64(row, 0))});
  }
  if (code != SQLITE_DONE) {
    index_.damage = fail().message;
    return {};
  }
  const auto whole_bytes = declared_bytes();
  if (!whole_bytes) return whole_bytes.error();
  std::error_code ignored;
  const std::uint64_t file_bytes = std::filesystem::file_size(file_, ignored);
  // Without a word, SQLite takes what a cut last page lacks as zeros.
  if (file_bytes < *whole_bytes)
    index_.damage =
        file_error(file_, fmt::format("is cut off: it has {} of {} bytes", file_bytes, *whole_bytes)).message;
  else if (num_without_topic > 0)
    index_.damage = file_error(file_, fmt::format("{} of its messages belong to no topic", num_without_topic)).message;
  return {};
}

Result<std::string> Ros2Sqlite::read(const MessageEntry& entry, std::size_t max_bytes) const {
  // Bags may compress each message. No message in CDR begins like this.
  constexpr std::string_view kZstdMagic = "\x28\xb5\x2f\xfd";
  const std::lock_guard lock(mutex_);
  checks_ = 0;
  auto bytes = read_blob(entry, max_bytes);
  if (!bytes || !bytes->starts_with(kZstdMagic)) return bytes;
  const auto whole = read_blob(entry, kMaxMessageBytes);
  if (!whole) return whole;
  auto message = decompress_start(*whole, max_bytes);
  if (!message) return file_error(file_, message.error().message);
  return message;
}

/// By the row, which needs no index of the ids.
Result<std::string> Ros2Sqlite::read_blob(const MessageEntry& entry, std::size_t max_bytes) const {
  sqlite3_blob* raw = nullptr;
  const int code =
      sqlite3_blob_open(database_.get(), "main", "messages", "data", static_cast<sqlite3_int64>(entry.offset), 0, &raw);
  const Blob blob(raw);
  if (code != SQLITE_OK) return fail();
  std::string bytes(std::min(static_cast<std::size_t>(sqlite3_blob_bytes(raw)), max_bytes), '\0');
  if (sqlite3_blob_read(raw, bytes.data(), static_cast<int>(bytes.size()), 0) != SQLITE_OK) return fail();
  return bytes;
}

/// What the writer of a database has not moved into it yet lies in a file beside it. To read that file, SQLite would
/// have to write another one.
bool has_write_ahead_log(const std::filesystem::path& database) {
  std::filesystem::path log = database;
  log += "-wal";
  std::error_code error;
  return std::filesystem::is_regular_file(log, error) && std::filesystem::file_size(log, error) > 0 && !error;
}

}  // namespace

RecordingResult open_ros2_sqlite(const std::filesystem::path& file) {
  const auto checked = RandomAccessFile::open(file);
  if (!checked) return checked.error();
  if (has_write_ahead_log(file))
    return file_error(file,
                      "was not closed: its last messages are still in a write-ahead log beside it; move them into it "
                      "with: sqlite3 FILE 'PRAGMA wal_checkpoint(TRUNCATE)'");
  sqlite3* raw = nullptr;
  // immutable: no journal or lock is written beside the file.
  std::string uri = "file:";
  for (const char c : std::filesystem::absolute(file).string())
    uri += c == '?' || c == '#' || c == '%' ? fmt::format("%{:02x}", static_cast<unsigned char>(c)) : std::string(1, c);
  uri += "?immutable=1";
  const int code = sqlite3_open_v2(uri.c_str(), &raw, SQLITE_OPEN_READONLY | SQLITE_OPEN_URI, nullptr);
  Database database(raw);
  if (code != SQLITE_OK) return file_error(file, "cannot be opened as a database");
  auto bag = std::make_unique<Ros2Sqlite>(file, std::move(database));
  if (const auto done = bag->build_index(); !done) return done.error();
  return RecordingResult(std::move(bag));
}

}  // namespace resight::recordings
