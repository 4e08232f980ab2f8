#include "fact_sentences.hpp"

#include <algorithm>
#include <cstdlib>

#include "hyselam_common/numbers.hpp"

namespace hyselam_topo {
namespace {

std::string number(double value) {
  return hyselam::formatNumber(value);
}

SaidValue value(const std::string& key, const std::string& text) {
  return {key, text, false, false};
}

}  // namespace

FactSentences::FactSentences(const DescribedBuilding& building, const Grammar& grammar,
                             bool capitals)
    : building_(building), grammar_(grammar), names_({grammar}), writer_(grammar, capitals) {}

std::string FactSentences::ofPlace(const std::string& key, Id id) const {
  return writer_.sentence(key, {writer_.place("place", building_, id)});
}

std::string FactSentences::exists(Id id) const {
  SaidValue name = value("place", writer_.quoted(building_.findPlace(id)->name));
  return writer_.sentence("exists", {name});
}

std::string FactSentences::placeCount(int count) const {
  return writer_.sentence("building", {value("count", std::to_string(count))});
}

std::vector<std::string> FactSentences::ofPlace(const DescribedPlace& place) const {
  std::vector<std::string> all;
  const auto say = [&](const std::string& key, std::vector<SaidValue> values) {
    values.insert(values.begin(), writer_.place("place", building_, place.id));
    all.push_back(writer_.sentence(key, values));
  };
  if (place.length && place.width) {
    say("size", {value("length", number(*place.length)), value("width", number(*place.width))});
  } else if (place.length) {
    say("length", {value("length", number(*place.length))});
  } else if (place.width) {
    say("width", {value("width", number(*place.width))});
  }
  if (place.area && !(place.length && place.width)) {
    say("area", {value("area", number(*place.area))});
  }
  if (place.parts) say("parts", {value("count", std::to_string(*place.parts))});
  const auto guessed = names_.kindOf(place.name);
  if (place.kind && place.kind != guessed) say(toString(*place.kind), {});
  if (place.size_word) say(std::string("size_") + toString(*place.size_word), {});
  if (place.doors) {
    say(*place.doors == 1 ? "one_door" : "doors", {value("count", std::to_string(*place.doors))});
  }
  if (place.floor) {
    const int floor = *place.floor;
    const std::string key = std::abs(floor) <= 1 ? "floor_" + std::to_string(floor)
                            : floor > 1          ? "floors_up"
                                                 : "floors_down";
    say(key, {value("count", std::to_string(std::abs(floor)))});
  }
  for (const std::string& alias : place.aliases) {
    say("alias", {value("name", writer_.quoted(alias))});
  }
  return all;
}

SaidValue FactSentences::where(Id from, Side side) const {
  const std::string key = std::string("where_") + toString(side);
  return value("where", writer_.phrase(key, {writer_.place("place", building_, from)}));
}

SaidValue FactSentences::which(int rank) const {
  const std::string ordinal = "nth_" + std::to_string(rank);
  if (grammar_.has(ordinal)) {
    return value("which", writer_.phrase("nth", {value("nth", grammar_.say(ordinal))}));
  }
  return value("which", writer_.phrase(rank > 0 ? "number" : "number_from_end",
                                       {value("count", std::to_string(std::abs(rank)))}));
}

std::string FactSentences::ofConnection(const DescribedConnection& connection) const {
  const SaidValue to = writer_.place("to", building_, connection.to);
  const bool plain = !connection.rank && !connection.distance;
  if (plain && connection.side == Side::kUnknown) {
    return writer_.sentence("connected", {writer_.place("from", building_, connection.from), to});
  }
  std::vector<SaidValue> values{to, where(connection.from, connection.side)};
  const bool sided = connection.side == Side::kLeft || connection.side == Side::kRight;
  if (sided && connection.distance == 0.0) {
    if (connection.rank) values.push_back(which(*connection.rank));
    return writer_.sentence(connection.rank ? "ranked_here" : "right_here", values);
  }
  std::string key = plain ? "at_place" : "";
  if (connection.rank) {
    key = "ranked";
    values.push_back(which(*connection.rank));
  }
  if (connection.distance) {
    key += key.empty() ? "distant" : "_distant";
    values.push_back(value("distance", number(*connection.distance)));
  }
  return writer_.sentence(key, values);
}

std::string FactSentences::ofRow(Id from, Side side, const std::vector<Id>& ids) const {
  return writer_.sentence("row", {writer_.list("places", building_, ids), where(from, side)});
}

std::string FactSentences::ofRelation(const DescribedRelation& relation, Id robot) const {
  std::vector<SaidValue> values{writer_.place("a", building_, relation.a),
                                writer_.place("b", building_, relation.b)};
  if (relation.c != 0) values.push_back(writer_.place("c", building_, relation.c));
  std::string key = toString(relation.kind);
  if (relation.kind == RelationKind::kAtSide) {
    key = std::string("not_") + toString(relation.side);
  } else if (relation.denied) {
    key.insert(0, "not_");
  }
  if (relation.kind == RelationKind::kAfter && relation.c != 0 && relation.c != robot) {
    key += "_from";
  }
  return writer_.sentence(key, values);
}

bool isTold(const DescribedConnection& connection, const DescribedBuilding& building) {
  if (connection.side != Side::kUnknown || connection.rank || connection.distance) return false;
  const auto& all = building.relations;
  return std::any_of(all.begin(), all.end(), [&](const DescribedRelation& relation) {
    return relation.kind == RelationKind::kAtEndOf && !relation.denied &&
           relation.a == connection.to && relation.b == connection.from;
  });
}

}  // namespace hyselam_topo
