// For tests of the programs of this package: one folder for a suite, and what a program said.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "hyselam_common/testing/files.hpp"
#include "hyselam_common/testing/program_run.hpp"

class ToolTest : public testing::Test {
 protected:
  static void SetUpTestSuite() { directory = new hyselam::testing::TemporaryDirectory; }
  static void TearDownTestSuite() {
    delete directory;
    directory = nullptr;
  }
  /// The exit status; what was printed is in `output` and `errors`.
  int run(const std::string& command) {
    const auto done = hyselam::testing::runProgram(std::string(HYSELAM_TOOLS) + "/" + command, d);
    output = done.output;
    errors = done.errors;
    return done.status;
  }
  void expectRefused(const std::string& command, const std::string& part) {
    EXPECT_TRUE(hyselam::testing::refused({run(command), output, errors}, part)) << command;
  }

  inline static hyselam::testing::TemporaryDirectory* directory = nullptr;
  const hyselam::testing::TemporaryDirectory& d = *directory;
  std::string output, errors;
};
