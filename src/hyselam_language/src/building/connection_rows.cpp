#include "connection_rows.hpp"

#include <algorithm>

namespace hyselam_topo {

std::vector<std::vector<DescribedConnection>> ConnectionRow::sentences() const {
  std::vector<std::vector<DescribedConnection>> all;
  bool goes_on = false;
  for (const DescribedConnection& each : connections) {
    const bool plain = !each.rank && !each.distance;
    if (!plain || !goes_on) all.emplace_back();
    all.back().push_back(each);
    goes_on = plain;
  }
  return all;
}

std::vector<ConnectionRow> rowsOf(const std::vector<DescribedConnection>& connections,
                                  const DescribedBuilding& building) {
  std::vector<ConnectionRow> rows;
  for (const DescribedConnection& connection : connections) {
    auto row = std::find_if(rows.begin(), rows.end(), [&](const ConnectionRow& each) {
      return each.from == connection.from && each.side == connection.side &&
             lookAlike(each.connections.front().seen_from, connection.seen_from);
    });
    if (row == rows.end()) {
      rows.push_back({connection.from, connection.side, {}});
      row = rows.end() - 1;
    }
    row->connections.push_back(connection);
  }
  const auto place = [&](Id id) { return building.findPlace(id) - building.places.data(); };
  std::stable_sort(rows.begin(), rows.end(), [&](const ConnectionRow& a, const ConnectionRow& b) {
    return place(a.from) < place(b.from);
  });
  for (ConnectionRow& row : rows) {
    std::stable_sort(row.connections.begin(), row.connections.end(),
                     [](const auto& a, const auto& b) { return a.order < b.order; });
  }
  return rows;
}

}  // namespace hyselam_topo
