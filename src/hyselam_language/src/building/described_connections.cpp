// What statements of several places tell: which are joined, on which side, how else they lie.
#include <algorithm>

#include "edit_description.hpp"
#include "hyselam_common/numbers.hpp"
#include "hyselam_language/building/description_builder.hpp"

namespace hyselam_topo {

void DescriptionBuilder::checkCount(const Utterance& u, std::size_t named) {
  const auto count = u.number("count");
  if (count && static_cast<std::size_t>(*count) != named) {
    fail(IssueKind::kMeaningless,
         shown(*count) + " were announced, " + std::to_string(named) + " named");
  }
}

void DescriptionBuilder::neighbours(const Utterance& u) {
  const bool same = u.word("side") == "same";
  if (same && !side_) fail(IssueKind::kNoContext, "no side was told before");
  const auto side = same ? side_ : sideOf(u.word("side"));
  if (u.find("from") == nullptr && !building_.robot_place) {
    fail(IssueKind::kNoContext, "where the robot is was not told");
  }
  const Id from = u.find("from") != nullptr ? place(u, "from") : *building_.robot_place;
  if (building_.robot_place && from != *building_.robot_place) {
    fail(IssueKind::kNoContext, "sides are told as the robot sees them, and it is in '" +
                                    nameOf(*building_.robot_place) + "', not in '" + nameOf(from) +
                                    "'");
  }
  const std::vector<Id> ids = places(u, "places");
  checkCount(u, ids.size());
  side_ = side && *side != Side::kUnknown ? side : std::nullopt;
  for (const Id id : ids) connect(from, id, side.value_or(Side::kUnknown), std::nullopt);
  subjects_ = ids;
  if (ids.size() == 1 && u.number("length")) sizeOf(ids.front(), u);
}

void DescriptionBuilder::nthNeighbour(const Utterance& u) {
  if (!building_.robot_place) fail(IssueKind::kNoContext, "where the robot is was not told");
  const Id id = place(u, "place");
  const auto nth = hyselam::parseNumber(u.word("nth")).value_or(1.0);
  side_ = sideOf(u.word("side"));
  connect(*building_.robot_place, id, side_.value_or(Side::kUnknown),
          static_cast<std::size_t>(nth) - 1);
  subjects_ = {id};
}

void DescriptionBuilder::contains(const Utterance& u) {
  const Id inside = place(u, "inside");
  const std::vector<Id> ids = places(u, "places");
  for (const Id id : ids) connect(inside, id, Side::kUnknown, std::nullopt);
  subjects_ = ids;
}

void DescriptionBuilder::joined(const Utterance& u) {
  const Id a = place(u, "a");
  const Id b = place(u, "b");
  connect(a, b, Side::kUnknown, std::nullopt);
  subjects_ = {a, b};
}

void DescriptionBuilder::connect(Id from, Id to, Side side, std::optional<std::size_t> order) {
  if (from == to) {
    fail(IssueKind::kMeaningless, "'" + nameOf(to) + "' lies beside itself");
  }
  if (const DescribedConnection* known = findConnection(building_, from, to)) {
    // Nothing new: told already, told without a side, or seen from the other place.
    if (side == Side::kUnknown) return;
    const bool seen_from_there = known->from == to && known->side != Side::kUnknown;
    if (seen_from_there) return;
    if (known->from == from && known->side == side && (!order || known->order == *order)) return;
    if (known->side != Side::kUnknown) {
      if (!correction_) {
        report(IssueKind::kContradiction, "'" + nameOf(to) + "' was told to be at the " +
                                              toString(known->side) + ", not at the " +
                                              toString(side));
        return;
      }
      corrected_ = true;
    }
    removeConnection(*known, &building_);
  }
  std::size_t next = 0;
  bool taken = false;
  for (const DescribedConnection& other : building_.connections) {
    if (other.from != from || other.side != side) continue;
    next = std::max(next, other.order + 1);
    taken = taken || (order && other.order == *order);
  }
  if (taken) {
    fail(IssueKind::kContradiction, "number " + std::to_string(*order + 1) + " at the " +
                                        toString(side) + " is another place");
  }
  building_.connections.push_back({from, to, side, order.value_or(next)});
}

void DescriptionBuilder::relation(const Utterance& u, RelationKind kind) {
  DescribedRelation relation;
  relation.kind = kind;
  relation.a = place(u, "a");
  relation.b = place(u, "b");
  if (kind == RelationKind::kBetween) relation.c = place(u, "c");
  if (relation.a == relation.b || relation.a == relation.c || relation.b == relation.c) {
    fail(IssueKind::kMeaningless, "a place is named twice");
  }
  auto& all = building_.relations;
  if (std::find(all.begin(), all.end(), relation) == all.end()) all.push_back(relation);
  // Whoever goes to the end of a corridor gets there.
  if (kind == RelationKind::kAtEndOf) connect(relation.b, relation.a, Side::kUnknown, std::nullopt);
  subjects_ = {relation.a};
}

}  // namespace hyselam_topo
