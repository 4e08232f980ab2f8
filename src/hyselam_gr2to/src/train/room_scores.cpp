#include "room_scores.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace hyselam_topo {
namespace {

constexpr double kSmallest = 100.0;  // [cells]

struct Overlap {
  double cells = 0.0;
  std::size_t place = 0;
  std::size_t room = 0;
};

struct Table {
  std::vector<Overlap> overlaps;  // largest first
  std::vector<double> places;     // cells in any room
  std::vector<double> rooms;      // cells in any place
  double total = 0.0;
};

Table tabulate(const std::vector<std::vector<int>>& cells, int rooms) {
  Table table;
  table.rooms.assign(static_cast<std::size_t>(rooms) + 1, 0.0);
  for (const std::vector<int>& place : cells) {
    const double all = std::accumulate(place.begin(), place.end(), 0.0);
    if (all <= kSmallest) continue;
    table.places.push_back(all - place[0]);
    table.total += all - place[0];
    for (std::size_t room = 1; room < place.size(); ++room) {
      if (place[room] == 0) continue;
      table.rooms[room] += place[room];
      table.overlaps.push_back({static_cast<double>(place[room]), table.places.size() - 1, room});
    }
  }
  std::stable_sort(table.overlaps.begin(), table.overlaps.end(),
                   [](const Overlap& x, const Overlap& y) { return x.cells > y.cells; });
  return table;
}

double correlation(const Overlap& pair, const Table& table) {
  const double tp = pair.cells, fp = table.places[pair.place] - tp;
  const double fn = table.rooms[pair.room] - tp, tn = table.total - tp - fp - fn;
  const double d = (tp + fp) * (tp + fn) * (tn + fp) * (tn + fn);
  if (d > 0.0) return (tp * tn - fp * fn) / std::sqrt(d);
  return fp == 0.0 && fn == 0.0 ? 1.0 : 0.0;
}

}  // namespace

RoomScores scoreRooms(const std::vector<std::vector<int>>& cells, int rooms) {
  const Table table = tabulate(cells, rooms);
  RoomScores s;
  s.places = static_cast<double>(table.places.size());
  if (table.places.empty() || rooms == 0) return s;
  std::vector<char> place_seen(table.places.size(), 0), room_seen(table.rooms.size(), 0);
  std::vector<char> place_paired(table.places.size(), 0), room_paired(table.rooms.size(), 0);
  double found = 0.0, pairs = 0.0, correlations = 0.0;
  for (const Overlap& o : table.overlaps) {
    const double place = table.places[o.place], room = table.rooms[o.room];
    if (!place_seen[o.place]) s.precision += o.cells / place;
    if (!room_seen[o.room]) s.recall += o.cells / room;
    place_seen[o.place] = room_seen[o.room] = 1;
    if (o.cells / (place + room - o.cells) >= 0.5) found += 1.0;  // one pair for each room at most
    if (place_paired[o.place] || room_paired[o.room]) continue;
    place_paired[o.place] = room_paired[o.room] = 1;
    pairs += 1.0;
    correlations += correlation(o, table);
  }
  s.precision /= s.places;
  s.recall /= rooms;
  s.f1 = 2.0 * found / (s.places + rooms);
  s.mcc = correlations / (s.places + rooms - pairs);
  return s;
}

}  // namespace hyselam_topo
