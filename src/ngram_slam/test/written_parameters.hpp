// For tests that hold README.md and config/ against the code.
#pragma once

#include <map>
#include <regex>
#include <string>

#include "hyselam_common/atomic_file.hpp"

namespace ngram_slam {

/// The text of a file of the package.
inline std::string written(const std::string& file) {
  return hyselam::readTextFile(std::string(HYSELAM_PACKAGE_DIR) + "/" + file);
}

/// Names and values, out of the table that a server logs.
inline std::map<std::string, std::string> valuesOf(const std::string& table) {
  static const std::regex row(R"(\n  ([\w/]+) = (\[[^\]]*\]|'[^']*'|\S+)  \()");
  std::map<std::string, std::string> all;
  for (std::sregex_iterator i(table.begin(), table.end(), row), end; i != end; ++i) {
    all[(*i)[1]] = std::regex_replace((*i)[2].str(), std::regex("'"), "");
  }
  return all;
}

}  // namespace ngram_slam
