// Detections become a map: association, evidence, moved things, relations, movability.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "hyselam_common/errors.hpp"
#include "hyselam_objects/mapping/object_mapper.hpp"
#include "hyselam_objects/recognition/object_descriptor.hpp"

using namespace hyselam_objects;  // NOLINT: a test, not a header

namespace {

DetectedObject seen(double x, double y, double z, std::array<double, 3> size, std::uint32_t color,
                    bool furniture = false) {
  DetectedObject object;
  object.furniture = furniture;
  object.low = {x - 0.5 * size[0], y - 0.5 * size[1], z};
  object.high = {x + 0.5 * size[0], y + 0.5 * size[1], z + size[2]};
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < 400; ++i) {
    points.emplace_back(static_cast<float>(size[0] * (i % 7) / 6.0),
                        static_cast<float>(size[1] * (i % 11) / 10.0),
                        static_cast<float>(size[2] * (i % 13) / 12.0));
  }
  object.descriptor = describeView(points, std::vector<std::uint32_t>(points.size(), color));
  object.color = colorName(std::vector<std::uint32_t>(1, color));
  object.points = points.size();
  return object;
}

constexpr std::array<double, 3> kTable{1.2, 0.8, 0.75}, kCup{0.1, 0.1, 0.12},
    kBook{0.24, 0.17, 0.05};
constexpr std::uint32_t kBrown = 0x805030, kRed = 0xc01010, kBlue = 0x1020b0;

/// Looks along x from 1.2 m above the origin; nothing is nearer than 9 m.
class ObjectMapperInRoom : public ::testing::Test {
 protected:
  ObjectMapperInRoom() : mapper_(map_, {}) {
    cloud_.width = 320;
    cloud_.height = 240;
    cloud_.points.assign(320 * 240, Point(0.0f, 0.0f, 9.0f));
    camera_.focal_length = 230.0;
    camera_.cx = 159.5;
    camera_.cy = 119.5;
    camera_.in_map.translation() = Eigen::Vector3d(0.0, 0.0, 1.2);
    Eigen::Matrix3d optical;
    optical << 0, 0, 1, -1, 0, 0, 0, -1, 0;
    camera_.in_map.linear() = optical;
    mapper_.setPlaceLookup([](double, double) {
      return std::make_pair("room", Point3{0.0, 0.0, 0.0});
    });
  }
  void look(const std::vector<DetectedObject>& all, double stamp, int times = 4) {
    for (int i = 0; i < times; ++i) mapper_.update(cloud_, camera_, all, stamp + i);
  }
  const ObjectInstance* find(const std::string& color) const {
    for (const ObjectInstance& object : map_.objects) {
      const auto found = object.properties.find("colour");
      if (found != object.properties.end() && found->second == color) return &object;
    }
    return nullptr;
  }
  bool isSaid(Id a, RelationWord word, Id b) const {
    for (const ObjectRelation* r : map_.relationsOf(a)) {
      if (r->word == word && r->other == b) return true;
    }
    return false;
  }

  OrganizedCloud cloud_;
  PinholeCamera camera_;
  ObjectMap map_;
  ObjectMapper mapper_;
  const DetectedObject table_ = seen(2.0, 0.0, 0.0, kTable, kBrown, true);
};

}  // namespace

TEST_F(ObjectMapperInRoom, AssociatesViewsAndFindsRelations) {
  look({table_, seen(2.05, 0.1, 0.75, kCup, kRed), seen(2.1, -0.3, 0.75, kBook, kBlue)}, 1.0);
  look({table_, seen(2.06, 0.11, 0.75, kCup, kRed), seen(2.1, -0.28, 0.75, kBook, kBlue)}, 10.0);
  mapper_.consolidate();
  checkMap(map_, "map");
  ASSERT_EQ(map_.objects.size(), 3u);
  const Id table = map_.objects[0].id, cup = find("red")->id, book = find("blue")->id;
  EXPECT_TRUE(isSaid(cup, RelationWord::kOn, table));
  EXPECT_TRUE(isSaid(book, RelationWord::kOn, table));
  EXPECT_TRUE(isSaid(cup, RelationWord::kNear, book));
  EXPECT_TRUE(isSaid(cup, RelationWord::kLeft, book)) << "seen from the middle of the place";
  EXPECT_TRUE(isSaid(book, RelationWord::kRight, cup));
  EXPECT_GT(find("red")->existence, 0.95);
  EXPECT_EQ(map_.placeOf(cup), 1u);
}

