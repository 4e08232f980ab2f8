// Connections in the order in which a person tells them: from place to place, side by side.
#pragma once

#include <vector>

#include "hyselam_language/building/described_building.hpp"

namespace hyselam_topo {

struct ConnectionRow {
  Id from = 0;
  Side side = Side::kUnknown;
  std::vector<DescribedConnection> connections;  ///< in their order
  /// The runs of them that fit in one sentence: those without rank and distance, and each other.
  std::vector<std::vector<DescribedConnection>> sentences() const;
};

/// Rows by the order of their place in the description, then as first told.
std::vector<ConnectionRow> rowsOf(const std::vector<DescribedConnection>& connections,
                                  const DescribedBuilding& building);

}  // namespace hyselam_topo
