// SPDX-License-Identifier: Apache-2.0
// The entry points that libFuzzer calls.
//   resight_fuzz --list                            names of the readers, with their executions in a short run
//   resight_fuzz --reader=NAME --seeds=FOLDER      writes the seeds of a reader
//   resight_fuzz --reader=NAME [OPTION|FOLDER..]   libFuzzer; it ignores what begins with "--"
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <optional>

#include "reader.hpp"

namespace resight::fuzz {
namespace {

std::vector<FuzzReader> all_readers() {
  std::vector<FuzzReader> readers;
  for (auto* const list : {mesh_readers, image_readers, dataset_readers, sequence_readers, stored_readers,
                           recording_readers, http_readers})
    for (FuzzReader& reader : list()) readers.push_back(std::move(reader));
  return readers;
}

FuzzReader chosen;

std::optional<std::string_view> value_of(std::string_view argument, std::string_view option) {
  if (!argument.starts_with(option)) return std::nullopt;
  return argument.substr(option.size());
}

void write_seeds(std::string_view folder) {
  std::filesystem::create_directories(folder);
  int number = 0;
  for (const std::string& seed : chosen.make_seeds())
    std::ofstream(std::filesystem::path(folder) / ("seed" + std::to_string(number++)), std::ios::binary) << seed;
}

void list_readers() {
  for (const FuzzReader& reader : all_readers())
    std::printf("%.*s %d\n", static_cast<int>(reader.name.size()), reader.name.data(), reader.num_short_runs);
}

/// Replaces the arguments by a copy with more of them.
void add_arguments(int& count, char**& arguments, std::vector<std::string> added) {
  static std::vector<std::string> texts;
  static std::vector<char*> extended;
  texts = std::move(added);
  extended.assign(arguments, arguments + count);
  for (std::string& text : texts) extended.push_back(text.data());
  count = static_cast<int>(extended.size());
  extended.push_back(nullptr);
  arguments = extended.data();
}

void choose(std::string_view name) {
  for (FuzzReader& reader : all_readers())
    if (reader.name == name) chosen = std::move(reader);
  if (chosen.read) return;
  std::fprintf(stderr, "resight_fuzz: no reader '%.*s'; --list lists them\n", static_cast<int>(name.size()),
               name.data());
  std::exit(2);
}

}  // namespace
}  // namespace resight::fuzz

extern "C" const char* __lsan_default_suppressions() {  // NOLINT(bugprone-reserved-identifier)
  return "leak:libassimp\n";
}

extern "C" int LLVMFuzzerInitialize(int* num_arguments, char*** arguments) {
  using namespace resight::fuzz;
  for (int i = 1; i < *num_arguments; ++i) {
    const std::string_view argument = (*arguments)[i];
    if (argument == "--list") {
      list_readers();
      std::exit(0);
    }
    if (const auto name = value_of(argument, "--reader=")) choose(*name);
    if (const auto folder = value_of(argument, "--seeds=")) {
      write_seeds(*folder);
      std::exit(0);
    }
  }
  if (!chosen.read) choose("");
  // What is lost in millions of executions is no finding, but a large allocation is.
  if (chosen.may_lose_memory)
    add_arguments(*num_arguments, *arguments, {"-detect_leaks=0", "-rss_limit_mb=8192", "-malloc_limit_mb=2048"});
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  resight::fuzz::chosen.read({reinterpret_cast<const char*>(data), size});
  return 0;
}
