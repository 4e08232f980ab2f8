#include "hyselam_common/tool.hpp"

#include <exception>
#include <iostream>
#include <string>

#include "hyselam_common/atomic_file.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/version.hpp"

namespace hyselam {
namespace {

constexpr int kDone = 0;
constexpr int kFailed = 1;
constexpr int kUnusable = 2;

int fail(int status, std::string message) {
  for (char& c : message) {
    if (c == '\n' || c == '\r') c = ' ';
  }
  std::cerr << "error: " << message << std::endl;
  return status;
}

}  // namespace

int runTool(int argc, const char* const* argv, CLI::App& app,
            const std::function<nlohmann::json()>& body) {
  std::string json_path;
  app.add_option("--json", json_path, "write the results as JSON to this file")->type_name("FILE");
  app.set_version_flag("--version", std::string("HySeLAM ") + version(),
                       "print the version and end");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    if (e.get_exit_code() == static_cast<int>(CLI::ExitCodes::Success)) return app.exit(e);
    return fail(kUnusable, e.what());
  }
  const auto write = [&](const nlohmann::json& result) {
    if (json_path.empty()) return;
    writeFileAtomically(json_path, [&](std::ostream& out) { out << result.dump(2) << '\n'; });
  };
  std::string also;  // why a partial result is not written either
  try {
    try {
      write(body());
    } catch (const PartialResult& partial) {
      try {
        write(partial.result);
      } catch (const std::exception& e) {
        also = std::string("; and what there is cannot be written: ") + e.what();
      }
      std::rethrow_exception(partial.error);
    }
    return kDone;
  } catch (const InputError& e) {
    return fail(kUnusable, e.what() + also);
  } catch (const ParameterError& e) {
    return fail(kUnusable, e.what() + also);
  } catch (const std::exception& e) {
    return fail(kFailed, e.what() + also);
  } catch (...) {
    return fail(kFailed, "unknown failure" + also);
  }
}

}  // namespace hyselam
