// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>

#include "commands.hpp"
#include "output_paths.hpp"
#include "progress.hpp"
#include "resight/io/model_source.hpp"
#include "resight/models/library_file.hpp"
#include "resight/training/equal_objects.hpp"
#include "resight/training/train_library.hpp"

namespace resight::app {
namespace {

// The views of a TUW model are in metres.
void set_unit(std::vector<ModelLocation>& locations, double metres_per_unit) {
  bool has_effect = false;
  for (ModelLocation& location : locations) {
    if (location.format == "tuw") continue;
    location.metres_per_unit = metres_per_unit;
    has_effect = true;
  }
  if (!has_effect) throw InputError("--mesh-unit has no effect: no model is a mesh or a cloud");
}

void tell_uncolored(const ModelLibrary& library) {
  // Training views may give features to a surface without colours.
  const auto num_uncolored = std::ranges::count_if(library.objects, [](const ObjectModel& object) {
    return !object.surface.has_colors() && object.sift.size() == 0;
  });
  if (num_uncolored > 0)
    print_error_line("note: ", fmt::format("{} of {} objects have no colours and are recognised by shape alone",
                                           num_uncolored, library.objects.size()));
}

void tell_equal(const ModelLibrary& library) {
  for (const auto& [a, b] : find_equal_objects(library))
    print_error_line("note: ", fmt::format("{} and {} are equal in shape and colour: no view tells which one it shows",
                                           library.objects[a].name, library.objects[b].name));
}

}  // namespace

void run_train(const TrainArguments& arguments) {
  std::vector<ModelLocation> locations = value_or_throw(find_models(arguments.inputs));
  if (arguments.metres_per_unit) set_unit(locations, *arguments.metres_per_unit);
  const auto check_out = [&] {
    check_output_file(arguments.out, kLibrarySignature, "model library", arguments.inputs);
  };
  check_out();
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
  tell_uncolored(library);
  tell_equal(library);
  check_out();  // Again: another program may have written the file meanwhile.
  value_or_throw(save_library(library, arguments.out));
  for (const ObjectModel& object : library.objects)
    print("{:>4} {:<28} {:5.1f} cm, {:6d} surface points, {:5d} SIFT, {:5d} SHOT\n", object.bop_id, object.name,
          100 * object.diameter_m, object.surface.size(), object.sift.size(), object.shot.size());
  print("{} objects trained: {}\n", library.objects.size(), shown_output(arguments));
}

}  // namespace resight::app
