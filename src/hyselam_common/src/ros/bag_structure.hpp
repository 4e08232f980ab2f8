// A look at the skeleton of a bag before the rosbag library trusts it.
#pragma once

#include <string>

namespace hyselam {

/// Walks over all records of a bag (format 2.0) and checks that lengths and positions stay inside
/// it: rosbag_storage follows them blindly, and a damaged bag would end the process. `name` is what
/// errors call the file. Throws InputError with the byte.
/// Records inside of compressed chunks are not looked at; compression has its own check sums.
void checkBagStructure(const std::string& file, const std::string& name);

}  // namespace hyselam
