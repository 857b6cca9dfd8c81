// SPDX-License-Identifier: Apache-2.0
#include "resight/models/library_file.hpp"

#include <fmt/format.h>

#include <array>
#include <bit>
#include <cstring>
#include <fstream>
#include <memory>
#include <span>
#include <system_error>

#include "resight/core/files.hpp"
#include "resight/core/hash.hpp"
#include "resight/models/internal/library_payload.hpp"

namespace resight {
namespace {

static_assert(std::endian::native == std::endian::little, "the file format is little-endian");

constexpr std::array<char, 8> kMagic{'R', 'E', 'S', 'I', 'G', 'H', 'T', 'M'};
constexpr std::uint32_t kFormatVersion = 1;

struct Header {
  std::array<char, 8> magic = kMagic;
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
  return {fmt::format("model library {}: {}", path.string(), what)};
}

std::string_view as_text(std::span<const std::uint8_t> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// The bytes of a file. The memory is not initialised before reading.
struct FileBytes {
  std::unique_ptr<std::uint8_t[]> data;
  std::size_t size = 0;
  [[nodiscard]] std::span<const std::uint8_t> all() const { return {data.get(), size}; }
};

Result<FileBytes> read_file(const std::filesystem::path& path) {
  std::error_code code;
  if (!std::filesystem::is_regular_file(path, code)) {
    return fail(path, std::filesystem::exists(path, code) ? "not a file" : "no such file");
  }
  const std::uintmax_t size = std::filesystem::file_size(path, code);
  std::ifstream file(path, std::ios::binary);
  if (code || !file) return fail(path, "cannot be opened");
  FileBytes bytes{std::make_unique_for_overwrite<std::uint8_t[]>(size), size};
  file.read(reinterpret_cast<char*>(bytes.data.get()), static_cast<std::streamsize>(size));
  if (static_cast<std::uintmax_t>(file.gcount()) != size) return fail(path, "cannot be read to its end");
  return bytes;
}

// The order of the tests determines the first error that the user sees: kind of file, version, completeness.
Result<Header> read_header(const std::filesystem::path& path, std::span<const std::uint8_t> bytes) {
  Header header;
  const std::size_t magic_bytes = std::min(bytes.size(), kMagic.size());
  if (magic_bytes == 0 || std::memcmp(bytes.data(), kMagic.data(), magic_bytes) != 0)
    return fail(path, "not a model library (expected a file written by 'train')");
  if (bytes.size() < sizeof(Header))
    return fail(path, fmt::format("truncated within its header ({} bytes)", bytes.size()));
  std::memcpy(&header, bytes.data(), sizeof(Header));
  if (header.version != kFormatVersion) {
    return fail(path,
                fmt::format("written in format version {} (expected {}); train again", header.version, kFormatVersion));
  }
  const std::uint64_t present = bytes.size() - sizeof(Header);
  if (present < header.payload_bytes)
    return fail(path, fmt::format("truncated: {} of {} bytes present", present, header.payload_bytes));
  if (present > header.payload_bytes)
    return fail(path, fmt::format("damaged: {} bytes too many at its end", present - header.payload_bytes));
  if (header.checksum != compute_checksum(header, bytes.subspan(sizeof(Header))))
    return fail(path, "damaged: its checksum does not match its content");
  return header;
}

}  // namespace

Result<void> save_library(const ModelLibrary& library, const std::filesystem::path& path) {
  const Result<std::vector<std::uint8_t>> payload = internal::encode_payload(library);
  if (!payload.ok()) return fail(path, payload.error().message);
  Header header;
  header.options_hash = library.options_hash;
  header.payload_bytes = payload->size();
  header.checksum = compute_checksum(header, *payload);
  const auto header_bytes = std::bit_cast<HeaderBytes>(header);
  const Result<void> written = write_file(path, {as_text(header_bytes), as_text(*payload)});
  if (!written.ok()) return Error{"model library " + written.error().message};
  return {};
}

Result<ModelLibrary> load_library(const std::filesystem::path& path,
                                  std::optional<std::uint64_t> expected_options_hash) {
  const Result<FileBytes> bytes = read_file(path);
  if (!bytes.ok()) return bytes.error();
  const Result<Header> header = read_header(path, bytes->all());
  if (!header.ok()) return header.error();
  if (expected_options_hash.has_value() && header->options_hash != *expected_options_hash) {
    return fail(path, fmt::format("trained with other options (hash {:016x}, expected {:016x}); train again",
                                  header->options_hash, *expected_options_hash));
  }
  Result<ModelLibrary> library = internal::decode_payload(bytes->all().subspan(sizeof(Header)));
  if (!library.ok()) return fail(path, library.error().message);
  library->options_hash = header->options_hash;
  return library;
}

}  // namespace resight
