// What rviz shows of an object map: each seen object with its name, none over another.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <string>

#include "hyselam_objects/ros/conversions.hpp"

namespace hyselam_objects {
namespace {

using visualization_msgs::Marker;

Id addBox(ObjectMap& map, const std::string& kind, Point3 at, std::array<double, 3> size,
          double yaw = 0.0) {
  const Id id = map.addObject(kind);
  ObjectPose pose;
  pose.position = at;
  pose.size = size;
  pose.yaw = yaw;
  map.find(id)->pose = pose;
  return id;
}

void putOn(ObjectMap& map, Id object, Id on) {
  ObjectRelation relation;
  relation.object = object;
  relation.word = RelationWord::kOn;
  relation.other = on;
  map.relate(relation);
}

std::map<std::string, Marker> namesOf(const ObjectMap& map) {
  std::map<std::string, Marker> names;
  for (const Marker& marker : objectMarkers(map).markers) {
    if (marker.ns == "names") names[marker.text] = marker;
  }
  return names;
}

TEST(ObjectMarkers, ShowNamesOverTheCentersOfObjects) {
  ObjectMap map;
  addBox(map, "chair", {1.0, 2.0, 0.45}, {0.4, 0.4, 0.9});
  const auto names = namesOf(map);
  ASSERT_EQ(names.count("chair"), 1u);
  EXPECT_NEAR(names.at("chair").pose.position.x, 1.0, 1e-9);
  EXPECT_NEAR(names.at("chair").pose.position.y, 2.0, 1e-9);
  EXPECT_GT(names.at("chair").pose.position.z, 0.9);
}

TEST(ObjectMarkers, OmitObjectsThatWereOnlyDescribed) {
  ObjectMap map;
  map.addObject("pen");
  EXPECT_TRUE(namesOf(map).empty());
}

// The name of a desk would stand in what lies on it.
TEST(ObjectMarkers, KeepNamesOfFurnitureClearOfObjectsOnIt) {
  for (const double yaw : {0.0, 0.7, -2.0}) {
    ObjectMap map;
    const Id desk = addBox(map, "desk", {3.0, 1.0, 0.4}, {1.6, 0.8, 0.8}, yaw);
    const double c = std::cos(yaw), s = std::sin(yaw);
    const auto onDesk = [&](double x, double y) {
      return Point3{3.0 + c * x - s * y, 1.0 + s * x + c * y, 0.9};
    };
    putOn(map, addBox(map, "cup", onDesk(0.0, 0.1), {0.1, 0.1, 0.2}), desk);
    putOn(map, addBox(map, "PC", onDesk(0.4, 0.2), {0.4, 0.2, 0.4}), desk);
    const auto names = namesOf(map);
    const auto& name = names.at("desk").pose.position;
    for (const char* thing : {"cup", "PC"}) {
      const auto& other = names.at(thing).pose.position;
      EXPECT_GT(std::hypot(name.x - other.x, name.y - other.y), 0.4) << thing << " at " << yaw;
    }
    const double x = c * (name.x - 3.0) + s * (name.y - 1.0);
    const double y = -s * (name.x - 3.0) + c * (name.y - 1.0);
    EXPECT_LE(std::abs(x), 0.8) << yaw;
    EXPECT_LE(std::abs(y), 0.4) << yaw;
  }
}

}  // namespace
}  // namespace hyselam_objects
