// Descriptions that can be told in words and come back as they were (describe_building.hpp).
#pragma once

#include <algorithm>
#include <array>
#include <map>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "hyselam_language/building/place_names.hpp"

namespace hyselam_topo {
namespace testing {

class RandomBuildings {
 public:
  RandomBuildings(unsigned seed, const Grammar& grammar) : rng_(seed), names_({grammar}) {
    words_ = grammar.language() == "pt"
                 ? std::vector<std::string>{"corredor",     "cozinha",          "sala de estar",
                                            "I-109",        "gabinete do João", "sala A",
                                            "Bar \"Azul\"", "laboratório 7",    "casa de banho",
                                            "e depois",     "escadas"}
                 : std::vector<std::string>{"corridor",      "kitchen",  "living room",  "I-109",
                                            "John's office", "room A",   "Bar \"Blue\"", "lab 7",
                                            "bathroom",      "and then", "2nd floor lab"};
  }

  DescribedBuilding building() {
    DescribedBuilding b;
    std::shuffle(words_.begin(), words_.end(), rng_);
    const std::size_t count = 1 + pick(8);
    for (std::size_t i = 0; i < count; ++i) b.places.push_back(place(i));
    std::map<std::pair<Id, Side>, std::size_t> rows;
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t j = i + 1; j < count; ++j) {
        if (pick(3) != 0) continue;
        const auto side = static_cast<Side>(pick(5));
        const Id from = b.places[i].id;
        b.connections.push_back({from, b.places[j].id, side, rows[{from, side}]++});
      }
    }
    if (count >= 3 && pick(2) == 0)
      b.relations.push_back(relation(RelationKind::kBetween, 1, 2, 3));
    if (count >= 2 && pick(2) == 0) b.relations.push_back(relation(RelationKind::kNextTo, 2, 1, 0));
    if (count >= 2 && pick(2) == 0)
      b.relations.push_back(relation(RelationKind::kOpposite, 1, 2, 0));
    if (count >= 2 && pick(2) == 0) b.relations.push_back(relation(RelationKind::kInside, 2, 1, 0));
    if (!b.connections.empty() && pick(2) == 0) {
      const DescribedConnection& c = b.connections[pick(b.connections.size())];
      b.relations.push_back(relation(RelationKind::kAtEndOf, c.to, c.from, 0));
    }
    for (DescribedConnection& c : b.connections) rankAndDistance(&c, b);
    addFurther(&b);
    b.robot_place = b.places[pick(count)].id;
    if (pick(3) == 0) b.place_count = static_cast<int>(1 + pick(12));
    return b;
  }

 private:
  static DescribedRelation relation(RelationKind kind, Id a, Id other, Id c = 0) {
    return {kind, a, other, c};
  }

  /// Ranks rise along a row; only its last place is counted from the end.
  void rankAndDistance(DescribedConnection* c, const DescribedBuilding& b) {
    if (pick(4) == 0) c->distance = static_cast<double>(1 + pick(100)) / 4.0;
    const bool last =
        std::none_of(b.connections.begin(), b.connections.end(), [&](const auto& other) {
          return other.from == c->from && other.side == c->side && other.order > c->order;
        });
    if (pick(3) != 0) return;
    if (last && pick(2) == 0) {
      c->rank = -static_cast<int>(1 + pick(4));
    } else {
      c->rank = static_cast<int>(1 + 4 * c->order + pick(4));
    }
  }

  /// One more statement of two places that nothing else was told of.
  void addFurther(DescribedBuilding* b) {
    constexpr std::array<RelationKind, 10> kKinds{RelationKind::kNextTo,  RelationKind::kOpposite,
                                                  RelationKind::kBetween, RelationKind::kAtEndOf,
                                                  RelationKind::kInside,  RelationKind::kAfter,
                                                  RelationKind::kBehind,  RelationKind::kLarger,
                                                  RelationKind::kJoined,  RelationKind::kAtSide};
    const std::size_t count = b->places.size();
    for (std::size_t i = 3; i < count; ++i) {
      for (std::size_t j = 2; j < i; ++j) {
        const Id a = b->places[i].id, other = b->places[j].id;
        const bool joined =
            std::any_of(b->connections.begin(), b->connections.end(), [&](const auto& each) {
              return std::minmax(each.from, each.to) == std::minmax(a, other);
            });
        if (joined || pick(2) == 0) continue;
        DescribedRelation made = relation(kKinds[pick(kKinds.size())], a, other);
        const bool further = made.kind == RelationKind::kAfter ||
                             made.kind == RelationKind::kBehind ||
                             made.kind == RelationKind::kLarger;
        made.denied = !further || pick(2) == 0;
        if (made.kind == RelationKind::kBetween) made.c = b->places[0].id;
        if (made.kind == RelationKind::kAfter && pick(2) == 0) made.c = b->places[1].id;
        if (made.kind == RelationKind::kAtSide) made.side = static_cast<Side>(1 + pick(4));
        b->relations.push_back(made);
      }
    }
    for (DescribedPlace& place : b->places) {
      const bool joined = std::any_of(
          b->connections.begin(), b->connections.end(),
          [&](const auto& each) { return each.from == place.id || each.to == place.id; });
      if (!joined && pick(2) == 0) place.floor = static_cast<int>(pick(9)) - 4;
      if (pick(5) == 0) place.doors = static_cast<int>(1 + pick(4));
      if (pick(5) == 0) place.size_word = pick(2) == 0 ? SizeWord::kSmall : SizeWord::kLarge;
    }
  }

  std::size_t pick(std::size_t n) { return rng_() % n; }

  DescribedPlace place(std::size_t i) {
    DescribedPlace p;
    p.id = static_cast<Id>(i + 1);
    p.name = words_[i];
    if (pick(4) == 0) p.aliases.push_back("Q-" + std::to_string(100 + i));
    p.kind = names_.kindOf(p.name);
    if (pick(6) == 0) p.kind = pick(2) == 0 ? PlaceKind::kRoom : PlaceKind::kCorridor;
    const auto size = [&] { return static_cast<double>(1 + pick(400)) / 16.0; };
    switch (pick(4)) {
      case 0:
        p.length = size();
        p.width = size();
        p.area = *p.length * *p.width;
        break;
      case 1:
        p.area = size();
        break;
      case 2:
        p.length = size();
        break;
      default:
        break;
    }
    if (pick(5) == 0) p.parts = static_cast<int>(1 + pick(5));
    return p;
  }

  std::mt19937 rng_;
  PlaceNames names_;
  std::vector<std::string> words_;
};

}  // namespace testing
}  // namespace hyselam_topo
