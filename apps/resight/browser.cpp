// SPDX-License-Identifier: Apache-2.0
#include "browser.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <stdlib.h>  // NOLINT(modernize-deprecated-headers): mkostemps() is not in <cstdlib>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <thread>

#include "interrupts.hpp"

namespace resight::app {
namespace {

bool has_desktop() { return std::getenv("DISPLAY") != nullptr || std::getenv("WAYLAND_DISPLAY") != nullptr; }

/// Empty if the file cannot be written.
std::filesystem::path write_redirect(const std::string& address) {
  std::error_code error;
  const std::filesystem::path folder = std::filesystem::temp_directory_path(error);
  std::string name = (folder / "resight-view-XXXXXX.html").string();
  const int file = error ? -1 : ::mkostemps(name.data(), 5, O_CLOEXEC);  // readable by this user only
  if (file < 0) return {};
  remove_when_interrupted(name);  // Before it holds the secret.
  const std::string page = "<!doctype html><meta charset=utf-8><title>resight</title><script>location.replace(\"" +
                           address + "\")</script><a href=\"" + address + "\">resight</a>\n";
  const bool is_written = ::write(file, page.data(), page.size()) == static_cast<ssize_t>(page.size());
  ::close(file);
  if (!is_written) remove_temporary_file(name);
  return is_written ? std::filesystem::path(name) : std::filesystem::path();
}

/// Runs xdg-open, without its messages. The browser goes on after it, so it inherits no socket and no file.
void open_with_desktop(const std::filesystem::path& page) {
  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  for (const int output : {STDOUT_FILENO, STDERR_FILENO})
    ::posix_spawn_file_actions_addopen(&actions, output, "/dev/null", O_WRONLY, 0);
  ::posix_spawn_file_actions_addclosefrom_np(&actions, STDERR_FILENO + 1);
  std::string program = "xdg-open";
  std::string argument = page.string();
  char* const arguments[] = {program.data(), argument.data(), nullptr};
  pid_t child = 0;
  if (::posix_spawnp(&child, program.c_str(), &actions, nullptr, arguments, environ) == 0)
    std::thread([child] { ::waitpid(child, nullptr, 0); }).detach();
  ::posix_spawn_file_actions_destroy(&actions);
}

}  // namespace

BrowserLaunch::BrowserLaunch(const std::string& address) {
  if (!has_desktop()) return;
  redirect_ = write_redirect(address);
  if (!redirect_.empty()) open_with_desktop(redirect_);
}

BrowserLaunch::~BrowserLaunch() {
  if (!redirect_.empty()) remove_temporary_file(redirect_);
}

}  // namespace resight::app
