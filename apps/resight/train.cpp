// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "commands.hpp"
#include "progress.hpp"
#include "resight/core/files.hpp"
#include "resight/io/model_source.hpp"
#include "resight/models/library_file.hpp"
#include "resight/training/train_library.hpp"

namespace resight::app {

void run_train(const TrainArguments& arguments) {
  const std::vector<ModelLocation> locations = value_or_throw(find_models(arguments.inputs));
  if (std::filesystem::is_directory(arguments.out))
    throw InputError(file_error(arguments.out, "is a folder (the name of a file was expected)").message);
  value_or_throw(check_writable(arguments.out));
  TrainOptions options;
  options.num_threads = arguments.num_threads;
  ModelLibrary library;
  std::vector<std::string> warnings;
  {
    Progress progress("train", static_cast<int>(locations.size()));
    library = value_or_throw(train_library(
        locations, options, [&](int index, int, const std::string& name) { progress.report(index + 1, name); },
        [&](const std::string& line) { warnings.push_back(line); }));
  }
  for (const std::string& warning : warnings) print_warning(warning);
  value_or_throw(save_library(library, arguments.out));
  for (const ObjectModel& object : library.objects)
    fmt::print("{:>4} {:<28} {:5.1f} cm, {:6d} surface points, {:5d} SIFT, {:5d} SHOT\n", object.bop_id, object.name,
               100 * object.diameter_m, object.surface.size(), object.sift.size(), object.shot.size());
  fmt::print("{} objects trained: {}\n", library.objects.size(), arguments.out.string());
}

}  // namespace resight::app
