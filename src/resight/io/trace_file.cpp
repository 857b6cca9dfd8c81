// SPDX-License-Identifier: Apache-2.0
#include "resight/io/trace_file.hpp"

#include <algorithm>

#include "resight/io/internal/member_reader.hpp"

namespace resight {
namespace {

using io::as_integer;
using io::Faults;
using io::member;
using io::MemberReader;
using nlohmann::json;

constexpr const char* kTraceFormat = "resight trace 2";
constexpr std::uint64_t kMaxLineBytes = 8 << 20;  // A line of ours has 0.2 MB at most.

std::optional<StoredFailedTest> read_failed_test(const MemberReader& reader) {
  if (reader["test"].is_null()) return std::nullopt;
  std::optional<StoredFailedTest> failed;
  reader.object("test", [&](const MemberReader& test) {
    failed = {.quantity = test.text("quantity"), .value = test.number("value"), .limit = test.number("limit")};
  });
  return failed;
}

StoredVerification read_verification(const MemberReader& reader, int num_hypotheses) {
  StoredVerification found{.world_from_object = reader.pose("world_from_object"),
                           .failed_test = read_failed_test(reader),
                           .suppressed_by = reader.optional_index("suppressed_by", num_hypotheses),
                           .score = reader.share("score"),
                           .fit = reader.share("fit"),
                           .visible_share = reader.share("visible_share"),
                           .explained_share = reader.share("explained_share"),
                           .pattern_similarity = reader.number("pattern_similarity"),
                           .newest_similarity = reader.number("newest_similarity"),
                           .shared_texture = reader.number("shared_texture"),
                           .texture_contrast = reader.number("texture_contrast"),
                           .explained_scene = reader.number("explained_scene"),
                           .outlier = reader.number("outlier"),
                           .clutter = reader.number("clutter"),
                           .plane = reader.number("plane"),
                           .views = {}};
  reader.each("views", [&](const MemberReader& view) {
    found.views.push_back({view.count("view"), view.share("visible_share"), view.share("explained_share")});
  });
  return found;
}

StoredHypothesis read_hypothesis(const MemberReader& reader, int num_hypotheses) {
  StoredHypothesis hypothesis;
  hypothesis.object = reader.name("object");
  hypothesis.verdict = reader.text("verdict");
  hypothesis.num_correspondences = reader.count("correspondences");
  hypothesis.start = reader.pose("start");
  for (const json& view : reader["origin_views"]) {
    const auto number = as_integer(view);
    if (!number) reader.fault("origin_views", "expected whole numbers");
    hypothesis.origin_views.push_back(number.value_or(0));
  }
  if (!reader["world_from_object"].is_null()) hypothesis.verification = read_verification(reader, num_hypotheses);
  return hypothesis;
}

StoredLoss read_loss(const MemberReader& reader, int num_hypotheses) {
  return {.object = reader.name("object"),
          .world_from_object = reader.pose("world_from_object"),
          .visible_share = reader.share("visible_share"),
          .stage = reader.text("stage"),
          .num_keypoints = reader.count("keypoints"),
          .num_correspondences = reader.count("correspondences"),
          .num_right_correspondences = reader.count("right_correspondences"),
          .center_error_m = reader.number("center_error_m"),
          .rotation_error_rad = reader.number("rotation_error_rad"),
          .hypothesis = reader.optional_index("hypothesis", num_hypotheses)};
}

StoredTrace read_trace(const MemberReader& reader) {
  StoredTrace trace;
  trace.is_searched = reader.flag("searched");
  trace.num_generated = reader.count("generated");
  trace.num_merged = reader.count("merged");
  trace.num_clustered = reader.count("clustered");
  const int num_hypotheses = static_cast<int>(reader["hypotheses"].size());
  reader.each("hypotheses",
              [&](const MemberReader& item) { trace.hypotheses.push_back(read_hypothesis(item, num_hypotheses)); });
  reader.each("lost", [&](const MemberReader& item) { trace.lost.push_back(read_loss(item, num_hypotheses)); });
  return trace;
}

/// Calls `on_line` with offset and size of each whole line from the line that starts at `begin`, until it fails.
template <typename OnLine>
Result<void> find_lines(const InputFile& file, std::uint64_t begin, const OnLine& on_line) {
  std::string block;
  for (std::uint64_t offset = begin; offset < file.size(); offset += block.size()) {
    block.resize(std::min<std::uint64_t>(1 << 20, file.size() - offset));
    if (const auto done = file.read_at(offset, block.data(), block.size()); !done) return done;
    for (std::size_t end = block.find('\n'); end != block.npos; end = block.find('\n', end + 1)) {
      if (const auto done = on_line(begin, offset + end - begin); !done) return done;
      begin = offset + end + 1;
    }
  }
  return {};
}

}  // namespace

Result<TraceFile> TraceFile::open(const std::filesystem::path& file, int num_views) {
  TraceFile trace = follow(file);
  trace.max_views_ = num_views;
  if (const auto found = trace.find_new_views(); !found) return found.error();
  if (trace.num_views() != num_views)
    return file_error(file, fmt::format("traces {} views, but the results have {}", trace.num_views(), num_views));
  return trace;
}

TraceFile TraceFile::follow(std::filesystem::path file) {
  TraceFile trace;
  trace.file_ = std::move(file);
  return trace;
}

Result<void> TraceFile::find_new_views() {
  if (!content_) {
    auto opened = InputFile::open(file_);
    if (!opened) return opened.error();
    content_ = std::make_shared<InputFile>(*std::move(opened));
  }
  if (const auto done = content_->update_size(); !done) return done;
  if (content_->size() < end_offset_) return file_error(file_, "has become shorter");
  std::vector<Line> found;
  const auto add = [&](std::uint64_t offset, std::uint64_t size) -> Result<void> {
    if (end_offset_ == 0) {
      if (const auto done = check_header({offset, size}); !done) return done;
      end_offset_ = size + 1;
      return {};
    }
    if (size == 0) return file_error(file_, fmt::format("line {} is empty", lines_.size() + found.size() + 2));
    if (lines_.size() + found.size() >= static_cast<std::size_t>(max_views_))
      return file_error(file_, fmt::format("traces more views than the results have ({})", max_views_));
    found.push_back({offset, size});
    return {};
  };
  if (const auto done = find_lines(*content_, end_offset_, add); !done) return done;
  if (end_offset_ == 0) return file_error(file_, "is no trace of 'resight recognize --trace'");
  if (!found.empty()) end_offset_ = found.back().offset + found.back().size + 1;
  lines_.insert(lines_.end(), found.begin(), found.end());
  return {};
}

Result<void> TraceFile::check_header(const Line& line) const {
  const auto text = read_line(line);
  if (!text) return text.error();
  const auto content = parse_json(*text);
  if (content.ok() && member(*content, "format") == kTraceFormat) return {};
  return file_error(
      file_, "is no trace of 'resight recognize --trace' of this version (remove it to use the results without it)");
}

Result<std::string> TraceFile::read_line(const Line& line) const {
  if (line.size > kMaxLineBytes) return file_error(file_, "holds a line that is longer than one of ours");
  std::string bytes(line.size, '\0');
  if (const auto done = content_->read_at(line.offset, bytes.data(), bytes.size()); !done) return done.error();
  return bytes;
}

Result<StoredTrace> TraceFile::read(int view, const std::string& name) const {
  if (view >= num_views()) return file_error(file_, fmt::format("has no line of view '{}'", name));
  const Line& line = lines_[static_cast<std::size_t>(view)];
  const auto text = read_line(line);
  if (!text) return text.error();
  const auto content = parse_json(*text);
  if (!content) return file_error(file_, fmt::format("line {}: {}", view + 2, content.error().message));
  Faults faults(file_);
  const MemberReader reader(*content, fmt::format("line {}", view + 2), faults);
  if (reader.integer("view") != view || reader.text("name") != name) reader.fault("view", "is not that of the results");
  StoredTrace trace = read_trace(reader);
  if (faults.first()) return *faults.first();
  return trace;
}

}  // namespace resight
