// SPDX-License-Identifier: Apache-2.0
#include "resight/recordings/internal/decompress.hpp"

#include <bzlib.h>
#include <fmt/format.h>
#include <lz4frame.h>
#include <zstd.h>

#include <algorithm>
#include <limits>
#include <memory>

#include "resight/core/printable.hpp"
#include "resight/recordings/recording.hpp"

namespace resight::recordings {
namespace {

/// Makes room for more output, at most `max_bytes` in all. Output grows as it is written: a small hostile file does
/// not make us allocate the size that it declares.
void grow(std::string& output, std::size_t max_bytes) {
  constexpr std::size_t kMinStep = std::size_t{64} << 10;
  constexpr std::size_t kMaxStep = std::size_t{16} << 20;
  output.resize(std::min(max_bytes, output.size() + std::clamp(output.size(), kMinStep, kMaxStep)));
}

Error damaged(std::string_view compression) {
  return Error{fmt::format("a chunk compressed with {} is damaged", compression)};
}

Result<std::string> decompress_lz4(std::string_view bytes, std::size_t size) {
  LZ4F_dctx* raw = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&raw, LZ4F_VERSION)) != 0U) return Error{"out of memory"};
  const std::unique_ptr<LZ4F_dctx, decltype(&LZ4F_freeDecompressionContext)> context(raw,
                                                                                     &LZ4F_freeDecompressionContext);
  std::string output;
  std::size_t written = 0;
  while (true) {
    if (written == output.size()) grow(output, size + 1);
    std::size_t out_bytes = output.size() - written;
    std::size_t in_bytes = bytes.size();
    const std::size_t hint =
        LZ4F_decompress(context.get(), output.data() + written, &out_bytes, bytes.data(), &in_bytes, nullptr);
    if (LZ4F_isError(hint) != 0U) return damaged("lz4");
    bytes.remove_prefix(in_bytes);
    written += out_bytes;
    if (hint == 0 || written > size || (in_bytes == 0 && out_bytes == 0)) break;
  }
  output.resize(written);
  return output;
}

Result<std::string> decompress_bz2(std::string_view bytes, std::size_t size) {
  bz_stream stream{};
  if (BZ2_bzDecompressInit(&stream, 0, 0) != BZ_OK) return Error{"out of memory"};
  const std::unique_ptr<bz_stream, decltype(&BZ2_bzDecompressEnd)> guard(&stream, &BZ2_bzDecompressEnd);
  if (bytes.size() > std::numeric_limits<unsigned>::max()) return damaged("bz2");
  stream.next_in = const_cast<char*>(bytes.data());
  stream.avail_in = static_cast<unsigned>(bytes.size());
  std::string output;
  std::size_t written = 0;
  while (true) {
    if (written == output.size()) grow(output, size + 1);
    const std::size_t space = output.size() - written;
    stream.next_out = output.data() + written;
    stream.avail_out = static_cast<unsigned>(space);
    const int code = BZ2_bzDecompress(&stream);
    const std::size_t got = space - stream.avail_out;
    written += got;
    if (code == BZ_STREAM_END || written > size) break;
    if (code != BZ_OK || (got == 0 && stream.avail_in == 0)) return damaged("bz2");
  }
  output.resize(written);
  return output;
}

Result<std::string> decompress_zstd(std::string_view bytes, std::size_t size) {
  const std::unique_ptr<ZSTD_DCtx, decltype(&ZSTD_freeDCtx)> context(ZSTD_createDCtx(), &ZSTD_freeDCtx);
  if (context == nullptr) return Error{"out of memory"};
  ZSTD_inBuffer input{bytes.data(), bytes.size(), 0};
  std::string output;
  std::size_t written = 0;
  while (true) {
    if (written == output.size()) grow(output, size + 1);
    ZSTD_outBuffer out{output.data(), output.size(), written};
    const std::size_t before = input.pos;
    const std::size_t hint = ZSTD_decompressStream(context.get(), &out, &input);
    if (ZSTD_isError(hint) != 0U) return damaged("zstd");
    const bool progress = out.pos > written || input.pos > before;
    written = out.pos;
    const bool frames_end = hint == 0 && input.pos == input.size;
    if (frames_end || written > size || !progress) break;
  }
  output.resize(written);
  return output;
}

}  // namespace

Result<std::string> decompress(std::string_view compression, std::string_view bytes, std::uint64_t size) {
  if (size > kMaxChunkBytes) return Error{fmt::format("a chunk declares {} bytes (at most {})", size, kMaxChunkBytes)};
  Result<std::string> output = Error{fmt::format("the compression '{}' is not supported (none, lz4, bz2 and zstd are)",
                                                 printable(compression.substr(0, 20)))};
  if (compression == "lz4") output = decompress_lz4(bytes, size);
  if (compression == "bz2") output = decompress_bz2(bytes, size);
  if (compression == "zstd") output = decompress_zstd(bytes, size);
  if (output.ok() && output->size() != size) return damaged(compression);
  return output;
}

Result<std::string> decompress_start(std::string_view bytes, std::size_t max_bytes) {
  auto output = decompress_zstd(bytes, max_bytes);
  if (output.ok() && output->size() > max_bytes) output->resize(max_bytes);
  return output;
}

}  // namespace resight::recordings
