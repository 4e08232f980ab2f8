// Programs as a user runs them, in tests.
#pragma once

#include <sys/wait.h>

#include <cstdlib>
#include <string>

#include "hyselam_common/testing/temporary_directory.hpp"

namespace hyselam_objects {

/// Runs a program; what it prints is in `directory`, stdout and stderr. Its exit status; -1 if a
/// signal ended it.
inline int runProgram(const std::string& program, const std::string& arguments,
                      const hyselam::testing::TemporaryDirectory& directory) {
  const std::string command =
      program + " " + arguments + " >" + (directory / "stdout") + " 2>" + (directory / "stderr");
  const int status = std::system(command.c_str());
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

}  // namespace hyselam_objects
