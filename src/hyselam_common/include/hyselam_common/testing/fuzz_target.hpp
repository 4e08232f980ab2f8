// What scripts/fuzz feeds with bytes of all kinds, and the tests with those kept. A package lists
// its targets in fuzz/targets.cpp; the seeds of target `mapXml` are in test/data/fuzz/map_xml.
#pragma once

#include <cctype>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "hyselam_common/testing/temporary_directory.hpp"

namespace hyselam {
namespace testing {

struct FuzzTarget {
  std::string name;
  /// Aborts if something holds that must not.
  void (*feed)(const std::uint8_t* data, std::size_t size);
};

/// The package's own, defined in its fuzz/targets.cpp.
std::vector<FuzzTarget> fuzzTargets();

/// Where its seeds are: its name in small letters.
inline std::string seedsFolder(const FuzzTarget& target) {
  std::string folder;
  for (const char c : target.name) {
    if (std::isupper(static_cast<unsigned char>(c))) folder += '_';
    folder += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }
  return folder;
}

/// Ends the process, which the fuzzer and a test both notice.
inline void require(bool holds) {
  if (!holds) std::abort();
}

inline std::string textOf(const std::uint8_t* data, std::size_t size) {
  return std::string(reinterpret_cast<const char*>(data), size);
}

/// A folder of this process, in memory where the system has such a place.
class FuzzFolder {
 public:
  /// Writes the file and returns its path.
  std::string put(const std::string& name, const std::string& bytes) const {
    std::ofstream(path(name), std::ios::binary | std::ios::trunc) << bytes;
    return path(name);
  }
  std::string path(const std::string& name) const { return directory_ / name; }

 private:
  TemporaryDirectory directory_{std::filesystem::is_directory("/dev/shm")
                                    ? "/dev/shm"
                                    : std::filesystem::temp_directory_path()};
};

}  // namespace testing
}  // namespace hyselam