TEST_F(ObjectMapperInRoom, RemovesObjectsSeenOnce) {
  look({table_}, 1.0);
  look({table_, seen(1.9, 0.1, 0.75, kCup, kRed)}, 10.0, 1);
  mapper_.consolidate();
  EXPECT_EQ(map_.objects.size(), 1u);
}

TEST_F(ObjectMapperInRoom, MovedObjectKeepsItsIdAndIsMoreMovable) {
  look({table_, seen(1.9, 0.3, 0.75, kCup, kRed), seen(2.1, -0.3, 0.75, kBook, kBlue)}, 1.0);
  mapper_.consolidate();
  const Id cup = find("red")->id, book = find("blue")->id;
  look({table_, seen(2.3, -0.3, 0.75, kCup, kRed), seen(2.1, -0.3, 0.75, kBook, kBlue)}, 1000.0);
  mapper_.consolidate();
  ASSERT_EQ(map_.objects.size(), 3u);
  EXPECT_EQ(find("red")->id, cup);
  EXPECT_NEAR(find("red")->pose->position.y, -0.3, 0.02);
  EXPECT_EQ(find("red")->history.size(), 2u);
  EXPECT_GT(movability(map_, cup), movability(map_, book));
  EXPECT_LT(movability(map_, map_.objects[0].id), movability(map_, book));
}

TEST_F(ObjectMapperInRoom, RemembersTheNewestStaysOnly) {
  constexpr int kVisits = static_cast<int>(kMostStays) + 30;
  for (int visit = 0; visit < kVisits; ++visit) {
    look({table_, seen(1.9, 0.3, 0.75, kCup, kRed)}, 1000.0 * (visit + 1));
  }
  mapper_.consolidate();
  const auto& history = find("red")->history;
  ASSERT_EQ(history.size(), kMostStays);
  EXPECT_EQ(history.back().from, 1000.0 * kVisits);
  EXPECT_EQ(history.front().from, 1000.0 * 31);
  // Found again elsewhere it is the same, with a history that is no longer.
  look({table_, seen(2.3, -0.3, 0.75, kCup, kRed)}, 1000.0 * (kVisits + 1));
  mapper_.consolidate();
  EXPECT_EQ(find("red")->history.size(), kMostStays);
  EXPECT_EQ(find("red")->history.front().from, 1000.0 * 32);
}

TEST_F(ObjectMapperInRoom, ReassociatesAllMovedObjectsOfEqualAppearance) {
  look({table_, seen(1.7, 0.3, 0.75, kCup, kRed), seen(1.9, -0.3, 0.75, kCup, kRed),
        seen(2.2, 0.0, 0.75, kCup, kRed)},
       1.0);
  mapper_.consolidate();
  std::set<Id> before;
  for (const ObjectInstance& object : map_.objects) before.insert(object.id);
  look({table_, seen(1.7, 0.3, 0.75, kCup, kRed), seen(2.3, 0.35, 0.75, kCup, kRed),
        seen(2.4, -0.35, 0.75, kCup, kRed)},
       1000.0);
  mapper_.consolidate();
  std::set<Id> after;
  for (const ObjectInstance& object : map_.objects) after.insert(object.id);
  EXPECT_EQ(before, after);
  int moved = 0;
  for (const ObjectInstance& object : map_.objects) {
    if (object.properties.count("furniture") != 0) continue;
    const Point3 &a = object.history.front().position, &b = object.history.back().position;
    moved += std::hypot(a.x - b.x, a.y - b.y) > 0.2;
  }
  EXPECT_EQ(moved, 2);
}

