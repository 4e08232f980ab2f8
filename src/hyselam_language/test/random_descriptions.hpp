// Descriptions with everything that one may hold, for tests.
#pragma once

#include <random>
#include <string>
#include <utility>

#include "hyselam_language/building/described_building.hpp"

namespace hyselam_topo {
namespace testing {

class RandomDescriptions {
 public:
  explicit RandomDescriptions(unsigned seed) : rng_(seed) {}

  DescribedBuilding description() {
    DescribedBuilding building;
    const int count = pick(8);
    Id id = 0;
    for (int i = 0; i < count; ++i) building.places.push_back(place(id += 1u + pick(3) / 2u));
    for (int i = 0; i < count; ++i) {
      for (int j = 0; j < i; ++j) {
        const Id a = building.places[static_cast<std::size_t>(i)].id;
        const Id b = building.places[static_cast<std::size_t>(j)].id;
        if (pick(3) == 0) {
          building.connections.push_back(connection(a, b));
        }
        if (pick(4) == 0) building.relations.push_back(relation(a, b));
      }
    }
    if (count >= 3) {
      DescribedRelation of_three = relation(building.places[0].id, building.places[1].id);
      of_three.kind = pick(2) == 0 ? RelationKind::kBetween : RelationKind::kAfter;
      of_three.c = building.places[2].id;
      of_three.side = Side::kUnknown;
      building.relations.push_back(of_three);
    }
    if (count > 0 && pick(2) == 0) {
      building.robot_place = building.places[static_cast<std::size_t>(pick(count))].id;
    }
    if (pick(3) == 0) building.place_count = 1 + pick(20);
    return building;
  }

 private:
  int pick(int n) { return static_cast<int>(rng_() % static_cast<unsigned>(n)); }

  std::string name() {
    static const char* const kNames[] = {"room I-109", "John's office",  "caf\xc3\xa9 \"Blue\"",
                                         "<&>",        "sala de estar ", "\xe5\xae\xa4 7"};
    return kNames[pick(6)] + std::to_string(pick(1000));
  }

  std::optional<double> size() {
    if (pick(2) == 0) return std::nullopt;
    return std::uniform_real_distribution<double>(1e-3, 1e3)(rng_);
  }

  DescribedConnection connection(Id a, Id b) {
    DescribedConnection made;
    made.from = a;
    made.to = b;
    made.side = static_cast<Side>(pick(5));
    made.order = static_cast<std::size_t>(pick(4));
    if (pick(3) == 0) made.rank = pick(2) == 0 ? -1 - pick(3) : 1 + pick(30);
    if (pick(3) == 0) made.distance = std::uniform_real_distribution<double>(0.0, 1e3)(rng_);
    if (pick(5) == 0)
      made.seen_from = hyselam::Pose2{1.0 * pick(50), -2.0 * pick(50), 0.1 * pick(60) - 3.0};
    if (pick(3) == 0) made.side_certainty = std::uniform_real_distribution<double>(0.1, 1.0)(rng_);
    if (pick(3) == 0) made.order_certainty = std::uniform_real_distribution<double>(0.1, 1.0)(rng_);
    return made;
  }

  /// Of two places; what is only denied is denied.
  DescribedRelation relation(Id a, Id b) {
    DescribedRelation made;
    made.kind = static_cast<RelationKind>(pick(10));
    if (made.kind == RelationKind::kBetween) made.kind = RelationKind::kNextTo;
    made.a = a;
    made.b = b;
    if (made.kind == RelationKind::kAtSide) made.side = static_cast<Side>(1 + pick(4));
    const bool only_denied =
        made.kind == RelationKind::kAtSide || made.kind == RelationKind::kJoined;
    made.denied = only_denied || pick(2) == 0;
    return made;
  }

  DescribedPlace place(Id id) {
    DescribedPlace place;
    place.id = id;
    place.name = name();
    for (int i = pick(3); i > 0; --i) place.aliases.push_back(name());
    if (pick(2) == 0) place.kind = static_cast<PlaceKind>(pick(3));
    place.length = size();
    place.width = size();
    place.area = size();
    if (pick(4) == 0) place.parts = 1 + pick(9);
    if (pick(4) == 0) place.doors = 1 + pick(9);
    if (pick(4) == 0) place.floor = pick(9) - 4;
    if (pick(4) == 0) place.size_word = static_cast<SizeWord>(pick(2));
    return place;
  }

  std::mt19937 rng_;
};

}  // namespace testing
}  // namespace hyselam_topo
