// What tests of all packages need around files: a directory that vanishes, the real data sets.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

namespace hyselam {
namespace testing {

/// An empty directory for one test, removed with all its content at the end.
class TemporaryDirectory {
 public:
  TemporaryDirectory() {
    std::string name = (std::filesystem::temp_directory_path() / "hyselam-test-XXXXXX").string();
    if (::mkdtemp(&name[0]) == nullptr) std::abort();
    path_ = name;
  }
  ~TemporaryDirectory() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TemporaryDirectory(const TemporaryDirectory&) = delete;
  TemporaryDirectory& operator=(const TemporaryDirectory&) = delete;

  std::string operator/(const std::string& name) const { return (path_ / name).string(); }
  std::string path() const { return path_.string(); }
  std::size_t fileCount() const {
    std::size_t count = 0;
    for (const auto& entry : std::filesystem::directory_iterator(path_)) {
      (void)entry;
      ++count;
    }
    return count;
  }

 private:
  std::filesystem::path path_;
};

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
/// there. Tests then say so and skip: HYSELAM_NEED_DATA(data);
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