TEST_F(ObjectMapperInRoom, ObjectSeenInTheSameVisitIsNotTakenForAMovedOne) {
  const auto hidden = std::vector<Point>(cloud_.points.size(), Point(0.0f, 0.0f, 1.0f));
  const std::vector<Point> open = cloud_.points;
  look({table_, seen(1.9, 0.3, 0.75, kCup, kRed)}, 1.0);
  const Id first = find("red")->id;
  cloud_.points = hidden;  // the next room: a cup that is just like it
  look({seen(2.3, -0.3, 0.75, kCup, kRed)}, 20.0);
  mapper_.consolidate();
  ASSERT_EQ(map_.objects.size(), 3u);
  const Id second = map_.objects.back().id;
  look({seen(2.3, -0.3, 0.75, kCup, kRed)}, 1000.0);
  cloud_.points = open;
  look({table_, seen(2.2, 0.35, 0.75, kCup, kRed)}, 1010.0);
  map_.find(second)->existence = 0.99;  // the frames above look at nothing but the first table
  mapper_.consolidate();
  ASSERT_NE(map_.find(first), nullptr);
  ASSERT_NE(map_.find(second), nullptr);
  EXPECT_NEAR(map_.find(first)->pose->position.x, 2.2, 0.02);
  EXPECT_NEAR(map_.find(second)->pose->position.x, 2.3, 0.02);
}

TEST_F(ObjectMapperInRoom, DetectsThatALowObjectIsGone) {
  look({table_, seen(1.9, 0.1, 0.75, kBook, kBlue)}, 1.0);
  for (int v = 120; v < cloud_.height; ++v) {  // the table's plane
    for (int u = 0; u < cloud_.width; ++u) {
      const auto depth = static_cast<float>(0.45 * 230.0 / (v - 119.5));
      cloud_.points[static_cast<std::size_t>(v * cloud_.width + u)] =
          Point(0.0f, 0.0f, std::min(depth, 9.0f));
    }
  }
  look({table_}, 1000.0);
  EXPECT_LT(find("blue")->existence, 0.1);
}

TEST_F(ObjectMapperInRoom, TopsOfObjectsOnATableAreNoFurniture) {
  const DetectedObject tops = seen(2.0, 0.0, 0.0, {0.6, 0.4, 1.1}, kRed, true);
  look({tops}, 1.0);
  look({tops, table_}, 10.0);
  mapper_.consolidate();
  ASSERT_EQ(map_.objects.size(), 1u);
  EXPECT_NEAR(map_.objects[0].pose->size[2], 0.75, 0.01);
}

TEST_F(ObjectMapperInRoom, ReassociatedObjectKeepsDescribedRelations) {
  look({table_, seen(1.9, 0.3, 0.75, kCup, kRed), seen(2.1, -0.3, 0.75, kBook, kBlue)}, 1.0);
  mapper_.consolidate();
  const Id cup = find("red")->id, book = find("blue")->id;
  look({table_, seen(2.3, -0.3, 0.75, kCup, kRed), seen(2.1, -0.3, 0.75, kBook, kBlue)}, 1000.0);
  Id now = 0;  // the same cup, not yet known to be
  for (const ObjectInstance& object : map_.objects) now = std::max(now, object.id);
  ASSERT_NE(now, cup);
  ObjectRelation told;
  told.object = now;
  told.word = RelationWord::kTop;
  told.other = book;
  told.described = true;
  map_.relate(told);
  mapper_.consolidate();
  checkMap(map_, "map");
  EXPECT_EQ(map_.find(now), nullptr);
  EXPECT_TRUE(isSaid(cup, RelationWord::kTop, book));
}

TEST_F(ObjectMapperInRoom, BagPlayedAgainDoesNotRemoveObjects) {
  look({table_, seen(1.9, 0.3, 0.75, kCup, kRed)}, 5000.0);
  mapper_.consolidate(mapper_.time() - 20.0);
  look({table_, seen(1.9, 0.3, 0.75, kCup, kRed)}, 10.0);
  look({table_, seen(1.9, 0.3, 0.75, kCup, kRed), seen(2.3, -0.3, 0.75, kBook, kBlue)}, 14.0, 1);
  EXPECT_EQ(mapper_.time(), 14.0);
  mapper_.consolidate(mapper_.time() - 20.0);
  checkMap(map_, "map");
  EXPECT_EQ(map_.objects.size(), 3u) << "what was seen once just now is kept";
  EXPECT_EQ(find("red")->last_seen, 14.0);
}

