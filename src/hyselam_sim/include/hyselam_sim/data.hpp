// The plans and routes that come with the package.
#pragma once

#include <string>
#include <vector>

namespace hyselam_sim {

/// Directory with plans/ and routes/: the environment variable HYSELAM_SIM_DATA, else beside the
/// installed library, else the source tree that was built. @throws hyselam::InputError if there is
/// none.
std::string dataDirectory();

/// The file of a plan: `name_or_path` itself if it ends in .yaml or .yml, else the shipped plan of
/// that name. @throws hyselam::InputError, with the nearest name, for an unknown one.
std::string planFile(const std::string& name_or_path);

/// The same for routes.
std::string routeFile(const std::string& name_or_path);

/// Names of everything shipped, sorted.
std::vector<std::string> shippedPlans();
std::vector<std::string> shippedRoutes();

}  // namespace hyselam_sim
