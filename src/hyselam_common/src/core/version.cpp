#include "hyselam_common/version.hpp"

namespace hyselam {

const char* version() {
  return HYSELAM_VERSION;  // of package.xml, by CMake
}

}  // namespace hyselam
