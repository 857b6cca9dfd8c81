// SPDX-License-Identifier: Apache-2.0
#include "follow_views.hpp"

#include <algorithm>
#include <chrono>
#include <thread>

#include "interrupts.hpp"
#include "resight/core/files.hpp"
#include "resight/inspection/find_faults.hpp"
#include "resight/sensor/disparity_error.hpp"
#include "sequence_input.hpp"

namespace resight::app {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point begin) { return std::chrono::duration<double>(Clock::now() - begin).count(); }

bool is_idle_for_too_long(Clock::time_point begin, const FollowArguments& arguments) {
  return arguments.idle_timeout_s && seconds_since(begin) > *arguments.idle_timeout_s;
}

void tell_first_view(const FollowedView& view, const std::vector<std::string>& notes) {
  for (const std::string& note : notes) print_error_line("note: ", note);
  warn_about(find_view_faults(view.frame));
}

OpenCameraOptions to_camera_options(const std::string& name, const OpenSequenceOptions& open) {
  const std::size_t colon = name.find(':');
  return {.uri = colon == std::string::npos ? "" : name.substr(colon + 1),
          .intrinsics = open.intrinsics,
          .sensor = open.sensor};
}

}  // namespace

FolderViews::FolderViews(const std::filesystem::path& folder, const OpenSequenceOptions& open,
                         const FollowArguments& arguments)
    : follower_(folder, open, {.skips_late = !arguments.keeps_late, .max_tries = 20}), arguments_(arguments) {
  if (std::filesystem::is_regular_file(folder))
    throw InputError(file_error(folder, "is a file; --follow takes a folder into which views are written").message);
  stop_when_interrupted();
}

std::optional<FollowedView> FolderViews::next() {
  const Clock::time_point begin = Clock::now();
  while (!is_stop_requested()) {
    const Clock::time_point before = Clock::now();
    std::optional<FollowedView> view = follower_.poll();
    for (const std::string& why : follower_.take_left_out()) print_warning("left out: " + why);
    if (view) {
      if (!has_view_) tell_first_view(*view, follower_.notes());
      has_view_ = true;
      warn_about(pose_check_.add(view->frame, view->number));
      return view;
    }
    if (is_idle_for_too_long(begin, arguments_)) break;
    tell_waiting();
    // A long folder takes long to open: polling takes at most a fifth of a processor.
    std::this_thread::sleep_for(std::clamp<Clock::duration>(4 * (Clock::now() - before), std::chrono::milliseconds(50),
                                                            std::chrono::milliseconds(1000)));
  }
  if (!has_view_) throw InputError("no view has come: " + follower_.why_none());
  return std::nullopt;
}

void FolderViews::tell_waiting() {
  if (has_view_ || follower_.why_none() == told_) return;
  told_ = follower_.why_none();
  print_error_line("waiting for views: ", told_);
}

CameraViews::CameraViews(const std::string& name, const OpenSequenceOptions& open, const FollowArguments& arguments)
    : name_(name),
      depth_bias_per_m_(open.depth_bias_per_m),
      camera_(to_camera_options(name, open)),
      arguments_(arguments) {
  stop_when_interrupted();
}

std::optional<FollowedView> CameraViews::next() {
  constexpr double kPatience_s = 0.2;  // Until Ctrl-C is looked at.
  const Clock::time_point begin = Clock::now();
  while (!is_stop_requested() && !is_idle_for_too_long(begin, arguments_)) {
    std::optional<FollowedView> view = camera_.take(kPatience_s);
    if (!view && camera_.has_ended()) break;
    if (!view) continue;
    if (depth_bias_per_m_ != 0) remove_disparity_error(depth_bias_per_m_, view->frame);
    if (!has_view_) tell_first_view(*view, camera_.notes());
    has_view_ = true;
    return view;
  }
  if (!has_view_) throw InputError(name_ + ": no view has come");
  return std::nullopt;
}

}  // namespace resight::app
