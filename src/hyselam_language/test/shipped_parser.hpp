// The grammars of the package's folder, English and Portuguese, for tests.
#pragma once

#include <string>

#include "hyselam_language/grammar/topo_parser.hpp"

namespace hyselam_topo {
namespace testing {

inline const TopoParser& shippedParser() {
  static const std::string kFolder = HYSELAM_PACKAGE_DIR "/grammar/";
  static const TopoParser kParser(
      {Grammar::load({kFolder + "en.yaml"}), Grammar::load({kFolder + "pt.yaml"})});
  return kParser;
}

}  // namespace testing
}  // namespace hyselam_topo
