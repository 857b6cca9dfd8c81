// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <zip.h>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "resight/core/printable.hpp"
#include "resight/io/images.hpp"
#include "resight/io/internal/depth_arrays.hpp"

/// Archives of NumPy arrays (numpy.savez): ZIP files.
namespace resight::io {
namespace {

constexpr zip_uint64_t kMaxArrayBytes = zip_uint64_t{8} * kMaxViewPixels + 4096;
constexpr zip_int64_t kMaxEntries = 1000;
constexpr zip_uint64_t kNeeded = ZIP_STAT_NAME | ZIP_STAT_SIZE;

struct ZipCloser {
  void operator()(zip_t* archive) const { zip_discard(archive); }
  void operator()(zip_file_t* entry) const { zip_fclose(entry); }
};
using Archive = std::unique_ptr<zip_t, ZipCloser>;
using Entry = std::unique_ptr<zip_file_t, ZipCloser>;

/// The archive reads from the bytes, which must outlive it. Null if they are none.
Archive open_archive(std::string_view bytes) {
  zip_error_t error;
  zip_error_init(&error);
  zip_source_t* source = zip_source_buffer_create(bytes.data(), bytes.size(), 0, &error);
  zip_t* archive = source == nullptr ? nullptr : zip_open_from_source(source, ZIP_RDONLY, &error);
  if (archive == nullptr && source != nullptr) zip_source_free(source);
  zip_error_fini(&error);
  return Archive(archive);
}

struct NamedEntry {
  std::string name;
  zip_uint64_t index = 0;
  zip_uint64_t num_bytes = 0;
};

std::vector<NamedEntry> list_arrays(zip_t* archive) {
  std::vector<NamedEntry> arrays;
  const zip_int64_t num_entries = std::min(zip_get_num_entries(archive, 0), kMaxEntries);
  for (zip_int64_t i = 0; i < num_entries; ++i) {
    zip_stat_t stat;
    const auto index = static_cast<zip_uint64_t>(i);
    if (zip_stat_index(archive, index, 0, &stat) != 0 || (stat.valid & kNeeded) != kNeeded) continue;
    std::string name = stat.name;
    if (name.ends_with(".npy")) arrays.push_back({name.substr(0, name.size() - 4), index, stat.size});
  }
  return arrays;
}

}  // namespace

Result<Image<float>> parse_depth_npz(std::string_view bytes, std::string_view name,
                                     std::optional<double> metres_per_unit) {
  const auto fail = [&](const std::string& what) { return Error{fmt::format("{}: {}", name, what)}; };
  const Archive archive = open_archive(bytes);
  if (archive == nullptr) return fail("is no archive of NumPy arrays (or damaged)");
  const std::vector<NamedEntry> arrays = list_arrays(archive.get());
  if (arrays.empty()) return fail("holds no NumPy array");
  const NamedEntry* chosen = arrays.size() == 1 ? &arrays.front() : nullptr;
  for (const NamedEntry& array : arrays)
    if (array.name == "depth") chosen = &array;
  if (chosen == nullptr)
    return fail(fmt::format("holds {} arrays ({}, {}, ..), none of which is called depth", arrays.size(),
                            printable(arrays[0].name), printable(arrays[1].name)));
  if (chosen->num_bytes > kMaxArrayBytes) return fail("its array is too large");
  const Entry entry(zip_fopen_index(archive.get(), chosen->index, 0));
  std::string array(chosen->num_bytes, '\0');
  char beyond = 0;  // The checksum is compared at the end of the entry.
  if (entry == nullptr ||
      zip_fread(entry.get(), array.data(), array.size()) != static_cast<zip_int64_t>(array.size()) ||
      zip_fread(entry.get(), &beyond, 1) != 0)
    return fail("its array cannot be unpacked (damaged?)");
  return parse_depth_npy(array, name, metres_per_unit);
}

}  // namespace resight::io