TEST_F(ObjectMapperInRoom, MissingObjectLosesEvidenceAndHiddenObjectDoesNot) {
  look({table_, seen(1.9, 0.1, 0.75, kCup, kRed)}, 1.0);
  mapper_.consolidate();
  const double before = find("red")->existence;
  cloud_.points.assign(cloud_.points.size(), Point(0.0f, 0.0f, 1.0f));  // something in front
  look({table_}, 1000.0);
  EXPECT_EQ(find("red")->existence, before);
  cloud_.points.assign(cloud_.points.size(), Point(0.0f, 0.0f, 9.0f));
  look({table_}, 1010.0);
  EXPECT_LT(find("red")->existence, 0.1);
  EXPECT_GE(find("red")->missed_detections, 3);
}

TEST_F(ObjectMapperInRoom, ObjectThatCarriesAnotherIsLessMovable) {
  look({table_, seen(1.9, 0.1, 0.75, kBook, kBlue)}, 1.0);
  mapper_.consolidate();
  const double alone = movability(map_, find("blue")->id);
  look({table_, seen(1.9, 0.1, 0.75, kBook, kBlue), seen(1.9, 0.1, 0.80, kCup, kRed)}, 5.0);
  mapper_.consolidate();
  EXPECT_TRUE(isSaid(find("red")->id, RelationWord::kOn, find("blue")->id));
  EXPECT_NEAR(movability(map_, find("blue")->id), 0.6 * alone, 1e-9);
}

TEST_F(ObjectMapperInRoom, DescribedObjectIsDetectedAtItsPlace) {
  const Id told = map_.addObject("cup");
  map_.find(told)->described = true;
  ObjectRelation at;
  at.object = told;
  at.place = map_.addPlace("room");
  at.described = true;
  map_.relate(at);
  ObjectDictionary dictionary;
  const DetectedObject cup = seen(1.9, 0.1, 0.75, kCup, kRed);
  dictionary.put(learnObject("cup", {cup.descriptor}, {}));
  mapper_.setDictionary(dictionary);
  look({table_, cup}, 1.0);
  mapper_.consolidate();
  EXPECT_EQ(map_.objects.size(), 2u);
  ASSERT_TRUE(map_.find(told)->pose);
  EXPECT_EQ(map_.find(told)->kind, "cup");
}

// A box of 40 x 18 x 38 cm, as a PC is, that lies across the line of sight, and its two faces.
class ObjectMapperWithPc : public ObjectMapperInRoom {
 protected:
  ObjectMapperWithPc() {
    const std::array<double, 3> whole{0.18, 0.4, 0.38};
    ObjectDictionary dictionary;
    dictionary.put(learnObject("PC",
                               {pc(2.0, 0.0, whole).descriptor, pc(2.0, 0.0, kFront).descriptor,
                                pc(2.0, 0.0, kSide).descriptor},
                               {{0.4, 0.18, 0.38}, {0.4, 0.18, 0.38}, {0.4, 0.18, 0.38}}));
    mapper_.setDictionary(dictionary);
  }
  static DetectedObject pc(double x, double y, std::array<double, 3> size) {
    return seen(x, y, 0.75, size, 0x101010);
  }
  int countPcs() const {
    return static_cast<int>(std::count_if(map_.objects.begin(), map_.objects.end(),
                                          [](const auto& o) { return o.kind == "PC"; }));
  }

  static constexpr std::array<double, 3> kFront{0.02, 0.38, 0.38}, kSide{0.17, 0.02, 0.38};
};

TEST_F(ObjectMapperWithPc, TwoEqualOnesSideBySideStayTwo) {
  const std::array<double, 3> whole{0.18, 0.4, 0.38};
  look({table_, pc(2.0, -0.25, whole), pc(2.0, 0.2, whole)}, 1.0);
  mapper_.consolidate();
  EXPECT_EQ(countPcs(), 2);
}

TEST_F(ObjectMapperWithPc, FacesOfOneBecomeOneAndStartNoOther) {
  look({table_, pc(1.92, 0.0, kFront), pc(2.0, 0.18, kSide)}, 1.0);
  EXPECT_EQ(countPcs(), 2);
  mapper_.consolidate();
  ASSERT_EQ(countPcs(), 1);
  const ObjectPose& pose = *map_.objects.back().pose;
  EXPECT_NEAR(pose.size[0], 0.18, 0.03);
  EXPECT_NEAR(pose.size[1], 0.38, 0.03);
  look({table_, pc(1.92, 0.0, kFront), pc(2.0, 0.18, kSide)}, 10.0);
  EXPECT_EQ(countPcs(), 1) << "a face within the box of a whole one";
}

