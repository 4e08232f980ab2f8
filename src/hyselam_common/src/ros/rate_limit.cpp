#include "hyselam_common/ros/rate_limit.hpp"

namespace hyselam {

void loadRate(ParamLoader& loader, const std::string& name, double& rate,
              const std::string& meaning) {
  loader.get(name, rate, Range::between(-1.0, 1000.0), meaning);
  if (rate != -1.0 && !(rate > 0.0)) {
    throw ParameterError(name, rate, "-1, or > 0 and <= 1000 Hz");
  }
}

}  // namespace hyselam
