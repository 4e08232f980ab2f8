#include "edit_description.hpp"

#include <algorithm>
#include <cmath>

#include "hyselam_common/numbers.hpp"

namespace hyselam_topo {
namespace {

template <typename List, typename Goes>
void eraseIf(List* list, Goes goes) {
  list->erase(std::remove_if(list->begin(), list->end(), goes), list->end());
}

template <typename T>
void takeOver(const std::optional<T>& told, std::optional<T>* known) {
  if (!*known) *known = told;
}

/// What was told of the one alone.
void takeOverTold(const DescribedPlace& of, DescribedPlace* to) {
  takeOver(of.kind, &to->kind);
  takeOver(of.length, &to->length);
  takeOver(of.width, &to->width);
  takeOver(of.area, &to->area);
  takeOver(of.parts, &to->parts);
  takeOver(of.size_word, &to->size_word);
  takeOver(of.doors, &to->doors);
  takeOver(of.floor, &to->floor);
}

}  // namespace

Id addPlace(const std::string& name, const std::optional<PlaceKind>& kind,
            DescribedBuilding* building) {
  DescribedPlace made;
  for (const DescribedPlace& other : building->places) made.id = std::max(made.id, other.id);
  ++made.id;
  made.name = name;
  made.kind = kind;
  building->places.push_back(made);
  return made.id;
}

const DescribedConnection* findConnection(const DescribedBuilding& building, Id a, Id b) {
  const auto& all = building.connections;
  const auto found = std::find_if(all.begin(), all.end(), [&](const auto& connection) {
    return std::minmax(connection.from, connection.to) == std::minmax(a, b);
  });
  return found == all.end() ? nullptr : &*found;
}

void removeConnection(const DescribedConnection& connection, DescribedBuilding* building) {
  const DescribedConnection gone = connection;
  eraseIf(&building->connections,
          [&](const auto& each) { return each.from == gone.from && each.to == gone.to; });
  for (DescribedConnection& other : building->connections) {
    const bool same_row = other.from == gone.from && other.side == gone.side;
    if (same_row && other.order > gone.order) --other.order;
  }
}

void removePlace(Id place, DescribedBuilding* building) {
  auto& connections = building->connections;
  for (std::size_t i = connections.size(); i-- > 0;) {
    const DescribedConnection each = connections[i];
    if (each.from == place || each.to == place) removeConnection(each, building);
  }
  eraseIf(&building->relations,
          [&](const auto& each) { return each.a == place || each.b == place || each.c == place; });
  eraseIf(&building->places, [&](const auto& each) { return each.id == place; });
  if (building->robot_place == place) building->robot_place.reset();
}

void joinPlaces(Id gone, Id stays, DescribedBuilding* building) {
  takeOverTold(*building->findPlace(gone), building->findPlace(stays));
  std::vector<DescribedConnection> told = building->connections;
  std::stable_sort(told.begin(), told.end(),
                   [](const auto& a, const auto& b) { return a.order < b.order; });
  for (DescribedConnection each : told) {
    if (each.from != gone && each.to != gone) continue;
    removeConnection(each, building);
    (each.from == gone ? each.from : each.to) = stays;
    if (each.from == each.to) continue;
    if (const DescribedConnection* known = findConnection(*building, each.from, each.to)) {
      // A side tells more than that they are joined.
      if (known->side != Side::kUnknown || each.side == Side::kUnknown) continue;
      removeConnection(*known, building);
    }
    each.order = 0;
    for (const DescribedConnection& other : building->connections) {
      const bool same_row = other.from == each.from && other.side == each.side;
      if (same_row) each.order = std::max(each.order, other.order + 1);
    }
    building->connections.push_back(each);
  }
  auto& relations = building->relations;
  for (DescribedRelation& each : relations) {
    for (Id* id : {&each.a, &each.b, &each.c}) {
      if (*id == gone) *id = stays;
    }
  }
  eraseIf(&relations, [](const DescribedRelation& each) {
    return each.a == each.b || each.a == each.c || each.b == each.c;
  });
  if (building->robot_place == gone) building->robot_place = stays;
  removePlace(gone, building);
}

std::string shown(double value) {
  return hyselam::formatNumber(std::round(value * 1000.0) / 1000.0);
}

}  // namespace hyselam_topo
