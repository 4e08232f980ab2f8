// For tests that hold README.md and config/ against the code.
#pragma once

#include <map>
#include <memory>
#include <regex>
#include <string>

#include "hyselam_common/atomic_file.hpp"
#include "hyselam_common/ros/params.hpp"

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

using Values = std::map<std::string, XmlRpc::XmlRpcValue>;

/// What `load` makes of these values; the table that it logs.
template <typename Params>
Params loadFrom(Params (*load)(hyselam::ParamLoader&), const Values& values,
                std::string* table = nullptr) {
  hyselam::ParamLoader loader(std::make_shared<hyselam::MapParamSource>(values));
  const Params p = load(loader);
  if (table != nullptr) *table = loader.table();
  return p;
}

/// Names and defaults.
template <typename Params>
std::map<std::string, std::string> defaultsOf(Params (*load)(hyselam::ParamLoader&)) {
  std::string table;
  loadFrom(load, {}, &table);
  return valuesOf(table);
}

}  // namespace ngram_slam
