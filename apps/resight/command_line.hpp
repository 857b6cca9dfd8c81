// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "commands.hpp"

namespace CLI {
class App;
}

namespace resight::app {

/// What the command line says, for each command.
struct Arguments {
  TrainArguments train;
  RecognizeArguments recognize;
  ChangesArguments changes;
  TrackArguments track;
  SimulateArguments simulate;
  ModelArguments model;
  ConvertArguments convert;
  InfoArguments info;
  CheckArguments check;
  bool is_sound = true;  ///< Result of `check`.
  EvaluateArguments evaluate;
  std::optional<std::string> shard;
  ViewArguments view;
  AnnotateArguments annotate;
  DemoArguments demo;
};

/// Declares all commands with their options, which fill the arguments. Returns a function for each, in the order of
/// app.get_subcommands(): it runs the command.
[[nodiscard]] std::vector<std::function<void()>> add_commands(CLI::App& app, Arguments& arguments);

}  // namespace resight::app
