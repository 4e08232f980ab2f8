// The frame that all offline tools share: options, exit codes, machine-readable results.
#pragma once

#include <CLI/CLI.hpp>
#include <exception>
#include <functional>
#include <nlohmann/json.hpp>

namespace hyselam {

/// Thrown by a body that has something to show in spite of an error: it is written as if there were
/// none, and the error is told; if it cannot be written, that is told behind the error.
struct PartialResult {
  nlohmann::json result;
  std::exception_ptr error;  ///< not null
};

/// Adds `--json FILE` and `--version` to `app`, parses the command line, runs `body` and, if asked,
/// writes what it returns to FILE (at once, indented).
///
/// Returns the exit status: 0 done (also after --help, --version), 2 wrong usage or input that
/// cannot be used (CLI::ParseError, InputError, ParameterError), 1 anything else. Errors are one
/// line `error: ...` on stderr. If the JSON file cannot be written, the status is 2, but for a
/// PartialResult, whose error decides.
int runTool(int argc, const char* const* argv, CLI::App& app,
            const std::function<nlohmann::json()>& body);

}  // namespace hyselam
