// The header of a PCD file, read strictly before PCL reads it: PCL makes room for all that a header
// announces, follows sizes that fit neither the fields nor the data, and goes on reading lines of a
// header in the data.
#pragma once

#include <cstddef>
#include <string>

namespace hyselam_objects {

struct PcdHeader {
  std::size_t length = 0;  ///< bytes before the data
  std::size_t points = 0;  ///< announced, 1 .. 50 million
};

/// Throws hyselam::InputError, naming `source` and line, for a header that is
/// none or contradicts itself, and for one that announces more than `bytes` hold or than 50 million
/// points.
PcdHeader checkPcdHeader(const std::string& bytes, const std::string& source);

}  // namespace hyselam_objects
