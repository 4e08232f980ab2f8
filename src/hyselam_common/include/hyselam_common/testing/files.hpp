// What tests of all packages need around files: directories that vanish, bytes, the real data sets.
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "hyselam_common/testing/temporary_directory.hpp"

namespace hyselam {
namespace testing {

inline void writeFile(const std::string& path, const std::string& content) {
  std::ofstream out(path, std::ios::binary);
  out << content;
}

/// The bytes as they are on the disk.
inline std::string fileBytes(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream out;
  out << in.rdbuf();
  return out.str();
}

/// The real data sets: $HYSELAM_DATA, else the directory known at configure time; "" if it is not
/// there. Tests then skip with a message: HYSELAM_NEED_DATA(data);
inline std::string dataDirectory() {
  const char* variable = std::getenv("HYSELAM_DATA");
  std::string directory = variable != nullptr ? variable : "";
#ifdef HYSELAM_DEFAULT_DATA
  if (directory.empty()) directory = HYSELAM_DEFAULT_DATA;
#endif
  return std::filesystem::is_directory(directory) ? directory : "";
}

/// What a callable throws, as text; "" if it throws nothing of that type.
template <typename Exception, typename F>
std::string messageOf(F&& f) {
  try {
    f();
  } catch (const Exception& e) {
    return e.what();
  }
  return "";
}

}  // namespace testing
}  // namespace hyselam

#define HYSELAM_NEED_DATA(name)                                          \
  const std::string name = ::hyselam::testing::dataDirectory();          \
  if ((name).empty()) {                                                  \
    GTEST_SKIP() << "no real data: set HYSELAM_DATA to their directory"; \
  }                                                                      \
  static_assert(true, "")
