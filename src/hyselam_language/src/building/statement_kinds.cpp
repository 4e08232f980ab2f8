#include "statement_kinds.hpp"

#include <map>

namespace hyselam_topo {

RecordStatement statementKind(const std::string& intent) {
  using namespace statements;
  static const std::map<std::string, RecordStatement> kKinds{{"robot_in", robotIn},
                                                             {"this_is", robotIn},
                                                             {"neighbours", neighbours},
                                                             {"nth_neighbour", neighbours},
                                                             {"contains", contains},
                                                             {"joined", joined},
                                                             {"next_to", relation},
                                                             {"opposite", relation},
                                                             {"between", relation},
                                                             {"at_end_of", relation},
                                                             {"part_of", relation},
                                                             {"alias", alias},
                                                             {"kind", kind},
                                                             {"size", size},
                                                             {"length_of", size},
                                                             {"width_of", size},
                                                             {"area", size},
                                                             {"parts", parts},
                                                             {"building", buildingCount},
                                                             {"exists", exists},
                                                             {"forget_place", gone},
                                                             {"gone", gone},
                                                             {"located", located},
                                                             {"doors", doors},
                                                             {"row", row},
                                                             {"each_side", eachSide},
                                                             {"larger", larger},
                                                             {"size_word", sizeWord},
                                                             {"owner", owner},
                                                             {"owner_located", ownerLocated}};
  const auto found = kKinds.find(intent);
  return found == kKinds.end() ? nullptr : found->second;
}

}  // namespace hyselam_topo
