#include "hyselam_common/folder.hpp"

#include <filesystem>

#include "hyselam_common/errors.hpp"

namespace hyselam {

void makeFolder(const std::string& path) {
  std::error_code error;
  std::filesystem::create_directories(path, error);
  if (error || !std::filesystem::is_directory(path, error)) {
    throw InputError(path, "", "is not a folder and cannot be made one");
  }
}

void checkFolderOfState(const std::string& parameter, const std::string& file) {
  if (file.empty()) return;
  const std::filesystem::path parent = std::filesystem::path(file).parent_path();
  const std::string folder = parent.empty() ? "." : parent.string();
  std::error_code error;
  if (std::filesystem::is_directory(folder, error)) return;
  throw ParameterError(parameter, file,
                       "a file in an existing folder, and " + folder +
                           " is none; hyselam.launch has it from work_dir. To make it: mkdir -p " +
                           folder);
}

}  // namespace hyselam
