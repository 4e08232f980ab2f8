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

/// A folder of this process that is removed with it, in memory where the system has such a place.
class FuzzFolder {
 public:
  FuzzFolder() {
    const std::filesystem::path memory = "/dev/shm";
    const bool there = std::filesystem::is_directory(memory);
    // A name that nobody can have put a link at.
    std::string name =
        ((there ? memory : std::filesystem::temp_directory_path()) / "hyselam-fuzz-XXXXXX")
            .string();
    require(::mkdtemp(name.data()) != nullptr);
    path_ = name;
  }
  ~FuzzFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  FuzzFolder(const FuzzFolder&) = delete;
  FuzzFolder& operator=(const FuzzFolder&) = delete;

  /// Writes the file and tells its path.
  std::string put(const std::string& name, const std::string& bytes) const {
    std::ofstream(path_ / name, std::ios::binary | std::ios::trunc) << bytes;
    return (path_ / name).string();
  }
  std::string path(const std::string& name) const { return (path_ / name).string(); }

 private:
  std::filesystem::path path_;
};

}  // namespace testing
}  // namespace hyselam
