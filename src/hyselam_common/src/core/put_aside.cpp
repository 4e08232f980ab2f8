#include "hyselam_common/put_aside.hpp"

#include <filesystem>

namespace hyselam {

bool mayExist(const std::string& path) {
  std::error_code unseen;
  return std::filesystem::exists(path, unseen) || unseen;
}

std::optional<std::string> putAside(const std::string& path) {
  const std::string first = path + ".damaged";
  std::string aside = first;
  std::error_code error;
  for (int i = 2; std::filesystem::exists(std::filesystem::symlink_status(aside, error)); ++i) {
    aside = first + '.' + std::to_string(i);
  }
  std::filesystem::rename(path, aside, error);
  if (error) return std::nullopt;
  return aside;
}

std::string keptAs(const std::optional<std::string>& aside) {
  return aside ? "; the file is kept as " + *aside : "";
}

}  // namespace hyselam
