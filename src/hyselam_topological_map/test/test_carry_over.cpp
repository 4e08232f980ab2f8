#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <map>
#include <random>
#include <set>

#include "hyselam_common/errors.hpp"
#include "hyselam_topological_map/carry_over.hpp"
#include "hyselam_topological_map/map_geometry.hpp"

namespace hyselam_topo {
namespace {

using hyselam::Point2;
using Drawing = std::vector<std::string>;  // the first line is the highest

/// A map with one place per letter, in alphabetical order, its four outer limits as walls, and a
/// door wherever two letters meet in a row.
AugmentedTopologicalMap drawn(const Drawing& rows, double resolution = 1.0, Point2 origin = {}) {
  AugmentedTopologicalMap map;
  PlaceGrid grid;
  grid.geometry.width = static_cast<int>(rows[0].size());
  grid.geometry.height = static_cast<int>(rows.size());
  grid.geometry.resolution = resolution;
  grid.geometry.origin = {origin.x, origin.y, 0.0};
  std::map<char, Id> ids;
  for (const std::string& row : rows) {
    for (const char c : row) {
      if (c != '.') ids[c] = 0;
    }
  }
  for (auto& [letter, id] : ids) {
    id = map.next_place_id++;
    grid.places.push_back(id);
    Place place;
    place.id = id;
    map.places.push_back(place);
  }
  for (int y = 0; y < grid.geometry.height; ++y) {
    const std::string& row = rows[rows.size() - 1 - static_cast<std::size_t>(y)];
    for (int x = 0; x < grid.geometry.width; ++x) {
      const char c = row[static_cast<std::size_t>(x)];
      grid.labels.push_back(c == '.' ? std::uint16_t{0} : static_cast<std::uint16_t>(ids[c]));
      const char next = static_cast<std::size_t>(x) + 1 < row.size() ? row[x + 1u] : '.';
      if (c == '.' || next == '.' || c == next) continue;
      if (map.findEdge(ids[c], ids[next]) == nullptr) {
        Edge edge;
        edge.a = std::min(ids[c], ids[next]);
        edge.b = std::max(ids[c], ids[next]);
        map.edges.push_back(edge);
      }
      const Point2 low = grid.geometry.origin * Point2{(x + 1) * resolution, y * resolution};
      Door door = doorBetween({low.x, low.y + resolution}, low);
      if (ids[c] > ids[next]) door = doorBetween(low, {low.x, low.y + resolution});
      door.id = map.next_door_id++;
      map.findEdge(ids[c], ids[next])->doors.push_back(door);
    }
  }
  for (Place& place : map.places) {
    double x0 = 1e9, y0 = 1e9, x1 = -1e9, y1 = -1e9;
    for (int y = 0; y < grid.geometry.height; ++y) {
      for (int x = 0; x < grid.geometry.width; ++x) {
        if (grid.placeOf({x, y}) != place.id) continue;
        place.area += resolution * resolution;
        const Point2 c = grid.geometry.center({x, y});
        x0 = std::min(x0, c.x - 0.5 * resolution);
        y0 = std::min(y0, c.y - 0.5 * resolution);
        x1 = std::max(x1, c.x + 0.5 * resolution);
        y1 = std::max(y1, c.y + 0.5 * resolution);
      }
    }
    const std::vector<Point2> corners = {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}};
    for (std::size_t i = 0; i < 4; ++i) {
      place.walls.push_back(straightWall(corners[i], corners[(i + 1) % 4]));
      place.walls.back().id = map.next_wall_id++;
    }
    place.outline = corners;
  }
  map.grid = grid;
  normalize(map);
  return map;
}

const Drawing kThreeRooms = {"aaaa.bbbb",  //
                             "aaaa.bbbb",  //
                             "aaaacbbbb",  //
                             "ccccccccc"};

VisualSignature signature(float value) {
  VisualSignature s;
  s.appearance = {"grey", 1, 1, {value}};
  return s;
}

/// Three rooms of which people have told something.
AugmentedTopologicalMap known() {
  AugmentedTopologicalMap map = drawn(kThreeRooms);
  map.places[0].words = {{"kitchen", true}};
  map.places[1].words = {{"office", false}};
  map.places[0].signatures = {signature(1.0f)};
  map.places[1].signatures = {signature(2.0f)};
  map.places[0].extras.attributes = {{"colour", "red"}};
  map.edges[0].words = {{"the swing door", true}};
  map.edges[0].doors[0].state = DoorState::kClosed;
  map.edges[0].doors[0].height = 2.0;
  map.places[0].walls[0].height = 2.5;
  return map;
}

TEST(CarryOver, MapCarriedOverToItselfIsUnchanged) {
  EXPECT_EQ(carryOver(known(), known()), known());
}

TEST(CarryOver, IsIndependentOfFreshIds) {
  // The same rooms under other letters, hence other ids.
  Drawing renamed = kThreeRooms;
  for (std::string& row : renamed) {
    for (char& c : row) c = c == 'a' ? 'z' : c == 'b' ? 'm' : c;
  }
  const auto result = carryOver(known(), drawn(renamed));
  EXPECT_EQ(result.places.size(), 3u);
  for (int y = 0; y < 4; ++y) {
    for (int x = 0; x < 9; ++x) {
      EXPECT_EQ(result.grid->placeOf({x, y}), known().grid->placeOf({x, y}));
    }
  }
  auto expected = known();
  auto same = result;
  same.grid = expected.grid;
  EXPECT_EQ(same, expected);
}

TEST(CarryOver, GrownMovedAndFinerMapKeepsIds) {
  // Half the cell size, two more columns and a row on each side.
  Drawing fine;
  for (const std::string& row : kThreeRooms) {
    std::string line = "....";
    for (const char c : row) line += {c, c};
    line += "....";
    fine.insert(fine.end(), {line, line});
  }
  const std::string blank(fine[0].size(), '.');
  fine.insert(fine.begin(), {blank, blank});
  fine.insert(fine.end(), {blank, blank});
  CarryOverReport report;
  const auto result = carryOver(known(), drawn(fine, 0.5, {-2.0, -1.0}), {}, report);
  EXPECT_EQ(report.kept, (std::vector<Id>{1, 2, 3}));
  EXPECT_TRUE(report.created.empty() && report.lost.empty() && report.merged.empty());
  EXPECT_EQ(result.places[0].words, known().places[0].words);
  EXPECT_EQ(result.places[1].signatures, known().places[1].signatures);
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t k = 0; k < 4; ++k) {
      EXPECT_EQ(result.places[i].walls[k].id, known().places[i].walls[k].id);
    }
  }
  EXPECT_EQ(result.places[0].walls[0].height, 2.5);
}

