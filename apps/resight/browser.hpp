// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <string>

namespace resight::app {

/// Opens an address in the browser of the user's desktop, if there is one.
class BrowserLaunch {
 public:
  /// The address goes through a file that only this user can read, which redirects to it: command lines are visible to
  /// all users of a machine, and the address holds a secret.
  explicit BrowserLaunch(const std::string& address);
  /// Removes the file. A signal that ends the program earlier removes it, too.
  ~BrowserLaunch();
  BrowserLaunch(const BrowserLaunch&) = delete;
  BrowserLaunch& operator=(const BrowserLaunch&) = delete;

 private:
  std::filesystem::path redirect_;
};

}  // namespace resight::app
