// Parameters of a node from a file, for offline tools that take what the node takes.
#pragma once

#include <map>
#include <string>

#include "hyselam_common/ros/params.hpp"

namespace hyselam {

/// A YAML file as rosparam loads it: names and values, groups nested or written with slashes
/// ("loop/near_min_score").
class FileParamSource : public MapParamSource {
 public:
  /// @throws InputError for a file that cannot be read, is no YAML, holds no names, a
  /// name twice, groups nested more than 16 deep or more than 10000 values, aliases followed.
  explicit FileParamSource(const std::string& path);
  std::string where() const override { return path_; }

 private:
  std::string path_;
};

/// For after the last parameter is read: a name that nothing asked for is a mistake in a file that
/// was given by hand. @throws InputError with each such name, and what may have been meant.
void requireAllKnown(const ParamLoader& loader, const std::string& path);

}  // namespace hyselam