TEST(CarryOver, BiggerPartKeepsTheId) {
  CarryOverReport report;
  const auto result = carryOver(known(),
                                drawn({"aaaa.bbbb",  //
                                       "aaaa.bbbb",  //
                                       "ddddcbbbb",  //
                                       "ccccccccc"}),
                                {}, report);
  EXPECT_EQ(report.kept, (std::vector<Id>{1, 2, 3}));
  EXPECT_EQ(report.created, (std::vector<Id>{4}));
  ASSERT_EQ(report.split_off.size(), 1u);
  EXPECT_EQ(report.split_off[0], (std::pair<Id, Id>(4, 1)));
  EXPECT_EQ(result.grid->placeOf({0, 3}), 1u);
  EXPECT_EQ(result.grid->placeOf({0, 1}), 4u);
  EXPECT_EQ(result.findPlace(1)->words, known().places[0].words);
  EXPECT_TRUE(result.findPlace(4)->words.empty());
  // The door between the lower part and the corridor is the old one.
  const Edge* edge = result.findEdge(4, 3);
  ASSERT_NE(edge, nullptr);
  EXPECT_EQ(edge->doors[0].id, known().edges[0].doors[0].id);
  EXPECT_EQ(edge->doors[0].state, DoorState::kClosed);
  EXPECT_NO_THROW(checkMap(result, "result"));
}

TEST(CarryOver, NamedPlaceSurvivesAMergeAndWordsAreUnited) {
  const Drawing merged = {"bbbb.bbbb",  //
                          "bbbb.bbbb",  //
                          "bbbbcbbbb",  //
                          "ccccccccc"};
  CarryOverReport report;
  auto result = carryOver(known(), drawn(merged), {}, report);
  EXPECT_EQ(report.merged, (std::vector<std::pair<Id, Id>>{{2, 1}}));
  EXPECT_EQ(result.findPlace(1)->words,
            (std::vector<PlaceTerm>{{"kitchen", true}, {"office", false}}));
  EXPECT_EQ(result.findPlace(1)->signatures.size(), 2u);
  // A confirmed name is stronger than a guess and an older id.
  auto old = known();
  old.places[0].words[0].confirmed = false;
  old.places[1].words[0].confirmed = true;
  EXPECT_NE(carryOver(old, drawn(merged)).findPlace(2), nullptr);
  // Without names the older stays.
  old.places[0].words.clear();
  old.places[1].words.clear();
  EXPECT_NE(carryOver(old, drawn(merged)).findPlace(1), nullptr);
}

TEST(CarryOver, WordsOfEdgesStayWithoutDoors) {
  const auto result = carryOver(known(), drawn({"aaaa.bbbb",  //
                                                "aaaa.bbbb",  //
                                                "aaaa.bbbb",  //
                                                "ccccccccc"}));
  const Edge* edge = result.findEdge(1, 3);
  ASSERT_NE(edge, nullptr);
  EXPECT_TRUE(edge->doors.empty());
  EXPECT_EQ(edge->words, known().edges[0].words);
  EXPECT_EQ(result.findEdge(2, 3), nullptr);
}

