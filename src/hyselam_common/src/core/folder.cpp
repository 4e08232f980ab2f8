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

}  // namespace hyselam
