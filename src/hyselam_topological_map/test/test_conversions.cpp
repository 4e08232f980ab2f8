#include <gtest/gtest.h>
#include <ros/serialization.h>

#include <set>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/testing/files.hpp"
#include "hyselam_topological_map/map_geometry.hpp"
#include "hyselam_topological_map/ros/conversions.hpp"
#include "hyselam_topological_map/ros/map_markers.hpp"
#include "hyselam_topological_map/testing/random_maps.hpp"

namespace hyselam_topo {
namespace {

using hyselam::testing::messageOf;
using visualization_msgs::Marker;

/// A map whose stamp a message can hold.
AugmentedTopologicalMap randomMap(unsigned seed) {
  AugmentedTopologicalMap map = testing::RandomMaps(seed).map();
  map.stamp = seed % 3 == 0 ? 0.0 : 1.5e9 + 0.25 * seed;
  return map;
}

TEST(Conversions, MapsRoundTripThroughMessages) {
  for (unsigned seed = 0; seed < 100; ++seed) {
    const AugmentedTopologicalMap map = randomMap(seed);
    const auto wire = ros::serialization::serializeMessage(toMsg(map));
    hyselam_msgs::AugmentedTopologicalMap msg;
    ros::serialization::deserializeMessage(wire, msg);
    EXPECT_EQ(fromMsg(msg, "map"), map) << seed;
  }
}

TEST(Conversions, BadMessagesAreRefused) {
  hyselam_msgs::AugmentedTopologicalMap good;
  for (unsigned seed = 0; good.edges.empty() || good.edges[0].doors.empty() || !good.has_grid ||
                          good.places[0].walls.empty();
       ++seed) {
    good = toMsg(randomMap(seed));
  }
  const auto error = [&](const std::function<void(hyselam_msgs::AugmentedTopologicalMap&)>& spoil) {
    auto msg = good;
    spoil(msg);
    return messageOf<hyselam::InputError>([&] { fromMsg(msg, "topological_map"); });
  };
  const auto in = [](const std::string& part, const std::string& text) {
    EXPECT_NE(text.find(part), std::string::npos) << "'" << part << "' is not in: " << text;
  };
  EXPECT_EQ(error([](auto&) {}), "");
  in("kind is 3", error([](auto& m) { m.places[0].kind = 3; }));
  in("kind is 9", error([](auto& m) { m.places[0].walls[0].kind = 9; }));
  in("state is 7", error([](auto& m) { m.edges[0].doors[0].state = 7; }));
  in("outline", error([](auto& m) { m.places[0].outline_x.push_back(0.0); }));
  in("more than one appearance", error([](auto& m) { m.edges[0].doors[0].appearance.resize(2); }));
  in("finite", error([](auto& m) { m.places[0].walls[0].length = std::nan(""); }));
  in("width * height", error([](auto& m) { m.grid.labels.pop_back(); }));
  in("too large", error([](auto& m) { m.grid.width = 4000000000u; }));
  in("frame_id", error([](auto& m) { m.header.frame_id.clear(); }));
  in("not as many values", error([](auto& m) { m.extras.attribute_names.push_back("x"); }));
  in("no place", error([](auto& m) { m.edges[0].b = 1000; }));
}

AugmentedTopologicalMap corridorAndRoom() {
  AugmentedTopologicalMap map;
  for (Id id = 1; id <= 2; ++id) {
    Place place;
    place.id = id;
    place.centre = Point3{0.5 + id, 1.0, 0.0};
    place.area = 4.0;
    map.places.push_back(place);
  }
  map.places[0].words = {{"guess", false}, {"kitchen", true}};
  map.places[1].kind = PlaceKind::kCorridor;
  map.places[0].walls = {straightWall({0, 0}, {2, 0}), straightWall({0, 2}, {0, 0})};
  map.places[0].walls[1].kind = WallKind::kVirtual;
  Edge edge;
  edge.a = 1;
  edge.b = 2;
  edge.doors = {doorBetween({2, 1.5}, {2, 0.5})};
  map.edges = {edge};
  PlaceGrid grid;
  grid.geometry = {4, 2, 1.0, {1.0, 2.0, 0.5}};
  grid.labels = {1, 1, 0, 2,  //
                 1, 1, 2, 2};
  grid.places = {1, 2};
  map.grid = grid;
  Id id = 0;
  for (Wall& wall : map.places[0].walls) wall.id = ++id;
  map.edges[0].doors[0].id = 1;
  normalize(map);
  checkMap(map, "test");
  return map;
}

double areaOf(const Marker& triangles) {
  double area = 0.0;
  for (std::size_t i = 0; i + 2 < triangles.points.size(); i += 3) {
    const auto &a = triangles.points[i], &b = triangles.points[i + 1], &c = triangles.points[i + 2];
    area += 0.5 * std::abs((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x));
  }
  return area;
}

TEST(Markers, ShowEveryPartOnce) {
  const auto array = mapMarkers(corridorAndRoom());
  ASSERT_FALSE(array.markers.empty());
  EXPECT_EQ(array.markers[0].action, Marker::DELETEALL);
  std::set<std::pair<std::string, int>> names;
  std::set<std::string> texts, namespaces;
  for (std::size_t i = 1; i < array.markers.size(); ++i) {
    const Marker& m = array.markers[i];
    EXPECT_TRUE(names.insert({m.ns, m.id}).second) << m.ns << " " << m.id;
    EXPECT_EQ(m.header.frame_id, "map");
    EXPECT_TRUE(m.header.stamp.isZero());
    EXPECT_EQ(m.pose.orientation.w, 1.0);
    namespaces.insert(m.ns);
    if (m.type == Marker::TEXT_VIEW_FACING) texts.insert(m.text);
    if (m.ns == "places") {
      EXPECT_NEAR(areaOf(m), m.id == 1 ? 4.0 : 3.0, 1e-9);
    }
    if (m.type == Marker::LINE_LIST) {
      EXPECT_EQ(m.points.size() % 2, 0u);
    }
  }
  EXPECT_EQ(texts, (std::set<std::string>{"kitchen", "corridor 2"}));
  EXPECT_EQ(namespaces, (std::set<std::string>{"places", "names", "walls", "doors", "graph"}));
}

// Above its node there is no room for a name in a corridor of 1.4 m; beside it there is.
TEST(Markers, NamesLieWithinTheirPlaces) {
  AugmentedTopologicalMap map;
  Place place;
  place.id = 1;
  place.kind = PlaceKind::kCorridor;
  place.centre = Point3{4.0, 1.5, 0.0};
  place.area = 20.0;
  place.words = {{"corridor", true}};
  map.places = {place};
  PlaceGrid grid;
  grid.geometry = {80, 30, 0.1, {}};
  for (int i = 0; i < 80 * 30; ++i) grid.labels.push_back(i / 80 >= 8 && i / 80 < 22 ? 1 : 0);
  grid.places = {1};
  map.grid = grid;
  int names = 0;
  for (const Marker& m : mapMarkers(map).markers) {
    if (m.ns != "names") continue;
    ++names;
    EXPECT_EQ(m.text, "corridor");
    EXPECT_LE(m.pose.position.y + 0.5 * m.scale.z, 2.2);
    EXPECT_GE(m.pose.position.y - 0.5 * m.scale.z, 0.8);
  }
  EXPECT_EQ(names, 1);
}

TEST(Markers, EmptyMapOnlyDeletes) {
  EXPECT_EQ(mapMarkers(AugmentedTopologicalMap{}).markers.size(), 1u);
}

TEST(Markers, DoorSwingStaysOnItsPosts) {
  // The leaf turns about the first post into the place that the normal points to.
  const auto array = mapMarkers(corridorAndRoom());
  for (const Marker& m : array.markers) {
    if (m.ns != "doors" || m.id != 0) continue;
    for (const auto& p : m.points) {
      EXPECT_LE(std::hypot(p.x - 2.0, p.y - 1.5), 1.0 + 1e-6);
      EXPECT_GE(p.x, 2.0 - 1e-6);
    }
  }
}

TEST(Conversions, FramesAsTf2WantsThem) {
  EXPECT_EQ(frameOf("/map"), "map");
  EXPECT_EQ(frameOf("floor/1"), "floor/1");
  EXPECT_EQ(frameOf(""), "map");
  EXPECT_EQ(frameOf("/"), "map");
}

}  // namespace
}  // namespace hyselam_topo
