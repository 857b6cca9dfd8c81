// SPDX-License-Identifier: Apache-2.0
#include "interrupts.hpp"

#include <semaphore.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <csignal>
#include <mutex>
#include <set>
#include <thread>

#include "resight/core/files.hpp"

namespace resight::app {
namespace {

constexpr int kInterrupts[] = {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGPIPE};

std::atomic<int> interrupt_number = 0;
std::atomic<bool> may_stop = false;
std::atomic<bool> stop_requested = false;
sem_t has_interrupt;  // Unlike a condition variable, a handler may post it.

struct TemporaryFiles {
  std::mutex mutex;
  std::set<std::filesystem::path> files;
};

/// Never destroyed: an interruption may come while the process ends.
TemporaryFiles& temporary_files() {
  static TemporaryFiles& only = *new TemporaryFiles;  // NOLINT(cppcoreguidelines-owning-memory)
  return only;
}

void remove_temporary_files() {
  temporary_files().mutex.lock();  // for ever
  for (const std::filesystem::path& file : temporary_files().files) ::unlink(file.c_str());
}

/// A handler may not remove folders itself, because few functions are safe in it.
void post_interrupt(int number) {
  const int interrupted_errno = errno;
  interrupt_number = number;
  ::sem_post(&has_interrupt);
  // Whoever wrote into a closed pipe would go on and report it.
  if (number == SIGPIPE)
    for (;;) ::pause();
  errno = interrupted_errno;
}

/// Whether the signal is only a request to come to an end.
bool request_stop(int number) {
  return may_stop && (number == SIGINT || number == SIGTERM) && !stop_requested.exchange(true);
}

/// Ends the program as the signal would have done without a handler, so that a shell knows the reason.
[[noreturn]] void end_by_interrupt() {
  do {
    while (::sem_wait(&has_interrupt) != 0) {
    }
  } while (request_stop(interrupt_number));
  remove_temporary_files();
  remove_pending_files();
  const int number = interrupt_number;
  std::signal(number, SIG_DFL);
  sigset_t one;
  ::sigemptyset(&one);
  ::sigaddset(&one, number);
  ::pthread_sigmask(SIG_UNBLOCK, &one, nullptr);
  std::raise(number);
  ::_exit(128 + number);
}

void start_waiting() {
  ::sem_init(&has_interrupt, 0, 0);
  std::thread(end_by_interrupt).detach();
}

}  // namespace

void clean_up_when_interrupted() {
  [[maybe_unused]] static const bool is_waiting = (start_waiting(), true);
  std::signal(SIGXFSZ, SIG_IGN);
  for (const int number : kInterrupts) {
    struct sigaction action {};
    ::sigaction(number, nullptr, &action);
    if (action.sa_handler == SIG_IGN) continue;
    action = {};
    action.sa_handler = post_interrupt;
    action.sa_flags = SA_RESTART;
    ::sigaction(number, &action, nullptr);
  }
}

void remove_when_interrupted(const std::filesystem::path& file) {
  const std::lock_guard lock(temporary_files().mutex);
  temporary_files().files.insert(file);
}

void remove_temporary_file(const std::filesystem::path& file) {
  const std::lock_guard lock(temporary_files().mutex);
  ::unlink(file.c_str());
  temporary_files().files.erase(file);
}

void stop_when_interrupted() { may_stop = true; }

bool is_stop_requested() { return stop_requested; }

}  // namespace resight::app
