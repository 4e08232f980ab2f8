// Names of places lie within their places, beside their nodes, at a size that can be read.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>

#include "hyselam_topological_map/place_labels.hpp"

namespace hyselam_topo {
namespace {

using hyselam::Point2;

/// A map of one place: the points for which `inside` holds, of a square of 12 m.
AugmentedTopologicalMap mapOf(const std::function<bool(Point2)>& inside, Point2 centre,
                              double theta = 0.0) {
  AugmentedTopologicalMap map;
  Place place;
  place.id = 1;
  place.centre = Point3{centre.x, centre.y, 0.0};
  place.area = 10.0;
  map.places = {place};
  PlaceGrid grid;
  grid.geometry = {240, 240, 0.05, {0.0, 0.0, theta}};
  grid.places = {1};
  for (int y = 0; y < 240; ++y) {
    for (int x = 0; x < 240; ++x) {
      grid.labels.push_back(inside(grid.geometry.center({x, y})) ? 1 : 0);
    }
  }
  map.grid = grid;
  return map;
}

std::function<bool(Point2)> box(double x0, double y0, double x1, double y1) {
  return [=](Point2 p) { return p.x > x0 && p.x < x1 && p.y > y0 && p.y < y1; };
}

PlaceLabel labelIn(const AugmentedTopologicalMap& map, const std::string& code,
                   const std::string& name) {
  const auto boxes = placeBoxes(*map.grid);
  return placeLabel(map, map.places[0], &boxes.at(1), code, name);
}

/// Whether each point of the block of text is within the place.
bool liesWithin(const PlaceLabel& label, const std::function<bool(Point2)>& inside) {
  const TextSize size = textSize(label.text);
  const double w = label.height * size.width, h = label.height * size.height;
  for (int i = 0; i <= 20; ++i) {
    for (int k = 0; k <= 20; ++k) {
      const Point2 p{label.position.x + w * (i / 20.0 - 0.5),
                     label.position.y + h * (k / 20.0 - 0.5)};
      if (!inside(p)) return false;
    }
  }
  return true;
}

TEST(PlaceLabels, StandAboveTheNodeWhereThereIsRoom) {
  const auto inside = box(1, 1, 9, 9);
  const PlaceLabelParams params;
  const PlaceLabel label = labelIn(mapOf(inside, {5, 5}), "", "meeting room");
  EXPECT_EQ(label.text, "meeting room");
  EXPECT_EQ(label.height, params.max_height);
  EXPECT_NEAR(label.position.x, 5.0, 0.06);
  EXPECT_GT(label.position.y - 0.5 * label.height, 5.0 + params.node_radius);
  EXPECT_LT(label.position.y - 0.5 * label.height, 5.0 + params.node_radius + 0.3);
  EXPECT_TRUE(liesWithin(label, inside));
}

TEST(PlaceLabels, BreakAtWordsInNarrowPlacesAndKeepTheirSize) {
  const auto inside = box(1, 1, 4, 9);
  const PlaceLabel label = labelIn(mapOf(inside, {2.5, 5}), "SS01", "large conference room");
  EXPECT_TRUE(liesWithin(label, inside)) << label.text;
  EXPECT_GE(label.height, 0.4) << label.text;
  EXPECT_EQ(label.text.find("confer\n"), std::string::npos);
  std::string words;
  for (const char c : label.text) {
    if (c == '\n') {
      words += '|';
    } else if (c != ' ') {
      words += c;
    }
  }
  EXPECT_EQ(words, "SS01|large|conference|room");
}

TEST(PlaceLabels, ShrinkOnlyAsFarAsTheyCanBeRead) {
  const auto small = box(5, 5, 6.9, 7);
  const PlaceLabel fits = labelIn(mapOf(small, {5.95, 6.0}), "", "library");
  EXPECT_TRUE(liesWithin(fits, small));
  const PlaceLabelParams params;
  const auto tiny = box(5, 5, 5.6, 5.6);
  const PlaceLabel label = labelIn(mapOf(tiny, {5.3, 5.3}), "SS01", "conference room");
  EXPECT_EQ(label.height, params.min_height);
  EXPECT_NEAR(label.position.x, 5.3, 0.1);
  EXPECT_NEAR(label.position.y, 5.3, 0.1);
}

// The mean of the cells of an L, and the point right above its node, are outside of it.
TEST(PlaceLabels, StayInsideOfAnL) {
  const auto inside = [](Point2 p) { return box(1, 1, 11, 2.6)(p) || box(1, 1, 2.2, 11)(p); };
  for (const Point2 node : {Point2{9.0, 1.8}, Point2{1.6, 9.0}, Point2{1.6, 1.6}}) {
    const PlaceLabel label = labelIn(mapOf(inside, node), "CC10", "corridor");
    EXPECT_TRUE(liesWithin(label, inside)) << node.x << ' ' << node.y << '\n' << label.text;
  }
}

TEST(PlaceLabels, DoNotHideTheNode) {
  const auto inside = box(1, 1, 11, 2.6);
  const PlaceLabelParams params;
  const PlaceLabel label = labelIn(mapOf(inside, {6, 1.8}), "CC10", "corridor");
  const TextSize size = textSize(label.text);
  const double dx =
      std::max(0.0, std::abs(label.position.x - 6.0) - 0.5 * label.height * size.width);
  const double dy =
      std::max(0.0, std::abs(label.position.y - 1.8) - 0.5 * label.height * size.height);
  EXPECT_GE(std::hypot(dx, dy), params.node_radius - 0.05);
  EXPECT_TRUE(liesWithin(label, inside));
}

// A place that was only told, without walls, within a large room.
TEST(PlaceLabels, ReachOverBordersWithoutWallsRatherThanOverTheNode) {
  const auto room = box(1, 1, 11, 11);
  AugmentedTopologicalMap map = mapOf(room, {6, 6});
  for (int y = 0; y < 240; ++y) {
    for (int x = 0; x < 240; ++x) {
      const Point2 p = map.grid->geometry.center({x, y});
      if (std::hypot(p.x - 6.0, p.y - 6.0) > 0.6 && room(p)) {
        map.grid->labels[static_cast<std::size_t>(y * 240 + x)] = 2;
      }
    }
  }
  map.grid->places = {1, 2};
  const PlaceLabelParams params;
  const PlaceLabel label = labelIn(map, "VV07", "sunroom");
  EXPECT_GE(label.position.y - 0.5 * label.height * textSize(label.text).height,
            6.0 + params.node_radius - 0.05);
  EXPECT_LT(label.position.y, 7.0);
  EXPECT_NEAR(label.position.x, 6.0, 0.1);
}

// Text is level in the map, whatever way its grid lies.
TEST(PlaceLabels, FollowTheMapNotTheGrid) {
  const auto inside = box(-2, 7, 2, 9);
  const PlaceLabel label = labelIn(mapOf(inside, {0, 8}, 0.8), "SS01", "Carlos' office");
  EXPECT_TRUE(liesWithin(label, inside)) << label.position.x << ' ' << label.position.y;
}

// Holes of one cell, as a laser leaves them at a distance, do not drive a name away.
TEST(PlaceLabels, IgnoreSingleCells) {
  const auto inside = [](Point2 p) {
    const int x = static_cast<int>(p.x / 0.05), y = static_cast<int>(p.y / 0.05);
    return box(1, 1, 6, 6)(p) && !(x % 7 == 0 && y % 5 == 0);
  };
  const PlaceLabel label = labelIn(mapOf(inside, {3.5, 3.5}), "", "kitchen");
  EXPECT_EQ(label.height, PlaceLabelParams().max_height);
}

TEST(PlaceLabels, AreAboveTheNodeWithoutCells) {
  AugmentedTopologicalMap map = mapOf(box(1, 1, 2, 2), {4, 5});
  map.grid.reset();
  const PlaceLabel label = placeLabel(map, map.places[0], nullptr, "SS01", "toilet");
  EXPECT_EQ(label.position.x, 4.0);
  EXPECT_GT(label.position.y, 5.0);
  EXPECT_EQ(label.text.substr(label.text.find_first_not_of(' ')), "SS01\ntoilet");
}

TEST(PlaceLabels, IndentShortLinesToTheMiddle) {
  AugmentedTopologicalMap map = mapOf(box(1, 1, 2, 2), {4, 5});
  map.grid.reset();
  const auto text = [&](const std::string& code, const std::string& name) {
    return placeLabel(map, map.places[0], nullptr, code, name).text;
  };
  EXPECT_EQ(text("SS01", "meeting room"), "   SS01\nmeeting room");
  EXPECT_EQ(text("SS01", ""), "SS01");
  EXPECT_EQ(text("", "kitchen"), "kitchen");
}

TEST(PlaceLabels, CountLettersNotBytes) {
  EXPECT_EQ(textSize("caf\xc3\xa9").width, textSize("cafe").width);
  EXPECT_EQ(textSize("a\nbb").height, 2.0);
}

}  // namespace
}  // namespace hyselam_topo
