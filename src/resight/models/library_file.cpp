// SPDX-License-Identifier: Apache-2.0
#include "resight/models/library_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <memory>
#include <span>

#include "resight/core/files.hpp"
#include "resight/core/hash.hpp"
#include "resight/core/input_file.hpp"
#include "resight/models/internal/library_payload.hpp"

namespace resight {
namespace {

static_assert(std::endian::native == std::endian::little, "the file format is little-endian");

constexpr std::uint32_t kFormatVersion = 1;
const std::string kKind = "model library ";  // begins all messages

struct Header {
  std::array<char, kLibrarySignature.size()> magic{};
  std::uint32_t version = kFormatVersion;
  std::uint32_t reserved = 0;
  std::uint64_t options_hash = 0;
  std::uint64_t payload_bytes = 0;
  std::uint64_t checksum = 0;  ///< Covers the fields above and the payload.
};
static_assert(sizeof(Header) == 40);

using HeaderBytes = std::array<std::uint8_t, sizeof(Header)>;

std::uint64_t compute_checksum(const Header& header, std::span<const std::uint8_t> payload) {
  const auto bytes = std::bit_cast<HeaderBytes>(header);
  return checksum_bytes(payload, checksum_bytes(std::span(bytes).first(offsetof(Header, checksum))));
}

Error fail(const std::filesystem::path& path, const std::string& what) {
  return {fmt::format("{}{}: {}", kKind, path.string(), what)};
}

std::string_view as_text(std::span<const std::uint8_t> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

struct LibraryBytes {
  Header header;
  std::unique_ptr<std::uint8_t[]> payload;  ///< Not initialised before reading.
  [[nodiscard]] std::span<const std::uint8_t> payload_span() const { return {payload.get(), header.payload_bytes}; }
};

// The order of the tests determines the first error that the user sees: kind of file, version, completeness.
Result<Header> read_header(const std::filesystem::path& path, InputFile& file) {
  std::array<std::uint8_t, sizeof(Header)> bytes{};
  const std::size_t num_bytes = std::min<std::uintmax_t>(file.size(), bytes.size());
  if (const auto done = file.read(bytes.data(), num_bytes); !done) return Error{kKind + done.error().message};
  const std::size_t magic_bytes = std::min(num_bytes, kLibrarySignature.size());
  if (magic_bytes == 0 || std::memcmp(bytes.data(), kLibrarySignature.data(), magic_bytes) != 0)
    return fail(path, "not a model library (expected a file written by 'train')");
  if (num_bytes < sizeof(Header)) return fail(path, fmt::format("truncated within its header ({} bytes)", num_bytes));
  const Header header = std::bit_cast<Header>(bytes);
  if (header.version != kFormatVersion) {
    return fail(path,
                fmt::format("written in format version {} (expected {}); train again", header.version, kFormatVersion));
  }
  const std::uint64_t present = file.size() - sizeof(Header);
  if (present < header.payload_bytes)
    return fail(path, fmt::format("truncated: {} of {} bytes present", present, header.payload_bytes));
  if (present > header.payload_bytes)
    return fail(path, fmt::format("damaged: {} bytes too many at its end", present - header.payload_bytes));
  return header;
}

// The header is checked before memory is allocated for what it announces.
Result<LibraryBytes> read_library(const std::filesystem::path& path) {
  auto file = InputFile::open(path);
  if (!file) return Error{kKind + file.error().message};
  const Result<Header> header = read_header(path, *file);
  if (!header) return header.error();
  if (header->payload_bytes > internal::kMaxPayloadBytes)
    return fail(path, fmt::format("damaged: {} bytes are more than a library can have", header->payload_bytes));
  LibraryBytes bytes{*header, std::make_unique_for_overwrite<std::uint8_t[]>(header->payload_bytes)};
  const auto done = file->read(bytes.payload.get(), header->payload_bytes);
  if (!done) return Error{kKind + done.error().message};
  if (header->checksum != compute_checksum(*header, bytes.payload_span()))
    return fail(path, "damaged: its checksum does not match its content");
  return bytes;
}

}  // namespace

Result<void> save_library(const ModelLibrary& library, const std::filesystem::path& path) {
  const Result<std::vector<std::uint8_t>> payload = internal::encode_payload(library);
  if (!payload.ok()) return fail(path, payload.error().message);
  if (const auto decoded = internal::decode_payload(*payload); !decoded.ok())
    return fail(path, fmt::format("is not written, as it could not be read again ({})", decoded.error().message));
  Header header;
  std::ranges::copy(kLibrarySignature, header.magic.begin());
  header.options_hash = library.options_hash;
  header.payload_bytes = payload->size();
  header.checksum = compute_checksum(header, *payload);
  const auto header_bytes = std::bit_cast<HeaderBytes>(header);
  const Result<void> written = write_file(path, {as_text(header_bytes), as_text(*payload)});
  if (!written.ok()) return Error{kKind + written.error().message};
  return {};
}

Result<ModelLibrary> load_library(const std::filesystem::path& path,
                                  std::optional<std::uint64_t> expected_options_hash) {
  const Result<LibraryBytes> bytes = read_library(path);
  if (!bytes.ok()) return bytes.error();
  const Header& header = bytes->header;
  if (expected_options_hash.has_value() && header.options_hash != *expected_options_hash) {
    return fail(path, fmt::format("trained with other options (hash {:016x}, expected {:016x}); train again",
                                  header.options_hash, *expected_options_hash));
  }
  Result<ModelLibrary> library = internal::decode_payload(bytes->payload_span());
  if (!library.ok()) return fail(path, library.error().message);
  library->options_hash = header.options_hash;
  return library;
}

}  // namespace resight
