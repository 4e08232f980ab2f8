#include "hyselam_common/ros/rate_limit.hpp"

namespace hyselam {

void loadRate(ParamLoader& loader, const std::string& name, double& rate,
              const std::string& meaning) {
  loader.get(name, rate, rateRange(), meaning);
}

}  // namespace hyselam
