// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <exception>
#include <filesystem>
#include <new>
#include <system_error>

#include "command_line.hpp"
#include "commands.hpp"
#include "interrupts.hpp"
#include "processor.hpp"
#include "resight/core/allocator.hpp"

namespace {

using namespace resight::app;  // NOLINT(google-build-using-namespace): this file is the program's interface

constexpr int kExitFailed = 1;
constexpr int kExitBadInput = 2;

int refuse(const std::string& message) {
  print_error_line("", message);
  return kExitBadInput;
}

// One line that describes the error on the command line and refers to the help.
std::string describe_mistake(const CLI::ParseError& error, CLI::App& app, const std::string& first) {
  const std::vector<CLI::App*> commands = app.get_subcommands({});
  const auto named = std::ranges::find(commands, first, &CLI::App::get_name);
  if (named != commands.end()) {
    std::string what = error.what();
    std::ranges::replace(what, '\n', ' ');
    // CLI11 looks for missing options first, but what is missing is often what is misspelt.
    const std::vector<std::string> unexpected = (*named)->remaining();
    if (!unexpected.empty() && dynamic_cast<const CLI::RequiredError*>(&error) != nullptr)
      what = "unexpected '" + unexpected.front() + "'; " + what;
    return first + ": " + what + " (see resight " + first + " --help)";
  }
  std::string names;
  for (const CLI::App* command : commands) names += (names.empty() ? "" : ", ") + command->get_name();
  const std::string what = first.empty()          ? "no command was given"
                           : first.front() == '-' ? "unknown option '" + first + "'"
                                                  : "unknown command '" + first + "'";
  return what + " (commands: " + names + "; see resight --help)";
}

std::string describe(const std::exception& error) {
  if (dynamic_cast<const std::bad_alloc*>(&error) != nullptr) return "out of memory";
  const auto* const system = dynamic_cast<const std::system_error*>(&error);
  if (system != nullptr && system->code() == std::errc::resource_unavailable_try_again)
    return "the system allows no more threads";
  return error.what();
}

// An empty value, as of a variable of a shell that is not set, means nothing and would be taken for no option.
void refuse_empty_values(const CLI::App& command) {
  for (const CLI::Option* option : command.get_options())
    if (option->count() > 0 && std::ranges::find(option->results(), std::string()) != option->results().end())
      throw InputError(option->get_name() + ": '' (a value was expected)");
}

int run_program(int argc, char** argv) {
  CLI::App app(
      "resight recognises known objects in RGB-D views of a changing scene: which object is where, and what was\n"
      "added, moved or removed.");
  app.set_version_flag("--version", RESIGHT_VERSION);
  app.require_subcommand(1);
  Arguments a;
  const std::vector<std::function<void()>> runs = add_commands(app, a);
  const std::vector<CLI::App*> commands = app.get_subcommands({});
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& asked) {  // --help, --version
    return app.exit(asked);
  } catch (const CLI::ParseError& error) {
    return refuse(describe_mistake(error, app, argc > 1 ? argv[1] : ""));
  }
  try {
    for (std::size_t i = 0; i < commands.size(); ++i)
      if (commands[i]->parsed()) {
        refuse_empty_values(*commands[i]);
        runs[i]();
      }
  } catch (const InputError& error) {
    return refuse(error.what());
  } catch (const std::filesystem::filesystem_error& error) {
    // A path that no check has caught: a loop of links, a name that is too long.
    return refuse(error.path1().string() + ": " + error.code().message());
  }
  return a.is_sound ? 0 : kExitFailed;
}

}  // namespace

#ifdef __AVX2__
const bool resight::app::kNeedsAvx2 = true;
#else
const bool resight::app::kNeedsAvx2 = false;
#endif

std::string resight::app::format_share(double share) { return std::isnan(share) ? "-" : fmt::format("{:.3f}", share); }

void resight::app::print_warning(const std::string& what) { print_error_line("warning: ", what); }

int main(int argc, char** argv) {
  resight::keep_freed_memory();
  try {
    resight::app::clean_up_when_interrupted();
    const int status = run_program(argc, argv);
    if (finish_output()) return status;
    print_error_line("", "the output could not be written to the terminal, pipe or file (is the disk full?)");
  } catch (const std::exception& error) {
    print_error_line("failed: ", describe(error));
  } catch (...) {
    print_error_line("failed ", "for an unknown reason");
  }
  return kExitFailed;
}
