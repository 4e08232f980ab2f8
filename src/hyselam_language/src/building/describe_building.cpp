#include "hyselam_language/building/describe_building.hpp"

#include <set>
#include <vector>

#include "connection_rows.hpp"
#include "fact_sentences.hpp"

namespace hyselam_topo {
namespace {

class Teller {
 public:
  Teller(const DescribedBuilding& building, const Grammar& grammar)
      : building_(building), facts_(building, grammar) {}

  std::string tell() {
    if (building_.place_count) say(facts_.placeCount(*building_.place_count));
    // What comes after what, on no way from anywhere: said before the robot is anywhere.
    for (const DescribedRelation& each : building_.relations) {
      if (each.kind == RelationKind::kAfter && each.c == 0) tell(each);
    }
    for (const ConnectionRow& row : rowsOf(building_.connections, building_)) tell(row);
    for (const DescribedPlace& place : building_.places) {
      for (const std::string& sentence : facts_.ofPlace(place)) {
        say(sentence);
        told_.insert(place.id);
      }
    }
    for (const DescribedRelation& each : building_.relations) {
      if (each.kind != RelationKind::kAfter || each.c != 0) tell(each);
    }
    for (const DescribedPlace& place : building_.places) {
      if (told_.count(place.id) == 0) say(facts_.exists(place.id));
    }
    if (building_.robot_place) tellRobotIn(*building_.robot_place);
    return std::move(text_);
  }

 private:
  void say(const std::string& sentence) { text_ += (text_.empty() ? "" : " ") + sentence; }

  void tellRobotIn(Id place) {
    if (robot_ == place) return;
    say(facts_.ofPlace("robot_in", place));
    robot_ = place;
  }

  void tell(const ConnectionRow& row) {
    told_.insert(row.from);
    if (row.side != Side::kUnknown) tellRobotIn(row.from);
    for (const std::vector<DescribedConnection>& each : row.sentences()) {
      std::vector<Id> ids;
      ids.reserve(each.size());
      for (const DescribedConnection& connection : each) ids.push_back(connection.to);
      told_.insert(ids.begin(), ids.end());
      if (each.front().rank || each.front().distance) {
        say(facts_.ofConnection(each.front()));
        continue;
      }
      const SentenceWriter& writer = facts_.writer();
      say(writer.sentence(toString(row.side), {writer.list("places", building_, ids),
                                               writer.place("place", building_, row.from)}));
    }
  }

  void tell(const DescribedRelation& relation) {
    for (const Id id : {relation.a, relation.b, relation.c}) told_.insert(id);
    if (relation.side != Side::kUnknown) tellRobotIn(relation.b);
    say(facts_.ofRelation(relation, robot_));
  }

  const DescribedBuilding& building_;
  FactSentences facts_;
  std::set<Id> told_;
  Id robot_ = 0;
  std::string text_;
};

}  // namespace

std::string describeBuilding(const DescribedBuilding& building, const Grammar& grammar) {
  checkDescription(building, "description");
  return Teller(building, grammar).tell();
}

}  // namespace hyselam_topo
