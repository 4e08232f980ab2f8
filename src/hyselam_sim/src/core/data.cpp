#include "hyselam_sim/data.hpp"

#include <dlfcn.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>

#include "hyselam_common/errors.hpp"
#include "yaml_map.hpp"

namespace hyselam_sim {
namespace {

namespace fs = std::filesystem;

bool isData(const fs::path& directory) {
  std::error_code ignored;
  return fs::is_directory(directory / "plans", ignored);
}

std::vector<std::string> names(const char* folder) {
  std::vector<std::string> out;
  for (const auto& entry : fs::directory_iterator(fs::path(dataDirectory()) / folder)) {
    if (entry.path().extension() == ".yaml") out.push_back(entry.path().stem().string());
  }
  std::sort(out.begin(), out.end());
  return out;
}

std::string find(const char* what, const char* folder, const std::string& name_or_path) {
  const std::string extension = fs::path(name_or_path).extension().string();
  if (extension == ".yaml" || extension == ".yml") return name_or_path;
  const std::vector<std::string> known = names(folder);
  if (std::find(known.begin(), known.end(), name_or_path) == known.end()) {
    throw hyselam::InputError(name_or_path, "",
                              std::string("neither a .yaml file nor a ") + what +
                                  " that comes with the simulator" +
                                  suggestion(name_or_path, known));
  }
  return (fs::path(dataDirectory()) / folder / (name_or_path + ".yaml")).string();
}

}  // namespace

std::string dataDirectory() {
  if (const char* variable = std::getenv("HYSELAM_SIM_DATA")) {
    if (isData(variable)) return variable;
    throw hyselam::InputError(variable, "environment variable HYSELAM_SIM_DATA",
                              "has no directory 'plans'");
  }
  Dl_info library{};
  if (dladdr(reinterpret_cast<void*>(&dataDirectory), &library) != 0 && library.dli_fname) {
    std::error_code ignored;
    const fs::path file = fs::canonical(library.dli_fname, ignored);
    for (fs::path up = file.parent_path(); up.has_relative_path(); up = up.parent_path()) {
      const fs::path share = up / "share" / "hyselam_sim";
      if (isData(share)) return share.string();
      if (up.filename() == "lib") continue;
      if (up.parent_path().filename() != "lib") break;
    }
  }
  if (isData(HYSELAM_SIM_SOURCE_DIR)) return HYSELAM_SIM_SOURCE_DIR;
  throw hyselam::InputError("hyselam_sim", "", "the plans and routes are not installed");
}

std::string planFile(const std::string& name_or_path) {
  return find("plan", "plans", name_or_path);
}
std::string routeFile(const std::string& name_or_path) {
  return find("route", "routes", name_or_path);
}
std::vector<std::string> shippedPlans() {
  return names("plans");
}
std::vector<std::string> shippedRoutes() {
  return names("routes");
}

}  // namespace hyselam_sim
