// Programs as a shell starts them, in tests.
#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <algorithm>
#include <cstdlib>
#include <string>

#include "hyselam_common/testing/files.hpp"

namespace hyselam {
namespace testing {

/// How a program ended, and what it printed.
struct ProgramRun {
  int status = -1;  ///< its exit status; -1 if a signal ended it
  std::string output, errors;
};

/// Runs a line of the shell; what it prints stays in the folder as "stdout" and "stderr".
inline ProgramRun runProgram(const std::string& line, const TemporaryDirectory& folder) {
  const std::string command = line + " >" + (folder / "stdout") + " 2>" + (folder / "stderr");
  const int status = std::system(command.c_str());
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, fileBytes(folder / "stdout"),
          fileBytes(folder / "stderr")};
}

/// The same, and what it prints is only in the result.
inline ProgramRun runProgram(const std::string& line) {
  const TemporaryDirectory folder;
  return runProgram(line, folder);
}

/// As all tools refuse: exit status 2 and exactly one line "error: …", which has this part.
inline ::testing::AssertionResult refused(const ProgramRun& run, const std::string& part) {
  const bool one_line = run.errors.rfind("error: ", 0) == 0 &&
                        std::count(run.errors.begin(), run.errors.end(), '\n') == 1;
  if (run.status == 2 && one_line && run.errors.find(part) != std::string::npos) {
    return ::testing::AssertionSuccess();
  }
  return ::testing::AssertionFailure()
         << "status " << run.status << ", not the one line '" << part << "': " << run.errors;
}

}  // namespace testing
}  // namespace hyselam