TEST(CarryOver, WhatPeopleAddedStays) {
  auto old = known();
  Place corner;
  corner.id = old.next_place_id++;
  corner.kind = PlaceKind::kVirtual;
  corner.words = {{"coffee corner", true}};
  old.places.push_back(corner);
  Edge edge;
  edge.a = 1;
  edge.b = corner.id;
  edge.doors = {doorBetween({0, 3}, {1, 3})};
  edge.doors[0].id = old.next_door_id++;
  edge.doors[0].real = false;
  old.edges.push_back(edge);
  Wall glass = straightWall({0.0, 2.5}, {4.0, 2.5});
  glass.id = old.next_wall_id++;
  glass.kind = WallKind::kGlass;
  old.places[0].walls.push_back(glass);
  normalize(old);
  const auto result = carryOver(old, drawn(kThreeRooms));
  EXPECT_EQ(*result.findPlace(corner.id), corner);
  ASSERT_NE(result.findEdge(1, corner.id), nullptr);
  EXPECT_EQ(*result.findEdge(1, corner.id), edge);
  EXPECT_EQ(result.findPlace(1)->walls.back(), glass);
  // And again, now that it is in both.
  EXPECT_EQ(carryOver(result, result), result);
}

TEST(CarryOver, ReportsLostAndNewPlaces) {
  CarryOverReport report;
  const auto result = carryOver(known(),
                                drawn({"........z",  //
                                       "aaaa....z",  //
                                       "aaaac...z",  //
                                       "ccccccccc"}),
                                {}, report);
  EXPECT_EQ(report.kept, (std::vector<Id>{1, 2, 3}));
  const auto far = carryOver(known(), drawn({"aa"}, 1.0, {50.0, 50.0}), {}, report);
  EXPECT_EQ(report.lost, (std::vector<Id>{1, 2, 3}));
  EXPECT_EQ(report.created, (std::vector<Id>{4}));
  EXPECT_EQ(far.places.size(), 1u);
  EXPECT_EQ(far.places[0].id, 4u);
}

TEST(CarryOver, RequiresOverlap) {
  const auto old = drawn({"aaaa......"});
  EXPECT_EQ(carryOver(old, drawn({"..aaaaaaaa"})).places.at(0).id, 1u);
  // One cell of four is less than 30 %.
  CarryOverReport report;
  EXPECT_EQ(carryOver(old, drawn({"...aaaaaaa"}), {}, report).places.at(0).id, 2u);
  EXPECT_EQ(report.lost, (std::vector<Id>{1}));
}

TEST(CarryOver, IdsAreNeverUsedAgain) {
  std::mt19937 rng(1);
  auto map = known();
  std::set<Id> gone;
  for (int round = 0; round < 60; ++round) {
    Drawing rows = kThreeRooms;
    for (std::string& row : rows) {
      for (char& c : row) {
        if (rng() % 3 == 0) c = ".abcdefg"[rng() % 8];
      }
    }
    std::set<Id> before;
    for (const Place& place : map.places) before.insert(place.id);
    const auto next = carryOver(map, drawn(rows));
    EXPECT_EQ(carryOver(map, drawn(rows)), next);
    checkMap(next, "round " + std::to_string(round));
    std::set<Id> after;
    for (const Place& place : next.places) {
      EXPECT_EQ(gone.count(place.id), 0u);
      after.insert(place.id);
    }
    std::set_difference(before.begin(), before.end(), after.begin(), after.end(),
                        std::inserter(gone, gone.end()));
    map = next;
  }
  EXPECT_FALSE(gone.empty());
}

TEST(CarryOver, RefusesWhenIdsRunOut) {
  auto full = known();
  full.next_wall_id = full.next_door_id = full.next_place_id = std::numeric_limits<Id>::max();
  checkMap(full, "full");
  EXPECT_EQ(carryOver(full, drawn(kThreeRooms)).places.size(), full.places.size());
  Drawing more = kThreeRooms;
  for (std::string& row : more) row += "zzzz";
  EXPECT_THROW(carryOver(full, drawn(more)), hyselam::InputError);
}

TEST(CarryOver, RefusesMapsWithoutGridOrInAnotherFrame) {
  auto no_grid = known();
  no_grid.grid.reset();
  EXPECT_THROW(carryOver(no_grid, known()), hyselam::InputError);
  EXPECT_THROW(carryOver(known(), no_grid), hyselam::InputError);
  auto elsewhere = known();
  elsewhere.frame_id = "odom";
  EXPECT_THROW(carryOver(known(), elsewhere), hyselam::InputError);
  CarryOverParams params;
  params.min_overlap = 0.0;
  EXPECT_THROW(carryOver(known(), known(), params), hyselam::ParameterError);
}

}  // namespace
}  // namespace hyselam_topo