TEST_F(ObjectMapperWithPc, OneThatIsLargerThanItsKindAndHoldsAnotherIsNoObject) {
  const std::array<double, 3> whole{0.18, 0.4, 0.38}, both{0.18, 0.95, 0.38};
  look({table_, pc(2.0, 0.0, both)}, 1.0, 5);
  look({table_, pc(2.0, -0.25, whole), pc(2.0, 0.25, whole)}, 10.0);
  mapper_.consolidate();
  EXPECT_EQ(countPcs(), 2);
  for (const ObjectInstance& object : map_.objects) {
    if (object.kind != "PC") continue;
    EXPECT_LT(object.pose->size[1], 0.5);
  }
}

TEST_F(ObjectMapperInRoom, WhatIsOverlookedTooOftenIsNoObject) {
  look({table_, seen(1.9, 0.1, 0.75, kCup, kRed)}, 1.0, 2);
  look({table_, seen(1.9, -0.1, 0.75, kCup, kBlue)}, 5.0, 6);
  cloud_.points.assign(cloud_.points.size(), Point(0.0f, 0.0f, 1.9f));  // something is there
  look({table_}, 20.0);
  EXPECT_EQ(find("red")->overlooked, 4 + 0);
  mapper_.consolidate();
  EXPECT_EQ(find("red"), nullptr) << "seen twice, overlooked four times";
  EXPECT_NE(find("blue"), nullptr) << "seen six times, overlooked four times";
}

TEST_F(ObjectMapperInRoom, AViewOfATableAndAThingOnItIsNoObject) {
  look({table_, seen(2.3, 0.3, 0.2, {0.2, 0.2, 1.2}, kRed)}, 1.0);
  mapper_.consolidate();
  EXPECT_EQ(find("red"), nullptr);
}

// Places are looked at again and again before a thing is found elsewhere.
TEST_F(ObjectMapperInRoom, WhatIsGoneIsKeptToBeFoundAgain) {
  look({table_, seen(1.9, 0.3, 0.75, kCup, kRed)}, 1.0, 8);
  mapper_.consolidate();
  const Id cup = find("red")->id;
  for (int i = 0; i < 5; ++i) {
    look({table_}, 1000.0 + 10.0 * i);
    mapper_.consolidate();
  }
  ASSERT_NE(find("red"), nullptr);
  EXPECT_LT(find("red")->existence, 0.1);
  look({table_, seen(2.3, -0.3, 0.75, kCup, kRed)}, 1100.0);
  mapper_.consolidate();
  EXPECT_EQ(find("red")->id, cup);
  EXPECT_NEAR(find("red")->pose->position.y, -0.3, 0.02);
}

TEST_F(ObjectMapperInRoom, RelationsNeedBothEndsSeen) {
  look({table_, seen(1.9, 0.1, 0.75, kCup, kRed)}, 1.0);
  look({table_, seen(1.9, 0.1, 0.75, kCup, kRed), seen(2.1, -0.1, 0.75, kBook, kBlue)}, 8.0, 1);
  mapper_.consolidate(0.0);  // what was seen once is kept for now
  ASSERT_NE(find("blue"), nullptr);
  EXPECT_FALSE(isSaid(find("red")->id, RelationWord::kNear, find("blue")->id));
  look({table_, seen(1.9, 0.1, 0.75, kCup, kRed), seen(2.1, -0.1, 0.75, kBook, kBlue)}, 9.0, 1);
  mapper_.consolidate(0.0);
  EXPECT_TRUE(isSaid(find("red")->id, RelationWord::kNear, find("blue")->id));
}

TEST_F(ObjectMapperInRoom, RefusesBadInput) {
  MapperParams params;
  params.association_gate = 0.0;
  EXPECT_THROW(ObjectMapper(map_, {}, params), hyselam::ParameterError);
  cloud_.points.pop_back();
  EXPECT_THROW(mapper_.update(cloud_, camera_, {}, 1.0), hyselam::InputError);
  EXPECT_THROW(detectObjects(cloud_, camera_.in_map), hyselam::InputError);
  EXPECT_TRUE(map_.objects.empty());
}
