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

#include "hyselam_common/checksum.hpp"
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

/// The text of a model, whose checksum at the end is made right: else nearly all would end there.
inline std::string withRightChecksum(std::string text) {
  const std::size_t last = text.rfind("checksum ");
  if (last == std::string::npos) return text;
  text.resize(last);
  return text + "checksum " + crc32Text(text) + "\n";
}

/// A model out of its text, whose text is the same again. @throws InputError if it is refused.
template <typename Model>
Model modelWrittenBack(const std::string& text) {
  Model model = Model::fromText(text, "fuzz");
  const std::string written = model.toText();
  require(Model::fromText(written, "written").toText() == written);
  return model;
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
