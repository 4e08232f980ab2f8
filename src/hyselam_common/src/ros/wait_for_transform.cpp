#include "hyselam_common/ros/wait_for_transform.hpp"

#include <iomanip>
#include <sstream>

namespace hyselam {

std::string missingTransform(const tf2::BufferCore& tf, const std::string& target,
                             const std::string& source, const ros::Time& time) {
  std::string why;
  if (tf.canTransform(target, source, time, &why)) return "";
  std::ostringstream out;
  out << target << " -> " << source;
  if (!time.isZero()) out << " at " << std::fixed << std::setprecision(3) << time.toSec() << " s";
  out << ": " << why;
  return out.str();
}

}  // namespace hyselam
