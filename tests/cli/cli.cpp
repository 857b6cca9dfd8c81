// SPDX-License-Identifier: Apache-2.0
#include "cli.hpp"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <regex>
#include <sstream>

namespace resight::cli_test {

std::ostream& operator<<(std::ostream& out, const Row& row) { return out << "resight " << row.command; }

std::vector<std::string> list(const fs::path& folder) {
  std::vector<std::string> entries;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    entries.push_back(entry.path().lexically_relative(folder).string());
    std::error_code leads_nowhere;
    if (entry.is_regular_file(leads_nowhere)) entries.back().append(" ").append(std::to_string(entry.file_size()));
  }
  std::ranges::sort(entries);
  return entries;
}

Outcome run(const fs::path& folder, const std::string& arguments) {
  const fs::path output = folder.string() + ".stdout";
  const fs::path errors = folder.string() + ".stderr";
  const std::string command = "cd " + folder.string() + " && timeout 60 " RESIGHT_PROGRAM " " + arguments + " >" +
                              output.string() + " 2>" + errors.string() + " </dev/null";
  const int code = std::system(command.c_str());
  Outcome outcome{WIFEXITED(code) ? WEXITSTATUS(code) : 128 + WTERMSIG(code), read_text(output), {}};
  std::istringstream lines(read_text(errors));
  static const std::regex progress("[a-z-]+ [0-9]+/[0-9]+: .*");
  for (std::string line; std::getline(lines, line);)
    if (!std::regex_match(line, progress)) outcome.errors.push_back(line);
  return outcome;
}

fs::path CommandLineFolder::root_;

TEST_P(CommandLine, NamesWhatIsWrong) {
  const Row& row = GetParam();
  row.spoil(folder_);
  if (HasFatalFailure()) return;
  const std::vector<std::string> before = list(folder_);
  const Outcome outcome = run(folder_, row.command);
  EXPECT_EQ(outcome.status, row.status);
  if (*row.line == '\0') {
    EXPECT_EQ(outcome.errors, std::vector<std::string>{});
  } else {
    EXPECT_EQ(outcome.errors.size(), 1U);
    const std::string first = outcome.errors.empty() ? "" : outcome.errors[0];
    EXPECT_TRUE(std::regex_search(first, std::regex(std::string("^resight: .*") + row.line)))
        << "expected: /" << row.line << "/";
  }
  if (row.makes == nullptr) {
    EXPECT_EQ(list(folder_), before) << "files are left";
  } else {
    EXPECT_TRUE(fs::exists(folder_ / row.makes)) << "is missing: " << row.makes;
  }
  if (!HasFailure()) return;
  std::string told;
  for (const std::string& line : outcome.errors) told += "\n  stderr: " + line;
  ADD_FAILURE() << row << "\n  stdout: " << outcome.output << told;
}

}  // namespace resight::cli_test
