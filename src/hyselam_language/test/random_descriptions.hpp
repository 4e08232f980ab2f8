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
          building.connections.push_back(
              {a, b, static_cast<Side>(pick(5)), static_cast<std::size_t>(pick(4))});
        }
        const auto kind = static_cast<RelationKind>(pick(5));
        if (pick(4) == 0 && kind != RelationKind::kBetween) {
          building.relations.push_back({kind, a, b, 0});
        }
      }
    }
    if (count >= 3) {
      building.relations.push_back({RelationKind::kBetween, building.places[0].id,
                                    building.places[1].id, building.places[2].id});
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
    return place;
  }

  std::mt19937 rng_;
};

}  // namespace testing
}  // namespace hyselam_topo
